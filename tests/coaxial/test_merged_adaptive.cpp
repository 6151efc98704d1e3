// Adaptive nodes of instruments that share one centreline: against even fine ones, against a wire alone, energy, saved states.

#include "coaxial/bend_fixture.h"
#include "coaxial/merged_fixture.h"
#include "world/merged.h"
#include "nodes/coaxial_nodes.h"
#include "support/steps.h"
#include "support/world_fixture.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <vector>

namespace seldinger::test::test_merged_adaptive {

namespace {

constexpr double error_of_edge = 2e-6;  // WireSpec::edge_error [m]

/// A catheter with a bent end over a wire with another one, in the air. @param edge  of even nodes, 0: adaptive [m]
WorldSetup in_air(double catheter, double wire, double edge, Scheme scheme)
{
    WorldSetup setup = merged_setup({instrument_of(0.4, 2e-4, 1.5e-4, 0.03, 15), instrument_of(0.5, 1e-4, 7.7e-5, 0.02, 25)},
                                    {catheter, wire}, edge > 0 ? edge : 1e-3, scheme);
    for (WireSetup& one : setup.wires)
        if (edge == 0) one.wire.nodes = 0;
    setup.gravity = {0, 0, -9.81};
    setup.integrator.damping_mass = 20;
    setup.integrator.tolerance = 1e-7;
    return setup;
}

int nodes_of(const World& world) { return std::max(world.rod(0).n, world.rod(1).n); }

}  // namespace

TEST_SUITE("coaxial/merged adaptive")
{
    // An edge moves the tip by edge_error at most, by its estimate. A jump of natural curvature by D in a cell of length h puts
    // the nodes beside it off the axis by D h^2/8 (the first moment of the jump about the node).
    TEST_CASE("property: at rest the tips are where those of a fine even line are, with fewer nodes")
    {
        const auto at_rest = [](double edge) {
            auto world = std::make_unique<World>(in_air(0.09, 0.12, edge, Scheme::Static));
            for (int k = 1; k <= 60; ++k) {
                step_to(*world, 0.01, {{0.09}, {0.12 + 5e-4 * std::min(k, 40), 0.05 * std::min(k, 40)}});
            }
            return world;
        };
        const auto fine = at_rest(0.5e-3), adaptive = at_rest(0);
        REQUIRE(nodes_of(*adaptive) < nodes_of(*fine) / 4);
        const ConstRodView wire = adaptive->rod(1);  // it leads: 0.14 m, the catheter ends 0.05 m behind its tip
        const auto jump = [&](double curvature, double s) {
            int i = 0;
            while (i + 2 < wire.n && wire.material_s[i + 1] < s) ++i;
            const double h = *std::max_element(&wire.rest_length[i > 0 ? i - 1 : i], &wire.rest_length[i + 1] + 1);
            return curvature * h * h / 8;
        };
        const double share = 2.0 / 3;  // of the catheter in the stiffness of both
        const double jumps = jump(25, 0.02) + jump(share * 15, 0.05) + jump(share * 15, 0.08);
        const double allowed = nodes_of(*adaptive) * error_of_edge + jumps;
        for (const int w : {0, 1}) {
            const double off = (adaptive->rod(w).pos(0) - fine->rod(w).pos(0)).norm();
            MESSAGE("tip off by " << off << " of " << allowed << " m, nodes " << nodes_of(*adaptive) << " and "
                                  << nodes_of(*fine));
            CHECK(off < allowed);
            // a torque is what turned the edges between against each other: (h/l)^2 of it, l = 40 mm being the length over
            // which they turn
            CHECK(adaptive->readings(w).hand_torque == about(fine->readings(w).hand_torque).epsilon(std::pow(10.0 / 40, 2)));
        }
    }

    TEST_CASE("property: through each other and back, with the energies closed")
    {
        World world(in_air(0.05, 0.06, 0, Scheme::Newton));
        int changes = 0;
        Place at{0.05, 0.06, 0};
        for (const Place& next :
             {Place{0.05, 0.09, 1}, Place{0.07, 0.09, 1}, Place{0.07, 0.05, 1}, Place{0.08, 0.05, -0.5}, Place{0.05, 0.08, 0}}) {
            changes += go(world, at, next, 300);
            at = next;
        }
        CHECK(changes > 20);
        const EnergyLedger& ledger = world.readings(0).energy;
        CHECK(std::abs(ledger.open()) < 0.002 * turned_over(ledger));
        for (const int w : {0, 1}) {
            const ConstRodView rod = world.rod(w);
            CHECK(rod.material_s[rod.n - 1] == about(w == 0 ? at.catheter : at.wire).epsilon(1e-3));
            for (int j = 0; j + 1 < rod.n; ++j) CHECK(rod.rest_length[j] < 0.0101);
        }
    }

    // A tip is off by edge_error an edge, and by the sagitta of edges of h that lie against the wall: kappa h^2/8 = 56 um at
    // kappa = 25 /m, h = (24 e/kappa^2)^(1/3). The force of the hands bends the line round the corner, as far as the wall lets
    // it: 56 um of 3.1 mm of clearance. A bending force goes with the cube of a length: 5 %. The share of each hand follows the
    // moment at the catheter's tip, of first order in the edge there, with even nodes too (rod/coaxial.h).
    TEST_CASE(
        "property: round a bend as fine even nodes, beside a rigid wall and an elastic one, with energy and momentum closed")
    {
        for (const double youngs : {0.0, 0.4e6}) {
            CAPTURE(youngs);
            World world(in_a_bend(0.01, 0.02, 0, youngs)), even(in_a_bend(0.01, 0.02, 1e-3, youngs));
            const double curvature = 1 / 0.04, edge = std::cbrt(24 * error_of_edge / (curvature * curvature));
            const double cut = curvature * edge * edge / 8;
            Place at{0.01, 0.02, 0};
            for (const Place& next : {Place{0.01, 0.1, 0}, Place{0.07, 0.1, 0}, Place{0.1, 0.08, 0}, Place{0.03, 0.02, 0}}) {
                if (youngs > 0 && next.catheter == 0.1) break;
                go(world, at, next, 800);
                go(even, at, next, 800);
                at = next;
                const WireReadings outer = world.readings(0);
                CHECK(std::abs(outer.energy.open()) < 0.004 * turned_over(outer.energy));
                CHECK(outer.momentum.error().norm() < 1e-6);
                CHECK(nodes_of(world) < nodes_of(even) * 0.55);
                double hands = 0, even_hands = 0;
                for (const int w : {0, 1}) {
                    CHECK(world.readings(w).outside == 0);
                    CHECK((world.rod(w).pos(0) - even.rod(w).pos(0)).norm() < nodes_of(world) * error_of_edge + cut);
                    hands += world.readings(w).hand_force;
                    even_hands += even.readings(w).hand_force;
                }
                CHECK(hands == about(even_hands).epsilon(0.05));
            }
        }
    }

    // Each edge alone, of a line that moves and is twisted.
    TEST_CASE("property: an edge split, and its node merged away again, keep what the instruments carry")
    {
        World world(in_air(0.05, 0.06, 2e-3, Scheme::Newton));
        go(world, {0.05, 0.06, 0}, {0.06, 0.09, 2}, 200);
        WorldData& data = data_of(world);
        MergedGroup& group = *data.groups.list[0];
        const std::vector<std::uint8_t> before = world.save_state();
        struct Carried {
            Vec3 momentum = Vec3::Zero();
            // spun: sum of the sizes; dense: the most a length [kg m/s]; force: of an edge
            double spin[2] = {}, spun[2] = {}, dense[2] = {}, length = 0, force = 0;
        };
        const auto carried = [&](int edge) {
            Carried sum;
            const RodView line = data.rod(group.line());
            for (int i = 0; i < line.n; ++i) sum.momentum += line.mass[i] * line.vel(i);
            for (const int w : {0, 1}) {
                const RodView own = data.rod(w);
                for (int j = 0; j < own.n - 1; ++j) {
                    const double spin = own.spin_inertia[j] * own.spin_rate[j];
                    sum.spin[w] += spin;
                    sum.spun[w] += std::abs(spin);
                    sum.dense[w] = std::max(sum.dense[w], std::abs(spin) / line.rest_length[j]);
                }
            }
            sum.force =
                line.stretch_stiffness[edge] * ((line.pos(edge + 1) - line.pos(edge)).norm() / line.rest_length[edge] - 1);
            sum.length = line.material_s[line.n - 1];
            return sum;
        };
        const int edges = data.state.rods.node_count(group.line()) - 1;
        REQUIRE(edges > 30);
        const double speed = 0.2, mass = 2 * 6500 * pi * 0.25e-6 * 0.09;
        for (int edge = 0; edge < edges; ++edge) {
            CAPTURE(edge);
            world.restore_state(before);
            const Carried old = carried(edge);
            const double energy = elastic_now(data.state.rods, group);
            const RodView line = data.rod(group.line());
            const double from = line.material_s[edge], h = line.rest_length[edge], stretch = line.stretch_stiffness[edge];
            CoaxialGroup& shared = group.shared;
            const SplitResult split =
                split_edge(CoaxialNodes(data.state.rods, group.wires(), shared.rod, shared.base, group.frames), edge, 0.4);
            const Carried now = carried(edge), other = carried(edge + 1);
            CHECK((now.momentum - old.momentum).norm() < 1e-12 * mass * speed);
            // the catheter, which ends within the line, is short of the added length until its offset is set anew
            CHECK(std::abs(now.spin[0] - old.spin[0]) < 1e-9 * old.spun[0] + std::abs(split.rest_length_added) * old.dense[0]);
            CHECK(std::abs(now.spin[1] - old.spin[1]) < 1e-9 * old.spun[1]);
            // lengths carry the force but for how a stiffness may change inside the former edge
            CHECK(std::abs(now.force - old.force) < 1e-3 * std::abs(old.force) + 1e-12 * stretch);
            CHECK(std::abs(other.force - old.force) < 1e-3 * std::abs(old.force) + 1e-12 * stretch);
            CHECK(std::abs(now.length - old.length - split.rest_length_added) < 1e-15);
            CHECK(std::abs(split.rest_length_added) < h * std::pow(30 * h, 2));
            refresh_group(data, group);
            // A cell in which a natural curvature of stiffness B jumps by D has its mean, with a variance of D^2/4 at most. A
            // cell that is new at the tip is bent as both ends together are at rest there
            double born = 0;
            for (const auto& [s, bend, jump] : {std::tuple(0.02, 1e-4, 25.0), {0.03, 2e-4, 15.0}, {0.06, 2e-4, 15.0}})
                if (s > from - h && s < from + 2 * h) born += 0.5 * bend * jump * jump / 4 * h;
            CHECK(std::abs(elastic_now(data.state.rods, group) - energy) < 0.01 * energy + born);
            const SplitResult merge =
                merge_edges(CoaxialNodes(data.state.rods, group.wires(), shared.rod, shared.base, group.frames), edge + 1);
            refresh_group(data, group);
            // (what an end is moved by, 1e-12 m at most, takes its mass along)
            CHECK((carried(edge).momentum - old.momentum).norm() < (1e-12 + 1e-12 / 0.09) * mass * speed);
            CHECK(std::abs(split.rest_length_added + merge.rest_length_added) < 1e-12);
            CHECK(elastic_now(data.state.rods, group) == about(energy).epsilon(1e-6));
            const Carried again = carried(edge);
            CHECK(std::abs(again.spin[0] - old.spin[0]) < 1e-9 * old.spun[0] + std::abs(split.rest_length_added) * old.dense[0]);
            CHECK(std::abs(again.spin[1] - old.spin[1]) < 1e-9 * old.spun[1]);
        }
    }

    TEST_CASE("property: a run that is taken up again while nodes come and go ends with the same bits")
    {
        for (const double youngs : {0.0, 0.4e6}) {
            CAPTURE(youngs);
            const WorldSetup setup = in_a_bend(0.01, 0.02, 0, youngs);
            int changes = 0;  // in the last that goes on
            const TakenUp runs(
                setup,
                [&](World& world, int from, int to) {
                    changes = go(world, {0.01, 0.02, 0}, {0.05, 0.09, 1}, 600, from + 1, to);
                },
                350, 600);
            CHECK(changes > 3);
            CHECK(runs.second.readings(0).energy.hand == runs.whole.readings(0).energy.hand);
            World third(setup);
            third.restore_state(0, runs.first.save_state(0));
            CHECK(third.readings(1).nodes == runs.first.readings(1).nodes);
        }
    }

    // The same equations and the same estimate of errors; births at the hub differ by what a polygon's node is off,
    // (kappa h)^2 h.
    TEST_CASE("property: an instrument alone in the group has the nodes of a wire, even or adaptive, and its shape")
    {
        struct Allowed {
            double edge, apart, share;
        };
        for (const auto& [edge, apart, share] : {Allowed{2e-3, 5e-5, 0.02}, Allowed{0, 1e-6, 1e-3}}) {
            CAPTURE(edge);
            WorldSetup both = in_a_bend(0, 0.02, edge), one = both;
            one.wires.erase(one.wires.begin());
            one.coaxial.clear();
            one.systems.clear();
            World group(both), alone(one);
            go(group, {0, 0.02}, {0, 0.1}, 800);
            for (int k = 1; k <= 800; ++k) step_to(alone, 1e-3, {{0.02 + 1e-4 * k}});
            if (edge == 0) CHECK(group.rod(1).n == alone.rod(0).n);
            CHECK((group.rod(1).pos(0) - alone.rod(0).pos(0)).norm() < apart);
            CHECK(group.readings(1).friction == about(alone.readings(0).friction).epsilon(share));
            CHECK(group.readings(1).hand_force == about(alone.readings(0).hand_force).epsilon(share));
        }
    }

    TEST_CASE("property: nodes are even where one of the instruments asks for that")
    {
        WorldSetup setup = in_air(0.05, 0.06, 0, Scheme::Newton);
        setup.wires[0].wire.nodes = 201;  // edges of 2 mm
        World world(setup);
        go(world, {0.05, 0.06, 0}, {0.05, 0.09, 1}, 300);
        const ConstRodView wire = world.rod(1);
        for (int j = 1; j + 2 < wire.n; ++j) CHECK(wire.rest_length[j] == about(2e-3).epsilon(0.01));
    }
}

}  // namespace seldinger::test::test_merged_adaptive
