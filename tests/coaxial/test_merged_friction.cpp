// Friction between instruments that share one centreline, by its laws per length: hand forces, twist, energy. The law itself:
// tests/contact/test_coaxial_slip.cpp; of what presses in the lumen: test_merged_lumen.cpp.

#include "coaxial/friction_fixture.h"
#include "contact/rods/coaxial_friction.h"
#include "core/state_walk.h"
#include "support/steps.h"
#include "world/merged.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger::test::test_merged_friction {

namespace {

/// Turn of an instrument's first edge about the direction of insertion, behind its hub's [rad].
double lag(const World& world, int wire) { return world.readings(wire).turned + world.rod(wire).theta[0]; }

}  // namespace

TEST_SUITE("coaxial/merged friction")
{
    // Dry: q L whatever the speed; a film: c L v. To rounding of the fed length, and of line's elasticity beside it
    TEST_CASE("analytic: an instrument pushed through another one is held by q L + c L v, and holds that one")
    {
        const double overlap = 0.05, speed = 0.02, drag = 0.4, film = 3.0;
        for (const auto [q, c] : {std::pair{drag, 0.0}, {0.0, film}, {drag, film}}) {
            CAPTURE(q);
            World world(straight_pair(overlap, 0.09, q, c));
            WireReadings inner = move(world, 1, speed, 0, 20, 1e-3);
            const double expected = (q + c * speed) * overlap;
            CHECK(inner.hand_force == about(expected).epsilon(1e-4));  // of what hands feel beside it: momentum of what is fed
            CHECK(world.readings(0).hand_force == about(-expected).epsilon(1e-4));
            inner = move(world, 1, -speed, 0, 20, 1e-3);
            CHECK(inner.hand_force == about(-expected).epsilon(1e-4));
            CHECK(world.readings(0).hand_force == about(expected).epsilon(1e-4));
            // the outer one over it: as much, and less far over it less
            const WireReadings outer = move(world, 0, -speed, 0, 500, 1e-3);
            CHECK(outer.hand_force == about(-(q + c * speed) * (overlap - 0.01)).epsilon(1e-3));
        }
    }

    TEST_CASE("analytic: within the inner one, and three deep, only neighbours rub where they overlap")
    {
        // the inner one's tip is inside: it rubs as far as it is in
        World inside(straight_pair(0.08, 0.03, 0.4, 0));
        const WireReadings drawn = move(inside, 1, -0.02, 0, 50, 1e-3);
        CHECK(drawn.hand_force == about(-0.4 * 0.029).epsilon(1e-3));
        // a sheath of 30 mm, a catheter drawn back to 20 in it, a wire 60 in: The wire rubs on the catheter over 20, on the
        // sheath over the 10 beyond it. Catheter and sheath are at rest and do not rub on each other
        const WireSpec one = instrument_of({{0.4, bend, 0}}, 0.5);
        WorldSetup setup = merged_setup({one, one, one}, {0.03, 0.02, 0.06}, 2e-3, Scheme::Newton);
        setup.coaxial[0].drag = 0.5;
        World world(setup);
        const WireReadings wire = move(world, 2, 0.02, 0, 20, 1e-3);
        CHECK(wire.hand_force == about(0.5 * 0.03).epsilon(1e-3));
        CHECK(world.readings(1).hand_force == about(-0.5 * 0.02).epsilon(1e-3));
        CHECK(world.readings(0).hand_force == about(-0.5 * 0.01).epsilon(1e-3));
    }

    // A shaft with a torque m per length: C theta'' = m, twisted by m L^2/(2 C) from its free end to its hub, where it takes m
    // L. Exact for whole edges: h/C (m h (1 + ... + (N - 1)) + N m h/2).
    TEST_CASE("analytic: turned in another one it lags by r q L^2/(2 C), and turns that one by as much of its own")
    {
        const double length = 0.1, drag = 2.0;
        for (const Scheme scheme : {Scheme::Newton, Scheme::Static}) {
            World world(straight_pair(length, length, drag, 0, scheme));
            const WireReadings inner = move(world, 1, 0, 1.0, 60, 1e-2);
            const double torque = radius * drag * length;
            CHECK(inner.hand_torque == about(torque).epsilon(1e-5));
            CHECK(world.readings(0).hand_torque == about(-torque).epsilon(1e-5));
            CHECK(lag(world, 1) == about(torque * length / (2 * twist)).epsilon(1e-5));
            CHECK(lag(world, 0) == about(-torque * length / (20 * twist)).epsilon(1e-5));
        }
    }

    // Fast along and slowly round, friction is against the way: round it is r w/v of q, a film's
    TEST_CASE("analytic: what slides along turns almost freely")
    {
        World world(straight_pair(0.1, 0.12, 2.0, 0));
        const double push = 0.02, turn = 4.0;
        const WireReadings inner = move(world, 1, push, turn, 100, 1e-3);
        const double around = radius * turn, size = std::hypot(around, push);
        CHECK(inner.hand_torque == about(radius * 2.0 * 0.1 * around / size).epsilon(1e-3));
        CHECK(inner.hand_force == about(2.0 * 0.1 * push / size).epsilon(1e-3));
    }

    // Relative angles diffuse: phi'' = (1/C_i + 1/C_o) c r^2 d(phi)/dt. The slowest mode, a quarter of a wave from hub to tip,
    // is left after a while; in backward Euler it shrinks by 1/(1 + rate h) a step. It differs from the discrete modes by (pi
    // h/4L)^2/3.
    TEST_CASE("analytic: in a film, twist fades as by diffusion")
    {
        const double length = 0.1, film = 4e3, dt = 1e-3;
        World world(straight_pair(length, length, 0, film));
        (void)move(world, 1, 0, 5.0, 100, dt);
        const double give = 1 / twist + 1 / (10 * twist);
        const double rate = std::pow(pi / (2 * length), 2) / (give * film * radius * radius);
        // the second mode fades nine times as fast
        (void)move(world, 1, 0, 0, static_cast<int>(std::ceil(1.0 / (rate * dt))), dt);
        const double before = lag(world, 1);
        REQUIRE(before > 1e-3);
        const int steps = 100;
        (void)move(world, 1, 0, 0, steps, dt);
        CHECK(std::log(before / lag(world, 1)) == about(steps * std::log(1 + rate * dt)).epsilon(1e-3));
    }

    // Less than what gives: a spring from hub to hub that returns everything
    TEST_CASE("property: short of slipping it sticks, and gives back what it took")
    {
        World world(straight_pair(0.05, 0.08, 0.4, 0));
        const double give = 1e-5;
        WireReadings inner = move(world, 1, 1e-3, 0, 5, 1e-3);  // half of it
        CHECK(inner.hand_force == about(0.5 * 0.4 * 0.05).epsilon(1e-3));
        const EnergyLedger held = world.readings(0).energy;
        inner = move(world, 1, -1e-3, 0, 5, 1e-3);
        CHECK(std::abs(inner.hand_force) < 1e-4 * 0.4 * 0.05);
        // each of 5 steps takes k (give/10)^2/2 more than is stored, both ways; counted from the end of the first on, which took
        // one of these and stored another
        const double step_loss = 0.5 * 0.4 / give * 0.05 * std::pow(1e-6, 2);
        CHECK(held.friction > 0);
        CHECK(world.readings(0).energy.friction == about((2 * 5 - 2) * step_loss).epsilon(1e-3));
        // turned by half of what gives: phi'' = (1/C_i + 1/C_o) k r^2 phi between them
        inner = move(world, 1, 0, 0.5 * give / radius / 5e-3, 5, 1e-3);
        const double grip = 0.4 / give * radius * radius, decay = std::sqrt((1 / twist + 1 / (10 * twist)) * grip);
        CHECK(inner.hand_torque == about(grip * 0.5 * give / radius * std::tanh(decay * 0.05) / decay).epsilon(1e-3));
    }

    TEST_CASE("property: energies and momentum are closed while instruments go and turn through each other")
    {
        WorldSetup setup = merged_setup({instrument_of(0.4, bend, twist, 0.03, 15), instrument_of(0.6, bend, twist, 0.02, 25)},
                                        {0.05, 0.06}, 2e-3, Scheme::Newton);
        setup.gravity = {0, 0, -9.81};
        setup.integrator.damping_mass = 20;
        setup.coaxial[0].drag = 1.0;
        setup.coaxial[0].viscous = 2.0;
        World world(setup);
        CHECK(swing_through_each_other(world, 1200, 400, 0.02) < 1e-6);  // what the solver leaves on 40 nodes
        const EnergyLedger& ledger = world.readings(0).energy;
        CHECK(ledger.friction > 0.5e-3);  // some 60 mN over 0.3 m, a part of it stuck
        CHECK(ledger.friction > 10 * std::abs(ledger.damping));
        CHECK(std::abs(ledger.open()) < 0.002 * ledger.friction);
        CHECK(world.readings(0).energy_made < 0.01 * ledger.friction);
    }

    // Cells are the outer one's: their memory does not depend on nodes. Stuck and turned, both are fed by 22 mm together. The
    // length that has come in since has not slipped, and the stuck length twists both on as it gets farther from the hands: a
    // part of the torque is left.
    TEST_CASE("property: what is remembered goes along with the instruments, not with nodes")
    {
        const auto torque_after = [](double edge, bool adaptive) {
            WorldSetup setup = straight_pair(0.05, 0.06, 4.0, 0);
            for (WireSetup& wire : setup.wires) {
                wire.wire.nodes = adaptive ? 0 : static_cast<int>(std::lround(wire.wire.length / edge)) + 1;
                wire.wire.min_edge = edge;
                wire.wire.max_edge = 8 * edge;
            }
            World world(setup);
            const double turned = move(world, 1, 0, 2.0, 5, 1e-3).hand_torque;
            const int nodes = world.rod(1).n;
            int changes = 0, last = nodes;
            for (int k = 1; k <= 440; ++k) {
                step_to(world, 1e-3, {{0.05 + 5e-5 * k}, {0.06 + 5e-5 * k, 0.01}});
                changes += world.rod(1).n != last;
                last = world.rod(1).n;
            }
            REQUIRE(changes > 3);
            CHECK(std::abs(world.readings(1).hand_force) < 1e-3 * 4.0 * 0.05);
            CHECK(world.readings(1).hand_torque < turned);
            return world.readings(1).hand_torque;
        };
        const double even = torque_after(1e-3, false);
        CHECK(even > 5e-6);
        CHECK(torque_after(2e-3, false) == about(even).epsilon(0.02));  // the twist at a new node, over an edge: h/L
        CHECK(torque_after(1e-3, true) == about(even).epsilon(0.04));
    }

    TEST_CASE("property: a run that is taken up again ends with the same bits, alone and beside another one")
    {
        const auto ways = [](World& world, int from, int to) {
            for (int k = from + 1; k <= to; ++k) {
                Control control;
                for (int w = 0; w < world.wire_count(); w += 2) {
                    control.move_to(w, 0.05 + 1e-5 * k, 0);
                    control.move_to(w + 1, 0.06 + 2e-3 * std::sin(0.05 * k), 0.01 * k);
                }
                REQUIRE_FALSE(step(world, control, 1e-3).failed());
            }
        };
        const WorldSetup setup = straight_pair(0.05, 0.06, 1.0, 0.5), other = straight_pair(0.05, 0.06, 0, 0);
        const TakenUp runs(setup, ways, 120, 200);
        CHECK(runs.second.readings(1).hand_torque == runs.whole.readings(1).hand_torque);

        WorldSetup both = other;  // without friction, then with it
        both.wires.insert(both.wires.end(), setup.wires.begin(), setup.wires.end());
        both.systems = {2, 2};
        both.coaxial.push_back(setup.coaxial[0]);
        both.coaxial[1].order = {2, 3};
        World together(both), plain(other);
        ways(together, 0, 120);
        ways(plain, 0, 120);
        CHECK(together.state_hash(1) == runs.first.state_hash(0));
        CHECK(together.state_hash(0) == plain.state_hash(0));
        World third(setup);
        third.restore_state(0, together.save_state(1));
        CHECK(third.save_state(0) == together.save_state(1));

        std::vector<std::uint8_t> bytes;
        CoaxialFriction& friction = *data_of(third).forces.coaxial_friction;
        StateWalk out(bytes);
        friction.walk_state(out, 0);
        StateWalk in(bytes, false);
        CHECK_NOTHROW(friction.walk_state(in, 0));
        CHECK(in.left() == 0);
        const double wrong = NAN;
        std::memcpy(bytes.data() + 48, &wrong, sizeof wrong);
        StateWalk damaged(bytes, false);
        CHECK_THROWS_WITH_AS(friction.walk_state(damaged, 0), doctest::Contains("friction between instruments"), Error);
    }

    TEST_CASE("property: laws that are none are refused")
    {
        for (const double wrong : {-1.0, double(INFINITY), double(NAN)}) {
            WorldSetup setup = straight_pair(0.05, 0.06, wrong, 0);
            CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("coaxial[0].drag"), Error);
            setup = straight_pair(0.05, 0.06, 0, wrong);
            CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("coaxial[0].viscous"), Error);
        }
    }
}

}  // namespace seldinger::test::test_merged_friction
