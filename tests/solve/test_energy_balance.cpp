// solve/energy_balance.h on made-up numbers: the energy that counts as made, and its bound.

#include "solve/energy_balance.h"
#include "support/approx.h"

namespace seldinger::test::test_energy_balance {

namespace {

constexpr EnergyLimits limits{0.10, 1e-6};

EnergyBalance begun(const WireEnergy& at)
{
    EnergyBalance balance;
    balance.begin(at);
    return balance;
}

}  // namespace

TEST_SUITE("solve/energy_balance")
{
    TEST_CASE("analytic: work that becomes kinetic energy is paid for; more than a tenth beyond that is not")
    {
        constexpr EnergyLimits coarse{0.10, 1e-4};  // what a first step turns over counts after it only
        for (const double gain : {1.0, 1.05, 1.15}) {
            CAPTURE(gain);
            EnergyBalance balance = begun({});
            bool adds_up = true;
            double kinetic = 0;
            for (int k = 0; k < 100; ++k)
                adds_up = balance.take_in({kinetic += gain * 1e-3, 0, 0}, {1e-3, 0, 0}, coarse) && adds_up;
            CHECK(std::abs(balance.made() - (gain - 1) * 0.1) < 1e-12);
            CHECK(adds_up == (gain < 1.1));
        }
    }

    TEST_CASE("analytic: what is stored and let go is the wire's own, as is what contact springs give back")
    {
        EnergyBalance bent = begun({0, 1, 0});
        CHECK(bent.take_in({1, 0, 0}, {}, limits));
        CHECK(bent.take_in({0, 1, 0}, {}, limits));
        CHECK(bent.take_in({1, 0, 0}, {}, limits));
        CHECK_FALSE(bent.take_in({1.2, 0, 0}, {}, limits));

        EnergyBalance pressed = begun({0, 0, 0.01});
        CHECK(pressed.take_in({0.01, 0, 0}, {}, limits));
        EnergyBalance free = begun({0, 0, 0});
        CHECK_FALSE(free.take_in({0.01, 0, 0}, {}, limits));
    }

    TEST_CASE("property: what was lost does not pay for what is made later")
    {
        EnergyBalance balance = begun({1, 0, 0});
        CHECK(balance.take_in({0, 0, 0}, {}, limits));  // a dashpot took it all
        CHECK_FALSE(balance.take_in({0.2, 0, 0}, {}, limits));
        CHECK(balance.made() == about(0.2).epsilon(1e-12));
    }

    TEST_CASE("property: carried in by material, and unseen in a jerk, nothing is made; where nothing moves, nothing grows")
    {
        EnergyBalance balance = begun({});
        CHECK(balance.take_in({0.5, 0.5, 0}, {0, 1, 0}, limits));
        CHECK(balance.take_in({1, 0.5, 0}, {0, 0, 0.5}, limits));
        EnergyBalance still = begun({});
        CHECK(still.take_in({0, 1, 0}, {}, limits));
        CHECK(still.made() == about(1.0).epsilon(1e-12));  // told, if not judged
    }

    TEST_CASE("property: energies that begin with a step count from its end")
    {
        EnergyBalance balance;
        balance.begin_after({3, 4, 0}, {5, 0, 0});
        CHECK(balance.made() == 0);
        CHECK(balance.take_in({3, 4, 0}, {}, limits));
        CHECK(balance.made() == 0);
    }
}

}  // namespace seldinger::test::test_energy_balance
