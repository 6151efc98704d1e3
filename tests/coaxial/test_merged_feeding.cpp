// Instruments that share one centreline pushed and drawn through each other: energy, hands, the leader, saved states.

#include "coaxial/merged_fixture.h"
#include "support/steps.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace seldinger::test::test_merged_feeding {

namespace {

/// A catheter with a bent end over a wire with another one.
WorldSetup catheter_and_wire(double catheter, double wire, double edge = 2e-3)
{
    WorldSetup setup = merged_setup({instrument_of(0.6, 2e-4, 1.5e-4, 0.03, 15), instrument_of(0.8, 1e-4, 7.7e-5, 0.02, 25)},
                                    {catheter, wire}, edge, Scheme::Newton);
    setup.gravity = {0, 0, -9.81};
    setup.integrator.damping_mass = 20;
    setup.integrator.tolerance = 1e-7;
    return setup;
}

struct Way {
    double until, catheter, wire, turn;  // [s], [m], [m], of the wire [rad]
};

/// Steps `first` to `last` along straight ways between places. @return how many failed
int follow(World& world, const std::vector<Way>& ways, double dt, int first, int last)
{
    int failed = 0;
    for (int k = first; k <= last; ++k) {
        const double t = k * dt;
        std::size_t w = 1;
        while (w + 1 < ways.size() && ways[w].until < t - 1e-12) ++w;
        const Way &a = ways[w - 1], &b = ways[w];
        const double share = std::clamp((t - a.until) / (b.until - a.until), 0.0, 1.0);
        const auto at = [&](double Way::*what) { return a.*what + share * (b.*what - a.*what); };
        Control control;
        control.move_to(0, at(&Way::catheter), 0);
        control.move_to(1, at(&Way::wire), at(&Way::turn));
        failed += step(world, control, dt).failed();
    }
    return failed;
}

// The wire goes out of the catheter and turns, comes back into it, and the catheter moves on over it and back
const std::vector<Way> through_each_other = {{0, 0.05, 0.06, 0},     {0.3, 0.05, 0.09, 1.0},  {0.6, 0.07, 0.09, 1.0},
                                             {0.9, 0.07, 0.05, 1.0}, {1.2, 0.08, 0.05, -0.5}, {1.5, 0.05, 0.08, 0}};

}  // namespace

TEST_SUITE("coaxial/merged feeding")
{
    TEST_CASE("property: through each other, with the energies closed")
    {
        World world(catheter_and_wire(0.05, 0.06));
        CHECK(follow(world, through_each_other, 1e-3, 1, 1500) == 0);
        CHECK(std::abs(world.readings(0).inserted) < 1e-12);
        CHECK(std::abs(world.readings(1).inserted - 0.02) < 1e-12);
        const EnergyLedger& ledger = world.readings(0).energy;
        const double turned_over = std::max({std::abs(ledger.hand), std::abs(ledger.wire), ledger.damping, ledger.scheme});
        CHECK(std::abs(ledger.open()) < 0.002 * turned_over);  // 0.05 %: of the feed's jolts at the start and at the turns
        CHECK(world.readings(0).energy_made < 0.01 * turned_over);
        // each as long as it is in, its nodes where the line is
        for (const int w : {0, 1}) {
            const ConstRodView rod = world.rod(w);
            const double inside = w == 0 ? 0.05 : 0.08;
            CHECK(rod.material_s[0] == 0);
            CHECK(rod.material_s[rod.n - 1] == about(inside).epsilon(1e-3));
            CHECK(rod.pos(rod.n - 1).norm() < 1e-12);
        }
    }

    // The elastic force that drives a knee out of the instrument that straightens it. Bent against each other, both store B_r
    // kappa^2/2 per length, B_r = B B'/(B + B'), whatever else bends them; the knee alone stores nothing. Virtual work: that is
    // what the hands feel, opposite to each other, as long as the mouth is within the knee. A change of section within a cell
    // is exact.
    TEST_CASE("analytic: a knee is driven out of a sheath by half of what both store per length")
    {
        const double sheath = 8e-4, bend = 3.1e-4, kappa = 65.4, force = 0.5 * sheath * bend / (sheath + bend) * kappa * kappa;
        const WireSpec outer = instrument_of({{0.3, sheath, 0}}, 1),
                       knee = instrument_of({{0.005, bend, 0}, {0.012, bend, kappa}, {0.3, bend, 0}}, 1);
        for (int k = 0; k <= 10; ++k) {
            const double inner = 0.036 + 1e-3 * k;
            World world(merged_setup({outer, knee}, {0.03, inner}, 2e-3));
            for (int round = 0; round < 2; ++round) {
                step_to(world, 1e-3, {{0.03}, {inner}});
            }
            CHECK(world.readings(0).hand_force == about(force).epsilon(2e-3));
            CHECK(world.readings(1).hand_force == about(-force).epsilon(2e-3));
        }
    }

    TEST_CASE("property: a run that is taken up again ends with the same bits")
    {
        const auto on = [](World& world, int from, int to) { (void)follow(world, through_each_other, 2e-3, from + 1, to); };
        const TakenUp runs(catheter_and_wire(0.05, 0.06), on, 400, 600);
    }

    // A wire that is drawn into its catheter and out again, and again: the line's tip is now the one's, now the other's.
    TEST_CASE("property: who leads changes time after time")
    {
        World world(catheter_and_wire(0.05, 0.052));
        for (int k = 1; k <= 1600; ++k) {
            Control control;
            control.move_to(0, 0.05, 0);
            control.move_to(1, 0.05 + 2e-3 * std::cos(2 * pi * k / 40), 0);  // 0.3 m/s
            REQUIRE_FALSE(step(world, control, 1e-3).failed());
        }
        for (const int w : {0, 1}) {
            const ConstRodView rod = world.rod(w);
            for (int j = 0; j < rod.n - 1; ++j) CHECK(rod.rest_length[j] < 2 * 2e-3);
            CHECK(rod.material_s[rod.n - 1] == about(w == 0 ? 0.05 : 0.052).epsilon(1e-3));
        }
        // At each change the feed of the line takes the other's speed, and the half cell at the hub follows within a step.
        // Readings at a step's ends do not see it
        const double hub_mass = 2 * 6500 * pi * 0.5e-3 * 0.5e-3 * 1e-3, speed = 2e-3 * 2 * pi / 0.04;
        CHECK(std::abs(world.readings(0).energy.open()) < 1.1 * 80 * 0.5 * hub_mass * speed * speed);
    }

    TEST_CASE("property: two systems side by side are each what it is alone")
    {
        const WorldSetup one = catheter_and_wire(0.05, 0.06), other = catheter_and_wire(0.04, 0.07);
        WorldSetup both = one;
        both.wires.insert(both.wires.end(), other.wires.begin(), other.wires.end());
        both.systems = {2, 2};
        both.coaxial.push_back(other.coaxial[0]);
        both.coaxial[1].order = {2, 3};
        World alone(one), alone_too(other), together(both);
        for (int k = 1; k <= 200; ++k) {
            Control a, b, c;
            a.move_to(0, 0.05, 0), a.move_to(1, 0.06 + 1e-4 * k, 0.005 * k);
            b.move_to(0, 0.04 + 2e-4 * k, 0), b.move_to(1, 0.07, 0);
            c.move_to(0, 0.05, 0), c.move_to(1, 0.06 + 1e-4 * k, 0.005 * k);
            c.move_to(2, 0.04 + 2e-4 * k, 0), c.move_to(3, 0.07, 0);
            CHECK_FALSE(step(alone, a, 1e-3).failed());
            CHECK_FALSE(step(alone_too, b, 1e-3).failed());
            CHECK_FALSE(step(together, c, 1e-3).failed());
        }
        CHECK(together.state_hash(0) == alone.state_hash(0));
        CHECK(together.state_hash(1) == alone_too.state_hash(0));
    }

    // Both from the introducer; alone in it the wire has the bits of one without a catheter
    TEST_CASE("property: from the introducer on, and a wire alone in the group is a wire")
    {
        WorldSetup setup = catheter_and_wire(0, 0);
        setup.wires[0].feed.advance = setup.wires[1].feed.advance = 0;
        World world(setup);
        WorldSetup plain = setup;
        plain.wires.erase(plain.wires.begin());
        plain.coaxial.clear();
        plain.systems.clear();
        World wire(plain);
        for (int k = 1; k <= 600; ++k) {
            Control both, single;
            both.move_to(1, 1e-4 * k, 0.002 * k);
            single.move_to(0, 1e-4 * k, 0.002 * k);
            REQUIRE_FALSE(step(world, both, 1e-3).failed());
            REQUIRE_FALSE(step(wire, single, 1e-3).failed());
        }
        // the same equations; births at the hub differ by what a polygon's node is off, (kappa h)^2 h
        CHECK((world.rod(1).pos(0) - wire.rod(0).pos(0)).norm() < 2e-5);
        CHECK(std::abs(world.readings(1).hand_force - wire.readings(0).hand_force) < 2e-3);
        CHECK(std::abs(world.readings(1).hand_torque - wire.readings(0).hand_torque) < 1e-6);
        CHECK(std::abs(world.readings(0).hand_force) < 1e-6);
        for (int k = 1; k <= 400; ++k) {
            step_to(world, 1e-3, {{1e-4 * k}});
        }
        CHECK(world.rod(0).material_s[world.rod(0).n - 1] == about(0.04).epsilon(1e-3));
    }

    // No torque acts on an instrument that is still in the introducer: it is untwisted, at its hub's angle, and nothing of it is
    // in the wire.
    TEST_CASE("property: a catheter that is turned before it comes in changes nothing of the wire, and comes in untwisted")
    {
        constexpr double turned = 0.7;
        WorldSetup setup = catheter_and_wire(0, 0.03);
        setup.wires[0].feed.advance = 0;
        setup.gravity = Vec3::Zero();
        for (WireSetup& wire : setup.wires) wire.wire.sections.clear();  // straight by nature
        World still(setup), world(setup);
        for (int k = 1; k <= 50; ++k)
            for (World* one : {&still, &world}) {
                step_to(*one, 1e-3, {{0, one == &world ? turned * k / 50 : 0}, {0.03 + 1e-4 * k, 0.01 * k}});
            }
        const ConstRodView wire = world.rod(1), alone = still.rod(1);
        REQUIRE(wire.n == alone.n);
        for (int j = 0; j < wire.n - 1; ++j) CHECK(wire.theta[j] == alone.theta[j]);
        CHECK(world.readings(1).energy.hand == still.readings(1).energy.hand);
        for (int k = 1; k <= 20; ++k) {
            step_to(world, 1e-3, {{1e-3 * k, turned}, {0.035, 0.5}});
            CAPTURE(k);
            CHECK(std::abs(world.readings(0).hand_torque) <= 1e-9);
        }
        CHECK(angle_deg(world, 0, 0.005) == about(180 / pi * turned).epsilon(1e-6));
    }

    // Hand and clamp are joined by the twist of the length between: torque = C (hand's turn - clamp's)/length, which gets
    // shorter.
    TEST_CASE("property: what lies behind the inlet twists, and is as long as has not been pushed in")
    {
        WorldSetup setup = merged_setup({instrument_of(0.6, 2e-4, 1.5e-4, 0.03, 15), instrument_of(0.8, 1e-4, 7.7e-5, 0.02, 25)},
                                        {0.05, 0.03}, 2e-3);
        setup.wires[1].feed.behind = 0.2;
        World world(setup);
        for (int k = 1; k <= 20; ++k) {
            step_to(world, 0.01, {{0.05}, {0.03 + 1e-3 * k, 0.05 * k}});
        }
        const ConstRodView wire = world.rod(1);
        const double at_clamp = -wire.theta[wire.n - 1], torque = world.readings(1).hand_torque;  // + turns are - theta
        REQUIRE(std::abs(torque) > 1e-6);
        REQUIRE(at_clamp < 1.0);
        CHECK(torque == about(7.7e-5 * (1.0 - at_clamp) / (0.2 - 0.02)).epsilon(1e-6));
        for (const double wrong : {-0.1, double(INFINITY), double(NAN)}) {
            setup.wires[1].feed.behind = wrong;
            CHECK_THROWS(World(setup));
        }
    }

    // As for one wire (step/test_feed): straight by nature, both hang as when they are not turned.
    TEST_CASE("property: nodes of the common line are born alike whether its hubs turn or not")
    {
        const auto fed = [](double turn_rate) {
            WorldSetup setup = merged_setup({instrument_of({{0.3, 2e-5, 0}}, 0.75), instrument_of({{0.3, 1e-5, 0}}, 0.77)},
                                            {0.02, 0.03}, 4e-3, Scheme::Newton);
            setup.gravity = {0, 0, -9.81};
            auto world = std::make_unique<World>(setup);
            for (int k = 1; k <= 300; ++k) {
                step_to(*world, 1e-3, {{0.02 + 2e-4 * k, turn_rate * 1e-3 * k}, {0.03 + 2e-4 * k, -2 * turn_rate * 1e-3 * k}});
            }
            return world;
        };
        const auto still = fed(0), turned = fed(40);
        const ConstRodView a = still->rod(1), b = turned->rod(1);
        REQUIRE(a.n == b.n);
        REQUIRE(a.pos(0).z() < -1e-3);
        const double left = 23 * 1e-7 * 0.09 / 3;  // the solver's 1e-7 of B/L^2 an edge over 3 B/L^3
        for (int i = 0; i < a.n; ++i) CHECK((a.pos(i) - b.pos(i)).norm() <= left);
        const double made = turned->readings(0).remesh_energy - still->readings(0).remesh_energy;
        CHECK(std::abs(made) <= 1e-4 * std::abs(still->readings(0).energy.wire));
    }
}

}  // namespace seldinger::test::test_merged_feeding
