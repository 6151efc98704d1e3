// Friction between wires (D9): a wire laid across two rails on an incline sticks, slides or rolls.

#include "contact/instrument_fixture.h"

#include <cmath>

namespace seldinger::test::test_instrument_friction {

namespace {

constexpr double g = 9.81, radius = 5e-4, mu = 0.2;

/// Two rails along x, held all along, in a gravity that leans by `slope` towards +x; a wire across them, its spin held or free.
/// @return how far the wire has come after `time`, and how fast it is then
struct Slid {
    double way = 0, speed = 0, spin = 0;
    bool stuck = true;
};
Slid on_rails(double slope, bool spin_held, double time)
{
    std::vector<WireSetup> wires;
    WireSetup across = straight_wire(1e-3, 1e4, 0.02, radius, 11, 1e8);
    put(across, {0, -0.01, 2 * radius - 1e-8}, Vec3::UnitY());
    if (spin_held) {
        HoldSpec hold;
        hold.spin = true;
        across.holds = {hold};
    }
    wires.push_back(across);
    for (const double side : {-1.0, 1.0}) {
        WireSetup rail = straight_wire(1, 1e6, 0.03, radius, 13, 1e8);
        put(rail, {-0.01, 5e-3 * side, 0}, Vec3::UnitX());
        for (int k = 0; k <= 12; ++k) {
            rail.holds.push_back(hold_of(WirePoint::Kind::Distance, false, k == 12));
            rail.holds.back().at.from_tip = 0.0025 * k;
        }
        wires.push_back(rail);
    }
    for (WireSetup& wire : wires) {
        wire.contact.friction = FrictionLaw::StickSlip;
        wire.wire.shaft.mu_static = wire.wire.shaft.mu_sliding = mu;
    }
    WorldSetup setup = touching(wires);
    setup.integrator.scheme = Scheme::Newton;
    setup.gravity = g * Vec3(std::sin(slope), 0, -std::cos(slope));
    World world(setup);
    const int steps = static_cast<int>(std::lround(time / 5e-4));
    for (int k = 0; k < steps; ++k) REQUIRE_FALSE(step(world, 5e-4).failed());
    Slid slid;
    slid.way = world.rod(0).x[5];
    slid.speed = world.rod(0).vx[5];
    slid.spin = world.rod(0).spin_rate[5];
    REQUIRE_FALSE(world.contacts().empty());
    for (const ContactRow& row : world.contacts()) slid.stuck = slid.stuck && row.stuck;
    return slid;
}

}  // namespace

TEST_SUITE("contact/instrument_friction")
{
    TEST_CASE("analytic: a wire that cannot turn sticks on rails less steep than mu")
    {
        const Slid slid = on_rails(0.9 * mu, true, 0.05);
        CHECK(slid.stuck);
        CHECK(std::abs(slid.speed) < 1e-6);
        CHECK(std::abs(slid.way) < 2e-6);  // the elastic slip of a stuck contact
    }

    TEST_CASE("analytic: on steeper ones it slides by g (sin - mu cos)")
    {
        const double slope = 2 * mu, time = 0.03;
        const Slid slid = on_rails(slope, true, time);
        CHECK_FALSE(slid.stuck);
        // the first milliseconds, while it settles on the rails, are not those of its weight
        CHECK(slid.speed == about(g * (std::sin(slope) - mu * std::cos(slope)) * time).epsilon(0.02));
    }

    TEST_CASE("analytic: free to turn it rolls by 2/3 g sin, sticking")
    {
        const double slope = 0.9 * mu, time = 0.03;
        const Slid slid = on_rails(slope, false, time);
        CHECK(slid.stuck);
        CHECK(slid.speed == about(2.0 / 3.0 * g * std::sin(slope) * time).epsilon(0.02));
        CHECK(std::abs(slid.spin) * radius == about(slid.speed).epsilon(0.02));
    }
}

}  // namespace seldinger::test::test_instrument_friction
