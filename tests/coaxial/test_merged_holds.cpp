// Holds of instruments that share one centreline: a place of the material is held wherever it lies between the line's nodes.

#include "coaxial/straight_pair.h"
#include "rod/transport.h"
#include "solve/line_holds.h"
#include "support/steps.h"
#include "world/merged.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace seldinger::test::test_merged_holds {

namespace {

constexpr double pair_bend = 1.5 * bend;

HoldSpec hold_at(double from_tip, bool position, bool direction, bool spin)
{
    return {.at = {WirePoint::Kind::Distance, from_tip}, .position = position, .direction = direction, .spin = spin};
}

/// An arbitrary shape of a pair, accepted with the frames that it is carried to. @return unknowns of its second instrument
std::vector<double> bend_at_random(WorldData& data, std::mt19937& random)
{
    std::uniform_real_distribution<double> noise(-1, 1);
    constrain_member(data, *data.groups.list[0], 0, 1);
    constrain_member(data, *data.groups.list[0], 1, 1);
    const RodView line = data.rod(0);
    std::vector<double> q(RodDofs::count(line.n));
    for (int i = 0; i < line.n; ++i) {
        const Vec3 x = line.pos(i) + 2e-4 * Vec3(noise(random), noise(random), noise(random));
        for (int c = 0; c < 3; ++c) q[RodDofs::position(i, c)] = x[c];
        q[RodDofs::spin(i)] = 0.3 * noise(random);
        line.set_pos(i, x);
    }
    for (int j = 0; j + 1 < line.n; ++j) {
        const Vec3 from = line.tangent(j), to = (line.pos(j + 1) - line.pos(j)).normalized();
        line.set_ref_d1(j, parallel_transport(line.ref_d1(j), from, to, one_plus_cos(from, to)));
        line.set_tangent(j, to);
    }
    return q;
}

HoldSpec lifted(double from_tip, double height, bool direction = false)
{
    HoldSpec hold = hold_at(from_tip, true, direction, false);
    hold.move = {{0, 0, 0, 0}, {1e-3, 0, 0, height}};
    return hold;
}

}  // namespace

TEST_SUITE("coaxial/merged holds")
{
    // Two straight instruments, in as far as each other, are one wire of both stiffnesses and both densities. At a node of both
    // lines the clamp is the single wire's in the turn of a cell's half, phi: what differs is of order phi^2 (2 tan(phi/2) and
    // chords), which is 1e-4 here. A spin held without the direction turns about the mean of the held tangent and the present
    // one, with half of the torque on either edge. A single wire has all of it on one edge: half an edge off, so that this halves
    // with the edges.
    TEST_CASE("twin: a held pair is one held wire of both stiffnesses")
    {
        struct Apart {
            double places, force, held, error;
        };
        const auto apart = [](int what, double edge) {
            const double length = 0.12;
            WorldSetup pair = merged_setup({instrument_of({{0.2, bend, 0}}, 0.5), instrument_of({{0.2, 0.5 * bend, 0}}, 0.5)},
                                           {length, length}, edge);
            pair.gravity = {0, 0, -9.81};
            HoldSpec hold = hold_at(0.03, what & 1, what & 2, what & 4);
            hold.move = {{0, 0, 0, 0}, {1e-3, -0.5e-3, 2e-3, 3e-3}};
            if (hold.spin) hold.turn = {{0, 0}, {1e-3, 0.8}};
            WorldSetup one = pair;
            pair.wires[1].holds.push_back(hold);
            if (hold.spin) {  // the other one turns by itself
                pair.wires[0].holds.push_back(hold_at(0.03, false, false, true));
                pair.wires[0].holds.back().turn = hold.turn;
            }
            WireSection sum = section_of(pair_bend, 0.5 * pair_bend, 0);
            sum.density *= 2;
            one.wires.resize(1);
            one.systems = {1};
            one.coaxial.clear();
            one.wires[0].wire.shaft = sum;
            one.wires[0].wire.sections.clear();
            one.wires[0].holds.push_back(hold);
            World merged(pair), single(one);
            for (int k = 0; k < 3; ++k) {
                advance(merged, length, length);
                step_to(single, 1e-3, {{length}});
            }
            const ConstRodView a = merged.rod(1), b = single.rod(0);
            REQUIRE(a.n == b.n);
            Apart most{};
            for (int i = 0; i < a.n; ++i) most.places = std::max(most.places, (a.pos(i) - b.pos(i)).norm());
            const Vec3 force = merged.readings(0).base_force, expected = single.readings(0).base_force;
            REQUIRE(expected.norm() > 0.01);
            most.force = (force - expected).norm() / expected.norm();
            most.held = (merged.readings(0).momentum.held - single.readings(0).momentum.held).norm();
            most.error = merged.readings(0).momentum.error().norm();
            return most;
        };
        for (const int what : {1, 3, 5, 7}) {
            CAPTURE(what);
            const Apart at = apart(what, 2e-3);
            CHECK(at.places < (what == 5 ? 2e-5 : 2e-4 * 3e-3));  // of how far it is moved
            CHECK(at.force < 3e-4);
            CHECK(at.held < 1e-6);
            CHECK(at.error < 1e-6);
        }
        CHECK(apart(5, 1e-3).places == about(0.5 * apart(5, 2e-3).places).epsilon(0.05));
    }

    // Lifted by d, so far from the hub: 3 B d/a^3, or 12 B d/a^3 with its direction held. A position between nodes is on a
    // chord and its clamp is in a cell: (edge/a)^2 = 1/900 of the distance, and 5 % of that in stiffness. The least share puts
    // a clamp off by 0.5 % of an edge, which is 3 * 0.005/30 of the force.
    TEST_CASE("analytic: reactions at places between nodes")
    {
        const double length = 0.1, height = 1e-5;  // (tension adds with its square: 3e-4 of the force)
        for (const bool direction : {false, true})
            for (int k = 0; k <= 10; ++k) {
                const double from_tip = 0.04 + 2e-4 * k, a = length - from_tip;
                CAPTURE(from_tip);
                WorldSetup setup = straight_pair(length, length);
                setup.wires[k % 2].holds.push_back(lifted(from_tip, height, direction));
                World world(setup);
                for (int round = 0; round < 2; ++round) advance(world, length, length);
                const double expected = (direction ? 12 : 3) * pair_bend * height / (a * a * a);
                CHECK(-world.readings(0).base_force.z() == about(expected).epsilon(2.5e-3));
                CHECK(material_at(world, k % 2, from_tip).z() == about(height).epsilon(1e-6));
                if (direction) CHECK(std::abs(world.rod(0).tangent(0).z()) < 0.01 * height / a);
                CHECK(world.readings(0).momentum.held.norm() < 1e-7);
            }
    }

    // The outer tip is held up while the inner instrument moves through it, over node after node; and the inner tip while the
    // outer one comes. Both are a cantilever of B over b and B/3 beyond, to the inner one's tip at x.
    TEST_CASE("analytic: a place stays where it is held as the instruments slide")
    {
        const double a = 0.06, height = 1e-5;
        HoldSpec tip = lifted(0, height);
        tip.at.kind = WirePoint::Kind::Tip;
        for (const bool adaptive : {false, true}) {
            WorldSetup through_it = straight_pair(a, 0.065);
            for (WireSetup& wire : through_it.wires) {
                wire.wire.nodes = adaptive ? 0 : wire.wire.nodes;
                wire.wire.min_edge = 1e-3;
                wire.wire.max_edge = 4e-3;
            }
            through_it.wires[0].holds.push_back(tip);
            World through(through_it);
            for (int k = 0; k <= 60; ++k) {
                advance(through, a, 0.065 + 3e-4 * k);
                if (k == 0) continue;
                CHECK(material_at(through, 0, 0).z() == about(height).epsilon(1e-5));
                CHECK(-through.readings(0).base_force.z() == about(3 * pair_bend * height / (a * a * a)).epsilon(5e-3));
            }
        }

        WorldSetup setup = straight_pair(0.02, 0.07);
        setup.wires[1].holds.push_back(tip);
        World over(setup);
        for (int k = 0; k <= 60; ++k) {
            const double b = 0.02 + 5e-4 * k, x = 0.07, beyond = std::pow(x - b, 3);
            advance(over, b, x);
            if (k == 0) continue;
            const double give = (x * x * x - beyond) / (3 * pair_bend) + beyond / (3 * 0.5 * bend);
            CHECK(material_at(over, 1, 0).z() == about(height).epsilon(1e-5));
            CHECK(-over.readings(0).base_force.z() == about(height / give).epsilon(5e-3));
        }
    }

    // What goes on from there is a thread, which holds nothing, wherever the tip is between two nodes: 3 B d/L^3, or 12 B d/L^3
    // with its direction held. (EA pulls along with the square of d, 5e-5 of the force across.) A clamp's moment 6 B d/L^2 bends
    // up to an edge l before the tip, which the line goes along straight: 3 (l/L)^2 of d, and about as much for the polyline.
    TEST_CASE("analytic: a catheter held at its tip bends as far as that, though a thread goes on from there")
    {
        const double stiffness = 1e-2, height = 1e-5, edge = 2e-3;
        HoldSpec tip = lifted(0, height);
        tip.at.kind = WirePoint::Kind::Tip;
        for (int k = 0; k < 16; ++k) {
            const double length = 0.05 + 2.5e-4 * (k / 2);
            tip.direction = k % 2 == 1;
            CAPTURE(k);
            WorldSetup setup =
                merged_setup({instrument_of({{0.4, stiffness, 0}}, 1), instrument_of({{0.6, 1e-8, 0}}, 1)}, {length, 0.06}, edge);
            setup.integrator.tolerance = 1e-9;
            setup.wires[0].holds.push_back(tip);
            World world(setup);
            for (int i = 0; i < 3; ++i) advance(world, length, 0.06);
            const double force = (tip.direction ? 12 : 3) * stiffness * height / std::pow(length, 3);
            CHECK(-world.readings(0).base_force.z() == about(force).epsilon(6 * std::pow(edge / length, 2)));
            CHECK(std::abs(world.readings(1).hand_force) < 1e-3 * force);
            // straight on from the tip: tangents point to the hub
            const double slope = tip.direction ? 0 : -1.5 * height / length;
            CHECK(world.rod(1).tangent(0).z() == about(slope).scale(height / length).epsilon(0.05));
        }
    }

    // Pulled forwards by d: the line is stretched by both EA, and the hand of the held instrument bears the pull. The hold on
    // its edge's chord is stiffer by the compliance of the edge, at b(1 - b) of its length: 0.19 % here.
    TEST_CASE("analytic: the hand of the one that is held holds what its hold pulls along")
    {
        const double length = 0.06, pulled = 1e-6;
        for (const int held : {0, 1}) {
            WorldSetup setup = straight_pair(length, length + 0.01);
            HoldSpec hold = hold_at(held == 0 ? 0.0101 : 0.0201, true, false, false);
            hold.move = {{0, 0, 0, 0}, {1e-3, pulled, 0, 0}};
            setup.wires[held].holds.push_back(hold);
            World world(setup);
            for (int k = 0; k < 2; ++k) advance(world, length, length + 0.01);
            const double stretch = 4 * pair_bend / (0.5e-3 * 0.5e-3), force = stretch * pulled / (length - 0.0101);
            CHECK(world.readings(held).hand_force == about(-force).epsilon(3e-3));
            CHECK(std::abs(world.readings(1 - held).hand_force) < 1e-3 * force);
        }
    }

    // A shaft of C over the way from the hub to where it is held; the other one turns free through it. Both turn
    // three times and more, 1.2 rad apart at the end: more would buckle it.
    TEST_CASE("analytic: a spin is held at a place of one instrument")
    {
        const double length = 0.08;
        for (int k = 0; k <= 6; ++k) {
            const double from_tip = 0.02 + 3.3e-4 * k;
            WorldSetup setup = straight_pair(length, length);
            setup.wires[1].holds.push_back(hold_at(from_tip, false, false, true));
            setup.wires[1].holds.back().turn = {{0, 0}, {24e-3, 18}};
            World world(setup);
            for (int part = 1; part <= 24; ++part) advance(world, length, length, 1e-3, -0.3 * part, 0.8 * part);
            CHECK(world.readings(1).hand_torque == about(0.5 * twist * (24 * 0.8 - 18) / (length - from_tip)).epsilon(1e-3));
            CHECK(std::abs(world.readings(0).hand_torque) < 1e-9);
            CHECK(world.rod(0).theta[0] == about(24 * 0.3).epsilon(1e-6));
        }
    }

    // Of one that goes with the line only so far: the inner one is held behind its tip, which the outer one has overtaken.
    TEST_CASE("analytic: a spin is held at the tip of one that ends inside the line")
    {
        for (int k = 0; k <= 6; ++k) {
            const double inner = 0.05 + 3.3e-4 * k, turn = 0.7;
            WorldSetup setup = straight_pair(0.08, inner);
            HoldSpec hold = hold_at(0, false, false, true);
            hold.at.kind = WirePoint::Kind::Tip;
            setup.wires[1].holds.push_back(hold);
            World world(setup);
            for (int part = 0; part < 3; ++part) advance(world, 0.08, inner, 1e-3, 0, turn);
            CHECK(world.readings(1).hand_torque == about(0.5 * twist * turn / inner).epsilon(1e-3));  // 0.005 edges in 25
        }
    }

    // Forces by differences of the moves along which they do no work beside their energy would need that: here the tangent is the
    // derivative of the force. What differences have of a frame's own way from the accepted one is skew, and left out by taking
    // the symmetric part; rounding of a force over the step is 1e-6 of the tangent.
    TEST_CASE("derivative: force and tangent of all that a hold holds")
    {
        std::mt19937 random(5);
        for (const double from_tip : {0.0, 0.0004, 0.0113, 0.0126, 0.0295}) {
            WorldSetup setup = straight_pair(0.03, 0.03);
            setup.wires[1].holds.push_back(hold_at(from_tip, true, true, true));
            setup.wires[1].holds.back().turn = {{0, 0}, {1, 0.4}};
            World world(setup);
            WorldData& data = data_of(world);
            const int at = data.state.rods.node_begin(1), n = data.state.rods.node_count(1), unknowns = RodDofs::count(n);
            const std::vector<double> q = bend_at_random(data, random);
            const std::vector<std::uint8_t> live = {1, 1};
            data.forces.line_holds->prepare(data.state.rods, live);
            TrialState trial;
            for (auto* array : {&trial.x, &trial.y, &trial.z, &trial.theta}) array->resize(data.state.rods.total_capacity());
            const auto force_at = [&](const std::vector<double>& p, BandRows* tangent) {
                const int line = data.state.rods.node_begin(0);
                for (const int begin : {line, at})
                    for (int i = 0; i < n; ++i) {
                        trial.x[begin + i] = p[RodDofs::position(i, 0)];
                        trial.y[begin + i] = p[RodDofs::position(i, 1)];
                        trial.z[begin + i] = p[RodDofs::position(i, 2)];
                        trial.theta[begin + i] = p[RodDofs::spin(i)];
                    }
                data.forces.line_holds->evaluate({trial, 0, live});
                std::vector<double> gradient(unknowns, 0.0);
                data.forces.line_holds->add(1, gradient, tangent, true);
                return gradient;
            };
            BandMatrix matrix(unknowns);
            matrix.reset(unknowns);
            BandRows rows = matrix.part(0, unknowns);
            const std::vector<double> here = force_at(q, &rows);
            std::vector<std::vector<double>> difference;
            for (int j = 0; j < unknowns; ++j) {
                const double step = 1e-7 * (RodDofs::is_spin(j) ? 1 : 1e-2);
                std::vector<double> ahead = q, behind = q;
                ahead[j] += step;
                behind[j] -= step;
                difference.push_back(force_at(ahead, nullptr));
                const std::vector<double> down = force_at(behind, nullptr);
                for (int i = 0; i < unknowns; ++i) difference.back()[i] = (difference.back()[i] - down[i]) / (2 * step);
            }
            int compared = 0;
            for (int j = 0; j < unknowns; ++j)
                for (int i = std::max(0, j - 10); i <= std::min(unknowns - 1, j + 10); ++i) {
                    const double scale = std::sqrt(std::abs(matrix.at(i, i) * matrix.at(j, j)));
                    if (scale == 0) continue;
                    CHECK(matrix.at(i, j) == about(0.5 * (difference[i][j] + difference[j][i])).scale(scale).epsilon(1e-5));
                    CHECK(matrix.at(i, j) == about(matrix.at(j, i)).scale(scale).epsilon(1e-12));
                    ++compared;
                }
            CHECK(compared > 20);
            CHECK(*std::ranges::max_element(here) > 0);
        }
    }

    // U = |t_c - (1 - w) t_a - w t_b|^2 / (2 c), w = C_a/(C_a + C_b), c = C_a C_b/(C_a + C_b) of the compliances from the place
    // to both middles: its derivative by the place, which the hand feels, by differences. An outer tip in the cell goes along
    // with a place of the outer one, and stays where it is as the inner one slides.
    TEST_CASE("derivative: what a held direction pulls along is the slope of its energy")
    {
        std::mt19937 random(6);
        const double edge = 2e-3;
        struct Case {
            double outer;  // how far it is in [m]
            int wire;
            double from_tip;
        };
        for (const Case& at : {Case{0.03, 1, 0.0113}, Case{0.03, 1, 0.0117}, Case{0.03, 1, 0.0126}, Case{0.03, 1, 0.0189},
                               Case{0.0183, 1, 0.0113}, Case{0.0183, 1, 0.0126}, Case{0.0183, 0, 0}, Case{0.0183, 0, 0.0007}}) {
            const auto& [outer, held_wire, from_tip] = at;
            WorldSetup setup = straight_pair(outer, 0.03, Scheme::Static, edge);
            setup.wires[held_wire].holds.push_back(hold_at(from_tip, false, true, false));
            World world(setup);
            WorldData& data = data_of(world);
            const Vec3 held = data.rod(0).tangent(0);
            (void)bend_at_random(data, random);
            const RodView line = data.rod(0);
            const double tip = 0.03 - outer, place = held_wire == 0 ? tip + from_tip : from_tip;
            // the place is between the middles of edges a and a + 1
            const int a = static_cast<int>(std::floor(place / edge - 0.5));
            const auto energy = [&, from = (a + 0.5) * edge](double s) {
                const double outer_tip = held_wire == 0 ? s - from_tip : tip;
                const auto compliance = [&](double begin, double end) {
                    const double both = end - std::clamp(outer_tip, begin, end);
                    return (end - begin - both) / (0.5 * bend) + both / pair_bend;
                };
                const double before = compliance(from, s), after = compliance(s, from + edge), all = before + after;
                const Vec3 off = held - (after / all) * line.tangent(a) - (before / all) * line.tangent(a + 1);
                return off.squaredNorm() * all / (2 * before * after);
            };
            TrialState trial;
            for (auto* array : {&trial.x, &trial.y, &trial.z, &trial.theta}) array->resize(data.state.rods.total_capacity());
            for (const int wire : {0, 1})
                for (int i = 0; i < line.n; ++i) {
                    const int k = data.state.rods.node_begin(wire) + i;
                    trial.x[k] = line.pos(i).x();
                    trial.y[k] = line.pos(i).y();
                    trial.z[k] = line.pos(i).z();
                }
            const std::vector<std::uint8_t> live = {1, 1};
            data.forces.line_holds->prepare(data.state.rods, live);
            data.forces.line_holds->evaluate({trial, 0, live});
            // 1e-5 of an edge: the difference's own error is (1e-5)^2 of a slope that changes over a tenth of an edge
            const double step = 1e-5 * edge, slope = (energy(place + step) - energy(place - step)) / (2 * step);
            CAPTURE(place);
            CHECK(data.forces.line_holds->along(held_wire) == about(slope).epsilon(1e-6));
            CHECK(data.forces.line_holds->along(1 - held_wire) == 0);
        }
    }

    // Both advance and turn while places of theirs are led about: works and momenta add up.
    TEST_CASE("property: energies and momentum are closed with holds that move")
    {
        WorldSetup setup = straight_pair(0.08, 0.1, Scheme::Newton);
        setup.integrator.damping_mass = 20;
        setup.gravity = {0, 0, -9.81};
        HoldSpec led = hold_at(0.0307, true, true, true);
        led.move = {{0, 0, 0, 0}, {0.3, -2e-3, 2e-3, 4e-3}, {0.6, -2e-3, -3e-3, 1e-3}, {1, -3e-3, 0, 0}};
        led.turn = {{0, 0}, {1, 2}};
        setup.wires[1].holds.push_back(led);
        World world(setup);
        double most = 0;
        for (int k = 1; k <= 1000; ++k) {
            const double phase = 2 * pi * k / 500;
            advance(world, 0.08 + 0.01 * (1 - std::cos(phase)), 0.1 + 4e-4 * std::sin(phase), 1e-3, 0.5 * std::sin(phase),
                    0.002 * k);
            most = std::max(most, world.readings(0).momentum.error().norm());
            CHECK(material_at(world, 1, 0.0307).x() == about(0.0693 + (k == 1000 ? -3e-3 : 0)).epsilon(k == 1000 ? 1e-6 : 0.1));
        }
        CHECK(most < 1e-5);
        const EnergyLedger& ledger = world.readings(0).energy;
        const double turned_over =
            std::max({std::abs(ledger.hand), std::abs(ledger.outside), std::abs(ledger.wire), ledger.damping});
        CHECK(std::abs(ledger.outside) > 1e-3);
        CHECK(std::abs(ledger.open()) < 1e-5 * turned_over);
    }

    TEST_CASE("property: a place that leaves the inlet is let go, and held where it comes back")
    {
        WorldSetup setup = straight_pair(0.05, 0.08, Scheme::Newton);
        setup.integrator.damping_mass = 200;
        setup.wires[0].holds.push_back(hold_at(0.0401, false, true, false));
        setup.wires[0].loads.push_back({});
        setup.wires[0].loads.back().at.kind = WirePoint::Kind::Tip;
        setup.wires[0].loads.back().force = {0, 0, 1e-3};
        World world(setup);
        const auto go = [&](double to, int steps) {
            const double from = world.rod(0).material_s[world.rod(0).n - 1];
            for (int k = 1; k <= steps; ++k) advance(world, from + (to - from) * k / steps, 0.08);
        };
        go(0.05, 100);
        const double held = world.rod(0).pos(0).z();
        go(0.03, 200);
        go(0.03, 200);
        const double let_go = world.rod(0).pos(0).z();
        CHECK(let_go == about(1e-3 * std::pow(0.03, 3) / (3 * pair_bend)).epsilon(0.02));
        go(0.05, 200);
        go(0.05, 300);
        CHECK(world.rod(0).pos(0).z() == about(held).epsilon(0.01));
    }

    TEST_CASE("property: a run goes on with the same bits from a saved state")
    {
        WorldSetup setup = straight_pair(0.06, 0.08, Scheme::Newton);
        HoldSpec led = hold_at(0.0301, true, false, true);
        led.velocity = {0, 0.01, 0.02};
        setup.wires[0].holds.push_back(led);
        const auto on = [](World& world, int from, int to) {
            for (int k = from; k < to; ++k) advance(world, 0.06 + 2e-5 * k, 0.08 + 5e-5 * k, 1e-3, 0.01 * k, 0);
        };
        TakenUp runs(setup, on, 60, 120);
        std::vector<std::uint8_t> damaged = runs.first.save_state();
        damaged.pop_back();
        CHECK_THROWS_AS(runs.second.restore_state(damaged), Error);
    }

    TEST_CASE("property: what cannot be held is refused")
    {
        const auto refused = [](double inner, std::vector<HoldSpec> outer_holds, std::vector<HoldSpec> inner_holds,
                                const char* says) {
            WorldSetup setup = straight_pair(0.05, inner);
            setup.wires[0].holds = std::move(outer_holds);
            setup.wires[1].holds = std::move(inner_holds);
            CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains(says), Error);
        };
        HoldSpec base = hold_at(0, true, false, false);
        base.at.kind = WirePoint::Kind::Base;
        refused(0.06, {}, {base}, "hold[0].at: the base is held by the feed");
        refused(0.06, {}, {hold_at(0.06, true, false, false)}, "hold[0].at: 0.06 m from the tip is outside: only 0.06 m");
        refused(0.06, {}, {hold_at(0.01, false, false, false)}, "hold[0] holds nothing");
        refused(0.06, {hold_at(0.01, true, false, false)}, {hold_at(0.0202, true, true, false)},
                "wires[0].holds[0], wires[1].holds[0]: got two holds of the position of one centreline");
        refused(0.06, {}, {hold_at(0.02, false, false, true), hold_at(0.0203, false, false, true)}, "got two holds of the spin");
        WorldSetup each_its_spin = straight_pair(0.05, 0.06);
        each_its_spin.wires[0].holds = {hold_at(0.01, false, false, true)};
        each_its_spin.wires[1].holds = {hold_at(0.02, false, false, true)};
        CHECK_NOTHROW(World{each_its_spin});
    }
}

}  // namespace seldinger::test::test_merged_holds
