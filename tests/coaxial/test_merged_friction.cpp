// Friction between instruments that share one centreline, by its laws per length: what hands feel, what is twisted, where energy
// goes. The law itself: tests/contact/test_coaxial_slip.cpp.

#include "coaxial/merged_fixture.h"
#include "contact/coaxial_friction.h"
#include "merged.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

using namespace seldinger;
using namespace seldinger::test;

namespace {

constexpr double radius = 0.5e-3;          // of the fixture's instruments [m]
constexpr double bend = 2e-4, twist = 1e-4;  // [N m^2]

/// Straight by nature, along +x.
WorldSetup straight_pair(double outer, double inner, double drag, double viscous, Scheme scheme = Scheme::Newton)
{
    WorldSetup setup =
        merged_setup({instrument_of({{0.4, bend, 0}}, 10 * twist / bend), instrument_of({{0.6, bend, 0}}, twist / bend)}, {outer, inner},
                     2e-3, scheme);
    setup.integrator.tolerance = 1e-9;
    setup.coaxial[0].drag = drag;
    setup.coaxial[0].viscous = viscous;
    return setup;
}

/// Steps of dt with hub `wire` moved at these rates, the others at rest. @return its readings at the end
WireReadings move(World& world, int wire, double push, double turn, int steps, double dt)
{
    for (int k = 0; k < steps; ++k) {
        const WireReadings at = world.readings(wire);
        const FeedSpec& from = world.setup().wires[static_cast<std::size_t>(wire)].feed;
        Control control;
        control.move_to(wire, from.advance + at.inserted + push * dt, from.turn + at.turned + turn * dt);
        REQUIRE_FALSE(step(world, control, dt).failed());
    }
    return world.readings(wire);
}

/// Turn of an instrument's first edge about the direction of insertion, behind its hub's [rad].
double lag(const World& world, int wire) { return world.readings(wire).turned + world.rod(wire).theta[0]; }

}  // namespace

TEST_SUITE("coaxial/merged friction")
{
    // Dry: q L whatever the speed; a film: c L v. To rounding of what is fed, and of line's elasticity beside it
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
        // a sheath of 30 mm, a catheter drawn back to 20 in it, a wire 60 in: the wire rubs on the catheter over 20, on the sheath
        // over the 10 beyond it, and the catheter, at rest, on neither
        WorldSetup setup = merged_setup({instrument_of({{0.4, bend, 0}}, 0.5), instrument_of({{0.4, bend, 0}}, 0.5), instrument_of({{0.4, bend, 0}}, 0.5)},
                                        {0.03, 0.02, 0.06}, 2e-3, Scheme::Newton);
        setup.coaxial[0].drag = 0.5;
        World world(setup);
        const WireReadings wire = move(world, 2, 0.02, 0, 20, 1e-3);
        CHECK(wire.hand_force == about(0.5 * 0.03).epsilon(1e-3));
        CHECK(world.readings(1).hand_force == about(-0.5 * 0.02).epsilon(1e-3));
        CHECK(world.readings(0).hand_force == about(-0.5 * 0.01).epsilon(1e-3));
    }

    // A shaft with a torque m per length: C theta'' = m, twisted by m L^2/(2 C) from its free end to its hub, where it takes m L. Of
    // whole edges that is exact: h/C (m h (1 + ... + (N - 1)) + N m h/2).
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

    // Relative angles diffuse: phi'' = (1/C_i + 1/C_o) c r^2 d(phi)/dt, of which the slowest mode, a quarter of a wave from hub to
    // tip, is left after a while; in backward Euler by 1/(1 + rate h) a step. Of the discrete modes it is off by (pi h/4L)^2/3.
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
        // each of 5 steps takes k (give/10)^2/2 more than is stored, both ways; counted from the end of the first on, which took one of
        // these and stored another
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
        WorldSetup setup = merged_setup({instrument_of(0.4, bend, twist, 0.03, 15), instrument_of(0.6, bend, twist, 0.02, 25)}, {0.05, 0.06},
                                        2e-3, Scheme::Newton);
        setup.gravity = {0, 0, -9.81};
        setup.integrator.damping_mass = 20;
        setup.coaxial[0].drag = 1.0;
        setup.coaxial[0].viscous = 2.0;
        World world(setup);
        for (int k = 1; k <= 1200; ++k) {
            const double phase = 2 * pi * k / 400;
            Control control;
            control.move_to(0, 0.05 + 0.02 * (1 - std::cos(phase)), 0.5 * std::sin(phase));
            control.move_to(1, 0.06 + 0.02 * std::sin(phase), 0.004 * k);
            REQUIRE_FALSE(step(world, control, 1e-3).failed());
            const MomentumBalance& balance = world.readings(0).momentum;
            REQUIRE(balance.error().norm() < 1e-6);  // what the solver leaves on 40 nodes
        }
        const EnergyLedger& ledger = world.readings(0).energy;
        CHECK(ledger.friction > 0.5e-3);  // some 60 mN over 0.3 m, a part of it stuck
        CHECK(ledger.friction > 10 * std::abs(ledger.damping));
        CHECK(std::abs(ledger.open()) < 0.002 * ledger.friction);
        CHECK(world.readings(0).energy_made < 0.01 * ledger.friction);
    }

    // Cells are the outer one's: what they remember does not know of nodes. Stuck and turned, both are fed by 22 mm together. What has
    // come in since has not slipped, and what is stuck twists both on as it gets farther from the hands: a part of the torque is left.
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
                Control control;
                control.move_to(0, 0.05 + 5e-5 * k, 0);
                control.move_to(1, 0.06 + 5e-5 * k, 0.01);
                REQUIRE_FALSE(step(world, control, 1e-3).failed());
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
            for (int k = from; k <= to; ++k) {
                Control control;
                for (int w = 0; w < world.wire_count(); w += 2) {
                    control.move_to(w, 0.05 + 1e-5 * k, 0);
                    control.move_to(w + 1, 0.06 + 2e-3 * std::sin(0.05 * k), 0.01 * k);
                }
                REQUIRE_FALSE(step(world, control, 1e-3).failed());
            }
        };
        const WorldSetup setup = straight_pair(0.05, 0.06, 1.0, 0.5), other = straight_pair(0.05, 0.06, 0, 0);
        World whole(setup), first(setup), second(setup);
        ways(whole, 1, 200);
        ways(first, 1, 120);
        second.restore_state(first.save_state());
        CHECK(second.state_hash() == first.state_hash());
        ways(second, 121, 200);
        CHECK(second.state_hash() == whole.state_hash());
        CHECK(second.readings(1).hand_torque == whole.readings(1).hand_torque);

        WorldSetup both = other;  // without friction, then with it
        both.wires.insert(both.wires.end(), setup.wires.begin(), setup.wires.end());
        both.systems = {2, 2};
        both.coaxial.push_back(setup.coaxial[0]);
        both.coaxial[1].order = {2, 3};
        World together(both), plain(other);
        ways(together, 1, 120);
        ways(plain, 1, 120);
        CHECK(together.state_hash(1) == first.state_hash(0));
        CHECK(together.state_hash(0) == plain.state_hash(0));
        World third(setup);
        third.restore_state(0, together.save_state(1));
        CHECK(third.save_state(0) == together.save_state(1));

        std::vector<std::uint8_t> bytes;
        CoaxialFriction& friction = *third.impl().coaxial_friction;
        friction.save_wire(bytes, 0);
        const std::uint8_t* at = bytes.data();
        CHECK_NOTHROW(friction.restore_wire(at, bytes.data() + bytes.size(), 0));
        CHECK(at == bytes.data() + bytes.size());
        const double wrong = NAN;
        std::memcpy(bytes.data() + 48, &wrong, sizeof wrong);
        at = bytes.data();
        CHECK_THROWS_WITH_AS(friction.restore_wire(at, bytes.data() + bytes.size(), 0), doctest::Contains("friction between instruments"), Error);
    }

    // A curved catheter over a straight wire at a clearance of 0.1 mm, the wire pushed: what presses is what straightens the one and
    // bends the other. `separate` finds that by contact. Friction is what a hand feels more than without it; the rest, which bends both
    // as a change of stiffness comes in, is in a merged line where that is, and spread over the clearance's way where it is not.
    // 3 % was seen, 12 where friction changes fast.
    TEST_CASE("independent: friction of what presses in the lumen is that of a rod each")
    {
        const auto setup_of = [](CoaxialSpec::Model model, bool friction) {
            WorldSetup setup = merged_setup({instrument_of({{0.005, 3e-4, 0}, {0.012, 3e-4, 65}, {0.383, 3e-4, 0}}, 1),
                                             instrument_of({{0.05, 2e-5, 0}, {0.55, 2.9e-4, 0}}, 0.77)},
                                            {0.06, 0.05}, 1e-3, Scheme::Newton);
            const double radii[2] = {0.833e-3, 0.4445e-3};
            for (std::size_t w = 0; w < 2; ++w) {
                WireSpec& wire = setup.wires[w].wire;
                wire.shaft.radius = radii[w];
                for (WireSectionRange& range : wire.sections) range.section.radius = radii[w];
            }
            setup.wires[0].wire.lumen_radius = 0.55e-3;
            setup.integrator.damping_mass = 20;
            setup.integrator.tolerance = 1e-6;
            setup.coaxial[0].model = model;
            setup.coaxial[0].lumen_friction = friction;
            if (!friction) setup.coaxial[0].mu_static = setup.coaxial[0].mu_sliding = 0;
            return setup;
        };
        const auto hand_forces = [&](CoaxialSpec::Model model, bool friction) {
            World world(setup_of(model, friction));
            std::vector<double> means;  // over 4 mm each
            double sum = 0;
            for (int k = 1; k <= 800; ++k) {  // its soft part goes through the bend, then its shaft comes into it
                Control control;
                control.move_to(0, 0.06, 0);
                control.move_to(1, 0.05 + 8e-5 * k, 0);
                REQUIRE_FALSE(step(world, control, 4e-3).failed());
                sum += world.readings(1).hand_force / 50;
                if (k % 50 == 0) means.push_back(std::exchange(sum, 0));
            }
            return means;
        };
        using enum CoaxialSpec::Model;
        const std::vector<double> with = hand_forces(Merged, true), without = hand_forces(Merged, false);
        const std::vector<double> contact = hand_forces(Separate, true), smooth = hand_forces(Separate, false);
        double least = 1, most = 0;
        for (std::size_t k = 0; k < with.size(); ++k) {
            const double predicted = with[k] - without[k], found = contact[k] - smooth[k];
            CAPTURE(k);
            CHECK(predicted == about(found).epsilon(0.15));
            least = std::min(least, found), most = std::max(most, found);
        }
        CHECK(most > 6 * least);  // it has been through a wide range: 23 to 247 mN
        CHECK(with.back() == about(contact.back()).epsilon(0.05));
    }

    // Euler's T e^(mu phi). The wire is soft: what bends it presses by less than a thousandth of that. In the clearance it goes round on
    // the inside, c/R shorter. The tension is a step behind, which is at rest by then.
    TEST_CASE("analytic: a soft wire drawn through a curved catheter, with a weight at its tip")
    {
        const double pull = 0.4, radius_of_bend = 0.04;
        for (const double mu : {0.05, 0.2}) {
            WorldSetup setup = merged_setup({instrument_of({{0.5 * pi * radius_of_bend, 1e-2, 1 / radius_of_bend}, {0.3, 1e-2, 0}}, 1),
                                             instrument_of({{0.5, 1e-8, 0}}, 1)},
                                            {0.5 * pi * radius_of_bend, 0.5 * pi * radius_of_bend + 0.01}, 1e-3, Scheme::Newton);
            setup.wires[0].wire.lumen_radius = 0.49e-3;
            WireSpec& wire = setup.wires[1].wire;
            wire.shaft.radius = 0.4e-3;
            wire.shaft.stretch_stiffness = 2e4;
            for (WireSectionRange& range : wire.sections) range.section = wire.shaft;
            setup.wires[0].wire.lumen_radius = 0.49e-3;
            setup.integrator.damping_mass = 100;
            setup.integrator.tolerance = 1e-6;
            setup.coaxial[0].lumen_friction = true;
            setup.coaxial[0].mu_static = setup.coaxial[0].mu_sliding = mu;
            LoadSpec weight;
            weight.at.kind = WirePoint::Kind::Tip;
            weight.force = {0, 0, pull};  // the way it leaves, after a quarter turn to +z
            weight.ramp = 0.05;
            setup.wires[1].loads.push_back(weight);
            World world(setup);
            (void)move(world, 1, 0, 0, 200, 1e-3);
            const WireReadings drawn = move(world, 1, -0.01, 0, 200, 1e-3);
            CHECK(-drawn.hand_force == about(pull * std::exp(0.5 * pi * mu)).epsilon(0.01));
            CHECK(world.readings(0).hand_force == about(pull * (std::exp(0.5 * pi * mu) - 1)).epsilon(0.05));
        }
    }

    // A force F across the tip, `a` beyond the mouth of a stiff catheter: the rim takes F + M/l and the lumen M/l, M = F a, l^2 =
    // 12 B c/M. The lumen gives by as much as in rod/test_lumen_press, 2 %, and at the hub, eight times as far on, they are held in each
    // other's middle: 1 %.
    TEST_CASE("analytic: a force beyond the mouth is levered against the lumen")
    {
        const double beyond = 0.04, across = 5e-3, stiffness = 1e-4, room = 1e-4, mu = 0.2;
        const auto hand = [&](bool friction) {
            WorldSetup setup =
                merged_setup({instrument_of({{0.3, 1.0, 0}}, 1), instrument_of({{0.5, stiffness, 0}}, 1)}, {0.2, 0.2 + beyond}, 1e-3, Scheme::Newton);
            setup.wires[0].wire.lumen_radius = radius + room;
            for (WireSectionRange& range : setup.wires[0].wire.sections) range.section.radius = 2 * radius;
            setup.wires[0].wire.shaft.radius = 2 * radius;
            setup.integrator.damping_mass = 100;
            setup.integrator.tolerance = 1e-7;
            setup.coaxial[0].lumen_friction = friction;
            setup.coaxial[0].mu_static = setup.coaxial[0].mu_sliding = mu;
            LoadSpec load;
            load.at.kind = WirePoint::Kind::Tip;
            load.force = {0, 0, across};
            load.ramp = 0.1;
            setup.wires[1].loads.push_back(load);
            World world(setup);
            (void)move(world, 1, 0, 0, 300, 2e-3);
            return move(world, 1, -1e-3, 0, 100, 1e-3).hand_force;
        };
        const double moment = across * (beyond - 1e-4), lever = std::sqrt(12 * stiffness * room / moment);
        CHECK(hand(false) - hand(true) == about(mu * (across + 2 * moment / lever)).epsilon(0.05));
    }

    TEST_CASE("property: what presses is of the saved state, and needs room in the lumen")
    {
        WorldSetup setup = straight_pair(0.05, 0.06, 0, 0);
        setup.coaxial[0].lumen_friction = true;
        CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("wires[0].wire.lumen_radius"), Error);
        setup.wires[0].wire.lumen_radius = 0.6e-3;
        setup.wires[0].wire.sections.push_back({0, 0.02, section_of(bend, twist, 20)});
        const auto ways = [](World& world, int from, int to) {
            for (int k = from; k <= to; ++k) {
                Control control;
                control.move_to(0, 0.05, 0);
                control.move_to(1, 0.06 - 0.02 * (1 - std::cos(0.02 * k)), 2e-3 * k);
                REQUIRE_FALSE(step(world, control, 1e-3).failed());
            }
        };
        World whole(setup), first(setup), second(setup);
        ways(whole, 1, 300);
        ways(first, 1, 60);
        second.restore_state(first.save_state());
        CHECK(second.state_hash() == first.state_hash());
        ways(first, 61, 61);  // later on what was there is forgotten
        ways(second, 61, 61);
        CHECK(second.state_hash() == first.state_hash());
        CHECK(std::abs(first.readings(1).hand_force) > 1e-3);
        CHECK(second.readings(1).hand_force == first.readings(1).hand_force);
        ways(second, 62, 300);
        CHECK(second.state_hash() == whole.state_hash());
        CHECK(std::abs(whole.readings(1).hand_force) > 1e-3);
        const EnergyLedger& ledger = whole.readings(0).energy;
        CHECK(ledger.friction > 1e-5);
        CHECK(std::abs(ledger.open()) < 0.01 * ledger.friction);
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
