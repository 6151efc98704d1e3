// What splits and merges of a common centreline bent in space do to each instrument's twist and spin.
#include "newton/momentum.h"
#include "nodes/coaxial_nodes.h"
#include "rod/clamp.h"
#include "rod/coaxial_fixture.h"

namespace seldinger::test::test_coaxial_twist {

namespace {

constexpr int edges = 9;

/// A wire in a catheter, both all the way to the hub and alike along it. The line is a curve with torsion, its edges are uneven;
/// angles and spins are of no order.
struct Pair {
    std::vector<WireSpec> specs{instrument_spec(10, 0.8, 0.6), instrument_spec(10, 0.3, 0.9)};
    RodArrays arrays{std::vector<int>{edges + 3, edges + 3}};
    CoaxialRod rod{edges + 3, 2};
    CoaxialBase base;
    std::vector<int> wires{0, 1};

    explicit Pair(bool straight)
    {
        for (const int w : wires) arrays.set_node_count(w, edges + 1);
        for (int k = 0; k < 2; ++k) rod.instrument[k] = {&specs[static_cast<std::size_t>(k)], 0};
        const RodView line = arrays.view(0);
        for (int i = 0; i <= edges; ++i) {
            const double s = 0.25 * (i + 0.2 * std::sin(3.0 * i));
            line.set_pos(i, straight ? Vec3(-s, 0, 0) : Vec3(std::cos(s), std::sin(s), 0.5 * s * s));
            line.material_s[i] = i > 0 ? line.material_s[i - 1] + (line.pos(i) - line.pos(i - 1)).norm() : 0.0;
            line.set_vel(i, Vec3(0.1 * i, 0.3, -0.02 * i * i));
            line.ax[i] = i * i, line.ay[i] = -i, line.az[i] = 0.5;
        }
        initialise_frames(line, Vec3(0.1, 0.2, 1));
        const Vec3 hub = line.tangent(edges - 1);
        base.tangent = straight ? hub : (hub + Vec3(0.1, 0.05, 0.1)).normalized();
        base.director = unit_normal(line.ref_d1(edges - 1) + Vec3(0.2, 0.1, 0), base.tangent);
        const RodClamp sleeve{edges, true, true, base.tangent, base.director, 0};
        line.clamp_twist_a[edges] = clamp_reference(sleeve, 0, hub, line.ref_d1(edges - 1), 0);
        for (const int w : wires) {
            const RodView own = arrays.view(w);
            for (int j = 0; j <= edges; ++j) {
                own.theta[j] = (0.3 + w) * j + 0.05 * j * j;
                own.spin_rate[j] = 1 + w + 0.2 * j * j;
            }
        }
        prepare_group(arrays, wires, rod);
        follow_line(arrays, wires);
    }
    /// Of an instrument at node i; at the hub from the base edge to the clamp [rad].
    [[nodiscard]] double twist(int w, int i)
    {
        const RodView own = arrays.view(w), line = arrays.view(0);
        return own.theta[i] - own.theta[i - 1] + (i < line.n - 1 ? line.ref_twist : line.clamp_twist_a)[i];
    }
    [[nodiscard]] double spin_momentum(int w)
    {
        const RodView own = arrays.view(w);
        double sum = 0;
        for (int j = 0; j + 1 < own.n; ++j) sum += own.spin_inertia[j] * own.spin_rate[j];
        return sum;
    }
    [[nodiscard]] Vec3 momentum() { return seldinger::momentum(arrays.view(0)); }
    [[nodiscard]] double tension(int j)
    {
        const RodView line = arrays.view(0);
        return line.stretch_stiffness[j] * ((line.pos(j + 1) - line.pos(j)).norm() / line.rest_length[j] - 1);
    }
    [[nodiscard]] CoaxialNodes nodes() { return {arrays, wires, rod, base, frames}; }
    SplitScratch scratch;
    RodFrames frames = coaxial_frames(edges + 3);
};

/// Takes out `node`, in the way of the hub or in that of any node. The twist that goes is shared out by the lengths, and what the
/// merged edge's director does to the reference twists is felt alike at both ends: by every instrument the same.
void check_merge(int node, bool base)
{
    CAPTURE(node);
    CAPTURE(base);
    Pair pair(false);
    double before[2][3], spin[2];
    const Vec3 momentum = pair.momentum();
    const double first = pair.arrays.view(0).rest_length[node - 1], second = pair.arrays.view(0).rest_length[node];
    const double share = second / (first + second);
    for (const int w : pair.wires) {
        for (int k = 0; k < 3; ++k) before[w][k] = node + k > 1 ? pair.twist(w, node - 1 + k) : 0;
        spin[w] = pair.spin_momentum(w);
    }
    if (base) (void)merge_base_edges(pair.nodes());
    else (void)merge_edges(pair.nodes(), node);
    REQUIRE(pair.arrays.view(0).n == edges);
    for (const int w : pair.wires) {
        CAPTURE(w);
        const double at_b = pair.twist(w, node) - before[w][2] - (1 - share) * before[w][1];
        if (node == 1) {
            CHECK(std::abs(at_b) < 1e-14);
        } else {
            const double at_a = pair.twist(w, node - 1) - before[w][0] - share * before[w][1];
            CHECK(std::abs(at_a - at_b) < 1e-13);
            CHECK(std::abs(at_a) < 0.03);  // torsion times (kappa h)^2 times h
        }
        CHECK(pair.spin_momentum(w) == about(spin[w]).epsilon(1e-12));
    }
    CHECK((pair.momentum() - momentum).norm() < 1e-13 * momentum.norm());
}

}  // namespace

TEST_SUITE("nodes/coaxial_nodes")
{
    TEST_CASE("property: a merge changes every instrument's twist at both ends of the merged edge alike")
    {
        for (int node = 1; node < edges; ++node) check_merge(node, false);
        check_merge(edges - 1, true);
    }

    TEST_CASE("analytic: a merged edge bears the mean of both tensions by their lengths")
    {
        for (int node = 1; node < edges; ++node)
            for (const bool base : {false, true}) {
                if (base && node + 1 < edges) continue;
                CAPTURE(node);
                CAPTURE(base);
                Pair pair(true);
                const RodView line = pair.arrays.view(0);
                const double stretch = line.stretch_stiffness[0], tension[2] = {4e-4 * stretch, -1e-4 * stretch};
                double length[2];
                for (const int k : {0, 1}) {
                    const int j = node - 1 + k;
                    line.rest_length[j] = length[k] =
                        (line.pos(j + 1) - line.pos(j)).norm() / (1 + tension[k] / line.stretch_stiffness[j]);
                }
                for (int i = 1; i < line.n; ++i) line.material_s[i] = line.material_s[i - 1] + line.rest_length[i - 1];
                prepare_group(pair.arrays, pair.wires, pair.rod);
                for (const int k : {0, 1}) REQUIRE(pair.tension(node - 1 + k) == about(tension[k]).epsilon(1e-9));
                if (base) (void)merge_base_edges(pair.nodes());
                else (void)merge_edges(pair.nodes(), node);
                const double mean = (length[0] * tension[0] + length[1] * tension[1]) / (length[0] + length[1]);
                CHECK(pair.tension(node - 1) == about(mean).epsilon(1e-9));
            }
    }

    // the middle of the tip's half cell is a quarter of the first edge from the tip
    TEST_CASE("analytic: a rod's tip is curved by nature as those instruments ask that reach the middle of its half cell")
    {
        const double curvature[2] = {3, -5};
        for (const double missing : {0.2, 0.3, 0.6}) {  // of the first edge: so far from the rod's tip is the second instrument's
            CAPTURE(missing);
            Pair pair(true);
            for (const int k : pair.wires) pair.specs[static_cast<std::size_t>(k)].shaft.rest_curvature = {curvature[k], 0};
            const RodView line = pair.arrays.view(0);
            pair.rod.instrument[1].offset = -missing * line.rest_length[0];
            prepare_group(pair.arrays, pair.wires, pair.rod);
            Vec3 wanted = Vec3::Zero();
            double stiffness = 0;
            for (int k = 0; k < (missing < 0.25 ? 2 : 1); ++k) {
                const double bend = pair.specs[static_cast<std::size_t>(k)].shaft.bend_stiffness;
                const Vec3 t = line.tangent(0), director = turned(line.ref_d1(0), t, pair.arrays.view(k).theta[0]);
                wanted += bend * curvature[k] * t.cross(director);
                stiffness += bend;
            }
            CHECK((pair.nodes().natural_at_end(0) - wanted / stiffness).norm() < 1e-12);
        }
    }

    TEST_CASE("property: a split changes no instrument's twist per length at either end of the edge, and no momentum")
    {
        for (int edge = 0; edge < edges; ++edge)
            for (const bool base : {false, true}) {
                if (base && edge + 1 < edges) continue;
                CAPTURE(edge);
                CAPTURE(base);
                Pair pair(false);
                const auto rate = [&](int w, int i) {
                    return pair.twist(w, i) / pair.rod.cells[static_cast<std::size_t>(i)].length;
                };
                double before[2][2], spin[2];
                const Vec3 momentum = pair.momentum();
                for (const int w : pair.wires) {
                    for (int k = 0; k < 2; ++k) before[w][k] = edge + k > 0 ? rate(w, edge + k) : 0;
                    spin[w] = pair.spin_momentum(w);
                }
                if (base) (void)split_base_edge(pair.nodes(), 0.7, pair.scratch);
                else (void)split_edge(pair.nodes(), edge, 0.7);
                REQUIRE(pair.arrays.view(0).n == edges + 2);
                for (const int w : pair.wires) {
                    CAPTURE(w);
                    // cells are longer by the arc's excess over its chord, (kappa h)^2/24
                    if (edge > 0) CHECK(rate(w, edge) == about(before[w][0]).epsilon(0.01));
                    CHECK(rate(w, edge + 2) == about(before[w][1]).epsilon(0.01));
                    CHECK(pair.spin_momentum(w) == about(spin[w]).epsilon(1e-12));
                }
                CHECK((pair.momentum() - momentum).norm() < 1e-13 * momentum.norm());
            }
    }

    TEST_CASE("analytic: spins go on with the slopes at both ends of a split edge, accelerations between those of the nodes")
    {
        for (int edge = 1; edge + 1 < edges; ++edge) {
            CAPTURE(edge);
            Pair pair(true);
            const RodView line = pair.arrays.view(0);
            const double first = 0.3 * line.rest_length[edge], second = 0.7 * line.rest_length[edge];
            double differ[2];
            for (const int w : pair.wires) {
                const std::span<const double> spin = pair.arrays.view(w).spin_rate;
                const double tipwards = (spin[edge] - spin[edge - 1]) / line.voronoi_length(edge);
                const double hubwards = (spin[edge + 1] - spin[edge]) / line.voronoi_length(edge + 1);
                differ[w] = 0.5 * (tipwards * second + hubwards * first);
            }
            (void)split_edge(pair.nodes(), edge, 0.3);
            for (const int w : pair.wires) {
                const RodView own = pair.arrays.view(w);
                CHECK(own.spin_rate[edge + 1] - own.spin_rate[edge] == about(differ[w]).epsilon(1e-11));
                CHECK(own.ax[edge + 1] == about(0.7 * edge * edge + 0.3 * (edge + 1) * (edge + 1)).epsilon(1e-13));
                CHECK(own.ay[edge + 1] == about(-(edge + 0.3)).epsilon(1e-13));
            }
        }
        Pair pair(true);
        const RodView line = pair.arrays.view(0);
        double differ[2];  // the hub does not turn faster than its edge
        for (const int w : pair.wires) {
            const std::span<const double> spin = pair.arrays.view(w).spin_rate;
            differ[w] =
                0.5 * (spin[edges - 1] - spin[edges - 2]) / line.voronoi_length(edges - 1) * 0.7 * line.rest_length[edges - 1];
        }
        (void)split_base_edge(pair.nodes(), 0.3, pair.scratch);
        for (const int w : pair.wires) {
            const RodView own = pair.arrays.view(w);
            CHECK(own.spin_rate[edges] - own.spin_rate[edges - 1] == about(differ[w]).epsilon(1e-11));
            CHECK(own.ax[edges] == about(0.7 * (edges - 1) * (edges - 1) + 0.3 * edges * edges).epsilon(1e-13));
        }
    }
}

}  // namespace seldinger::test::test_coaxial_twist
