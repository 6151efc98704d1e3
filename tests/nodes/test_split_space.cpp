// What a split or a merge keeps where a wire is bent in space and no two of its edges are alike: twist, spin, natural curvature.
#include "nodes/split.h"
#include "rod/rod_fixture.h"

namespace seldinger::test::test_split_space {

namespace {

constexpr int edges = 9;

/// Lies on a curve with its rest length as it lies, edges of uneven length, angles and spins of no order. The curve has a
/// torsion: a frame that is carried along other chords arrives turned.
struct UnevenWire : OneWire {
    WireSpec spec = uniform_spec(10.0, 0.8, 0.6, 400.0);
    explicit UnevenWire(bool straight) : OneWire(edges + 1, edges + 3)
    {
        std::vector<Vec3> nodes;
        for (int i = 0; i <= edges; ++i) {
            const double s = 0.25 * (i + 0.2 * std::sin(3.0 * i));
            nodes.push_back(straight ? Vec3(-s, 0, 0) : Vec3(std::cos(s), std::sin(s), 0.5 * s * s));
        }
        place(nodes, Vec3(0.1, 0.2, 1));
        set_rest_shape(rod, spec, false);
        for (int j = 0; j < edges; ++j) {
            rod.theta[j] = 0.3 * j + 0.05 * j * j;
            rod.spin_rate[j] = 1 + 0.2 * j * j;
            rod.spin_acc[j] = 3 - 0.4 * j * j;
        }
        REQUIRE(accept(OwnedTrial(rod)));
    }
    /// A clamp that holds the hub's angle, along the last edge.
    void hold_hub()
    {
        RodClamp clamp{.node = edges,
                       .direction = true,
                       .spin = true,
                       .tangent = (rod.tangent(edges - 1) + Vec3(0.1, 0.05, 0.2)).normalized(),
                       .turns = rod.theta[edges - 1] + 0.1};
        clamp.director = unit_normal(turned(rod.ref_d1(edges - 1), rod.tangent(edges - 1), clamp.turns), clamp.tangent);
        clamps = {clamp};
        REQUIRE(accept(OwnedTrial(rod)));
    }
    void node_moved(int by)
    {
        rod = arrays.view(0);
        for (RodClamp& clamp : clamps) clamp.node += by;
    }
    /// At inner nodes, and of the clamp at the hub, where there is one [rad].
    [[nodiscard]] std::vector<double> twists()
    {
        REQUIRE(update());
        std::vector<double> found(static_cast<std::size_t>(rod.n), 0.0);
        for (int i = 1; i + 1 < rod.n; ++i) found[static_cast<std::size_t>(i)] = frames.twist[i];
        if (!clamps.empty()) found.back() = frames.clamp_twist[0];
        return found;
    }
};

/// What a wire of three nodes is bent by at the middle one [1/m].
double curvature_of(const RodView& rod)
{
    RodFrames frames(rod.n);
    REQUIRE(update_frames(rod, {rod.x, rod.y, rod.z, rod.theta}, {}, frames));
    return std::hypot(frames.kappa1[1], frames.kappa2[1]) / rod.voronoi_length(1);
}

}  // namespace

TEST_SUITE("nodes/split")
{
    // The twist of the node that goes is shared out by the lengths. The merged edge's director, carried from a chord that lies
    // otherwise, changes the reference twist at both of its ends. Its angle can take back one change or half of the sum.
    TEST_CASE(
        "property: a merge changes the twist at both ends of the merged edge alike, and at a free end's neighbour not at all")
    {
        for (const bool held : {false, true})
            for (int node = 1; node < edges; ++node) {
                CAPTURE(held);
                CAPTURE(node);
                UnevenWire wire(false);
                if (held) wire.hold_hub();
                const auto n = static_cast<std::size_t>(node);
                const std::vector<double> before = wire.twists();
                const double first = wire.rod.rest_length[node - 1], second = wire.rod.rest_length[node],
                             share = second / (first + second);
                merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), node);
                wire.node_moved(-1);
                const std::vector<double> after = wire.twists();
                const double at_a = after[n - 1] - before[n - 1] - share * before[n];
                const double at_b = after[n] - before[n + 1] - (1 - share) * before[n];
                const bool tip = node == 1, hub = node == edges - 1 && !held;
                if (!tip && !hub) {
                    CHECK(std::abs(at_a - at_b) < 1e-14);
                    CHECK(std::abs(at_a) < 0.02);  // of the order of the curve's torsion times (kappa h)^2 times h
                } else if (tip) {
                    CHECK(std::abs(at_b) < 1e-14);
                } else {
                    CHECK(std::abs(at_a) < 1e-14);
                }
                for (std::size_t i = 1; i + 1 < n; ++i) CHECK(after[i] == before[i]);
                for (std::size_t i = n + 2; i < before.size(); ++i) CHECK(after[i - 1] == before[i]);
            }
    }

    // A split leaves the twist per length at both neighbours as it is. Angles of the new edges differ by what is between.
    TEST_CASE("property: a split changes the twist per length at neither end of the edge")
    {
        for (const bool held : {false, true})
            for (int edge = 0; edge < edges; ++edge)
                for (const double fraction : {0.3, 0.5, 0.8}) {
                    CAPTURE(held);
                    CAPTURE(edge);
                    CAPTURE(fraction);
                    UnevenWire wire(false);
                    if (held) wire.hold_hub();
                    const auto rate = [&](int i) {
                        const std::vector<double> twist = wire.twists();
                        return twist[static_cast<std::size_t>(i)] / wire.rod.voronoi_length(i);
                    };
                    const double at_a = rate(edge), at_b = rate(edge + 1);
                    split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge, fraction);
                    wire.node_moved(1);
                    // the cells have other lengths by the arc's excess over its chord, (kappa h)^2/24
                    if (edge > 0) CHECK(std::abs(rate(edge) - at_a) < 1e-2 * std::abs(at_a));
                    if (edge + 2 < wire.rod.n - 1 || held) CHECK(std::abs(rate(edge + 2) - at_b) < 1e-2 * std::abs(at_b));
                }
    }

    // Spins are linear between the middles of edges: with slopes k0 and k1 at its ends the halves of an edge have, before their
    // common momentum is set right, s - k0 (second)/2 and s + k1 (first)/2.
    TEST_CASE("analytic: spins and their rates go on with the slopes at both ends of a split edge")
    {
        for (int edge = 1; edge + 1 < edges; ++edge)
            for (const double fraction : {0.3, 0.5, 0.8}) {
                CAPTURE(edge);
                CAPTURE(fraction);
                UnevenWire wire(true);
                const RodView& old = wire.rod;
                const auto slope = [&](std::span<const double> rate, int i) {
                    return (rate[i] - rate[i - 1]) / old.voronoi_length(i);
                };
                const double length = old.rest_length[edge], first = fraction * length, second = length - first;
                const double spins[2] = {slope(old.spin_rate, edge), slope(old.spin_rate, edge + 1)};
                const double rates[2] = {slope(old.spin_acc, edge), slope(old.spin_acc, edge + 1)}, acc = old.spin_acc[edge];
                split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge, fraction);
                wire.node_moved(1);
                const RodView& rod = wire.rod;
                REQUIRE(rod.rest_length[edge] == about(first).epsilon(1e-12));
                CHECK(rod.spin_rate[edge + 1] - rod.spin_rate[edge] ==
                      about(0.5 * (spins[0] * second + spins[1] * first)).epsilon(1e-11));
                CHECK(rod.spin_acc[edge] == about(acc - 0.5 * rates[0] * second).epsilon(1e-12));
                CHECK(rod.spin_acc[edge + 1] == about(acc + 0.5 * rates[1] * first).epsilon(1e-12));
            }
    }

    TEST_CASE(
        "analytic: a new node's acceleration is between its neighbours', and a merged edge's spin rate their mean by length")
    {
        UnevenWire wire(true);
        for (int i = 0; i <= edges; ++i) wire.rod.ax[i] = 2.0 * i * i, wire.rod.ay[i] = -i, wire.rod.az[i] = 0.5;
        const double ax[2] = {wire.rod.ax[4], wire.rod.ax[5]}, first = wire.rod.rest_length[6], second = wire.rod.rest_length[7];
        const double acc[2] = {wire.rod.spin_acc[6], wire.rod.spin_acc[7]};
        merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), 7);
        wire.node_moved(-1);
        CHECK(wire.rod.spin_acc[6] == about((first * acc[0] + second * acc[1]) / (first + second)).epsilon(1e-13));
        split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), 4, 0.3);
        wire.node_moved(1);
        CHECK(wire.rod.ax[5] == about(0.7 * ax[0] + 0.3 * ax[1]).epsilon(1e-14));
        CHECK(wire.rod.ay[5] == about(-4.3).epsilon(1e-14));
        CHECK(wire.rod.az[5] == about(0.5).epsilon(1e-14));
    }

    // The hub stands in its sleeve and takes no part. The base edge goes on as fast as the wire at its end does.
    TEST_CASE("property: a birth and a merge at the base keep the momentum of what is outside, the hub's speed and the force")
    {
        for (const bool birth : {true, false}) {
            CAPTURE(birth);
            UnevenWire wire(false);
            wire.hold_hub();
            for (int i = 0; i < edges; ++i) wire.rod.set_vel(i, Vec3(0.1 * i, 0.3, -0.02 * i * i));
            wire.rod.material_s[edges] -= 0.002, wire.rod.material_s[edges - 1] -= 0.001;  // both edges at the base are stretched
            set_rest_shape(wire.rod, wire.spec, false);
            const auto force = [&](int j) {
                const RodView& rod = wire.rod;
                return rod.stretch_stiffness[j] * ((rod.pos(j + 1) - rod.pos(j)).norm() / rod.rest_length[j] - 1);
            };
            const auto momentum = [&] {
                Vec3 sum = Vec3::Zero();
                for (int i = 0; i + 1 < wire.rod.n; ++i) sum += wire.rod.mass[i] * wire.rod.vel(i);
                return sum;
            };
            const double first = wire.rod.rest_length[edges - 2], second = wire.rod.rest_length[edges - 1],
                         length = wire.rod.material_s[edges];
            const double mean = (first * force(edges - 2) + second * force(edges - 1)) / (first + second),
                         base = force(edges - 1);
            const Vec3 before = momentum();
            SplitScratch scratch;
            const SplitResult result = birth ? split_base_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), 0.9, scratch)
                                             : merge_base_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps));
            wire.node_moved(birth ? 1 : -1);
            const int hub = wire.rod.n - 1;
            CHECK((momentum() - before).norm() < 1e-13 * before.norm());
            CHECK(wire.rod.vel(hub) == Vec3::Zero());
            CHECK(force(hub - 1) == about(birth ? base : mean).epsilon(1e-9));
            if (birth) CHECK(force(hub - 2) == about(base).epsilon(1e-9));
            CHECK(result.rest_length_added == about(wire.rod.material_s[hub] - length).epsilon(1e-9));
            const Vec3 out = (wire.rod.pos(hub - 1) - wire.rod.pos(hub)).normalized();
            CHECK(result.base_rate == about(out.dot(wire.rod.vel(hub - 1))).epsilon(1e-12));
        }
    }

    // Where the rest shape is the placed one a node that goes gives its natural curvature to its neighbours by the lever's rule.
    // On a straight line of edges the sum and the moment sum_i kappa_i s_i stay.
    TEST_CASE("property: a merge keeps the natural curvature's sum and moment along the wire, a split an even one")
    {
        for (int node = 1; node < edges; ++node) {
            CAPTURE(node);
            UnevenWire wire(true);
            const std::span<double> rests[3] = {wire.rod.rest_kappa1, wire.rod.rest_kappa2, wire.rod.rest_twist};
            for (int k = 0; k < 3; ++k)
                for (int i = 1; i < edges; ++i) rests[k][i] = 0.1 * (k + 1) + 0.02 * i * i;
            const auto sums = [&](int k) {
                const std::span<double> rest = k == 0   ? wire.rod.rest_kappa1
                                               : k == 1 ? wire.rod.rest_kappa2
                                                        : wire.rod.rest_twist;
                double sum = 0, moment = 0;
                for (int i = 0; i < wire.rod.n; ++i) sum += rest[i], moment += rest[i] * wire.rod.material_s[i];
                return std::pair(sum, moment);
            };
            std::pair<double, double> before[3];
            for (int k = 0; k < 3; ++k) before[k] = sums(k);
            merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps, true), node);
            wire.node_moved(-1);
            for (int k = 0; k < 3; ++k) {
                CHECK(sums(k).first == about(before[k].first).epsilon(1e-13));
                CHECK(sums(k).second == about(before[k].second).epsilon(1e-12));
            }
        }
        for (int edge = 1; edge + 1 < edges; ++edge) {
            CAPTURE(edge);
            UnevenWire wire(true);
            const double rates[3] = {1.5, -0.7, 0.4};
            for (int i = 0; i <= edges; ++i) {
                const double cell = wire.rod.voronoi_length(i);
                wire.rod.rest_kappa1[i] = rates[0] * cell, wire.rod.rest_kappa2[i] = rates[1] * cell,
                wire.rod.rest_twist[i] = rates[2] * cell;
            }
            split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps, true), edge, 0.3);
            wire.node_moved(1);
            for (int i = 0; i < wire.rod.n; ++i) {
                const double cell = wire.rod.voronoi_length(i);
                CHECK(wire.rod.rest_kappa1[i] == about(rates[0] * cell).epsilon(1e-12));
                CHECK(wire.rod.rest_kappa2[i] == about(rates[1] * cell).epsilon(1e-12));
                CHECK(wire.rod.rest_twist[i] == about(rates[2] * cell).epsilon(1e-12));
            }
        }
    }

    TEST_CASE("property: a wire of one edge has no natural curvature where it was placed, and one of two edges that of its turn")
    {
        OneWire bar(2, 4);
        bar.place({Vec3(0.3, 0.1, 0), Vec3(0, 0, 0.2)});
        set_rest_shape(bar.rod, uniform_spec(1, 0.8, 0.6, 400), true);
        for (int i = 0; i < 2; ++i) {
            CHECK(bar.rod.rest_kappa1[i] == 0);
            CHECK(bar.rod.rest_kappa2[i] == 0);
            CHECK(bar.rod.rest_twist[i] == 0);
        }
        OneWire knee(3, 4);
        knee.place({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1 + std::cos(0.3), std::sin(0.3), 0)});
        set_rest_shape(knee.rod, uniform_spec(3, 0.8, 0.6, 400), true);
        const double turn = curvature_of(knee.rod);
        REQUIRE(turn > 0.29);
        for (int i = 0; i < 3; ++i)  // per length the same in all cells, as of one node nothing else is known
            CHECK(std::hypot(knee.rod.rest_kappa1[i], knee.rod.rest_kappa2[i]) ==
                  about(turn * knee.rod.voronoi_length(i)).epsilon(1e-12));
    }
}

}  // namespace seldinger::test::test_split_space
