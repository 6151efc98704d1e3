// Splitting and merging edges: nothing that the wire carries may jump.

#include "math/eigen.h"
#include "nodes/split.h"
#include "rod/rod_fixture.h"

#include <Eigen/Geometry>

namespace seldinger::test::test_split {

namespace {

constexpr double bend = 0.8, twist_stiffness = 0.6, stretch = 400.0;

double axial(const RodView& rod, int j)
{
    return rod.stretch_stiffness[j] * ((rod.pos(j + 1) - rod.pos(j)).norm() / rod.rest_length[j] - 1);
}

/// An arc of radius 1 in space, `edges` over one radian, under tension, twisted evenly, moving; clamped at the hub along its
/// tangent with the twist going on into the clamp.
struct ArcWire : OneWire {
    static constexpr double twist_rate = 0.9, strain = 0.02;
    WireSpec spec;
    ArcWire(int edges, bool uneven = false) : OneWire(edges + 1, edges + 3)
    {
        const int n = edges + 1;
        std::vector<double> angle;
        for (int i = 0; i < n; ++i) angle.push_back((i + (uneven && i > 0 && i < n - 1 ? 0.25 * (i % 2 ? 1 : -1) : 0.0)) / edges);
        const Mat3 tilt = to_mat3(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix());
        std::vector<Vec3> nodes;
        for (const double a : angle) nodes.push_back(tilt * Vec3(std::cos(a), std::sin(a), 0));
        place(nodes, tilt * Vec3::UnitZ());
        for (int i = 0; i < n; ++i) rod.material_s[i] /= 1 + strain;
        spec = uniform_spec(10.0, bend, twist_stiffness, stretch);
        set_rest_shape(rod, spec, false);
        for (int j = 0; j < n - 1; ++j) {
            rod.theta[j] = twist_rate * 0.5 * (rod.material_s[j] + rod.material_s[j + 1]);
            rod.spin_rate[j] = 1 + 0.3 * rod.theta[j];
            rod.spin_acc[j] = 0.5 * rod.theta[j];
        }
        for (int i = 0; i < n; ++i) rod.set_vel(i, tilt * Vec3(std::sin(angle[i]), 1 + angle[i], 0.3));
        RodClamp clamp{.node = n - 1,
                       .spin = true,
                       .tangent = tilt * Vec3(-std::sin(1.0), std::cos(1.0), 0),
                       .turns = twist_rate * rod.material_s[n - 1]};
        clamp.director = turned(tilt * Vec3::UnitZ(), clamp.tangent, clamp.turns);
        clamps = {clamp};
        REQUIRE(accept(OwnedTrial(rod)));
    }
    void node_moved(int by)
    {
        rod = arrays.view(0);
        for (RodClamp& clamp : clamps) clamp.node += by;
    }
    [[nodiscard]] Vec3 momentum() const
    {
        Vec3 p = Vec3::Zero();
        for (int i = 0; i < rod.n; ++i) p += rod.mass[i] * rod.vel(i);
        return p;
    }
    [[nodiscard]] double spin_momentum() const
    {
        double l = 0;
        for (int j = 0; j < rod.n - 1; ++j) l += rod.spin_inertia[j] * rod.spin_rate[j];
        return l;
    }
    /// Largest deviation from curvature 1 and from the twist rate, per length, over inner nodes and the clamp's half cell.
    [[nodiscard]] std::pair<double, double> worst_curvature_and_twist()
    {
        REQUIRE(update());
        double curvature = 0, twist = 0;
        for (int i = 1; i < rod.n - 1; ++i) {
            const double length = rod.voronoi_length(i);
            curvature = std::max(curvature, std::abs(frames.kb[i].norm() / (length * (1 + strain)) - 1));
            twist = std::max(twist, std::abs(frames.twist[i] / length - twist_rate));
        }
        const double half = 0.5 * rod.rest_length[rod.n - 2];
        twist = std::max(twist, std::abs(frames.clamp_twist[0] / half - twist_rate));
        return {curvature, twist};
    }
};

}  // namespace

TEST_SUITE("nodes/split")
{
    TEST_CASE("property: axial force, momentum and spin momentum stay as they were")
    {
        for (const int edge : {0, 4, 9})
            for (const double fraction : {0.5, 0.3}) {
                CAPTURE(edge);
                CAPTURE(fraction);
                ArcWire wire(10, true);
                const double force = axial(wire.rod, edge), length = wire.rod.material_s[10];
                const Vec3 momentum = wire.momentum();
                const double spin = wire.spin_momentum();
                const double arc = wire.rod.rest_length[edge];
                const SplitResult result = split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge, fraction);
                wire.node_moved(1);
                REQUIRE(wire.rod.n == 12);
                CHECK(axial(wire.rod, edge) == about(force).epsilon(1e-10));
                CHECK(axial(wire.rod, edge + 1) == about(force).epsilon(1e-10));
                CHECK((wire.momentum() - momentum).norm() < 1e-14 * momentum.norm());
                CHECK(std::abs(wire.spin_momentum() - spin) < 1e-14 * spin);
                CHECK(wire.rod.material_s[11] - length == about(result.rest_length_added).epsilon(1e-9));
                // the arc's excess over its chords: (1 - f^3 - (1-f)^3) h (kappa h)^2/24, at the tip with curvature falling to 0
                const double excess = (1 - std::pow(fraction, 3) - std::pow(1 - fraction, 3)) * std::pow(arc, 3) / 24;
                if (edge > 0) CHECK(result.rest_length_added == about(excess).epsilon(0.1));
                else CHECK(std::abs(result.rest_length_added) < excess);
            }
    }

    // curvature on an arc is exact at even nodes but for O(h^2) of the discrete kappa itself
    TEST_CASE("property: moment and torque change by O(h^2) only, at the base edge and inside")
    {
        for (const bool base : {true, false})
            for (const double fraction : {0.5, 0.35}) {
                double curvature[3], twist[3];
                for (int k = 0; k < 3; ++k) {
                    const int edges = 8 << k;
                    ArcWire wire(edges);
                    split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), base ? edges - 1 : edges / 2, fraction);
                    wire.node_moved(1);
                    std::tie(curvature[k], twist[k]) = wire.worst_curvature_and_twist();
                }
                CAPTURE(base);
                CAPTURE(fraction);
                CAPTURE(curvature[0]);
                CAPTURE(twist[0]);
                // the chord's middle instead of the cubic would leave 1/3
                CHECK(curvature[0] < 0.5 / 64);
                CHECK(curvature[1] < 0.3 * curvature[0]);  // a factor 4 each, with room
                CHECK(curvature[2] < 0.3 * curvature[1]);
                CHECK(twist[0] < 0.5 / 64);
                CHECK(twist[2] < 0.1 * twist[0]);
            }
    }

    // Of a circle the cubic is off by O(h^4) where its end has the circle's curvature; taken for straight there it is off by
    // h^2/32.
    TEST_CASE("analytic: the point of a split at a free end lies on an arc at rest")
    {
        for (const bool tip : {true, false}) {
            CAPTURE(tip);
            double off[3] = {}, straight[3] = {};
            for (int k = 0; k < 3; ++k) {
                const int edges = 8 << k;
                OneWire wire(edges + 1);
                std::vector<Vec3> nodes;
                for (int i = 0; i <= edges; ++i) nodes.emplace_back(std::cos(1.0 * i / edges), std::sin(1.0 * i / edges), 0);
                wire.place(nodes);
                const int edge = tip ? 0 : edges - 1;
                off[k] = std::abs(split_point(wire.rod, edge, 0.5, {}, Vec3::UnitZ()).norm() - 1);
                straight[k] = std::abs(split_point(wire.rod, edge, 0.5, {}, Vec3::Zero()).norm() - 1);
                CHECK(straight[k] == about(1.0 / 32 / (edges * edges)).epsilon(0.05));
            }
            CHECK(off[0] < 0.02 * straight[0]);
            CHECK(off[1] < 0.1 * off[0]);  // a factor 16 each, with room
            CHECK(off[2] < 0.1 * off[1]);
        }
    }

    // An arc turns by 2 asin(h/2) at a node, at rest by its chord h: h^2/24 of its curvature. A split that took a free end for
    // straight would bend the new node by a quarter too little, however short the edge.
    TEST_CASE("analytic: an arc at rest stays at rest where a free end is split, but for O(h^2)")
    {
        for (const bool tip : {true, false})
            for (const double fraction : {0.5, 0.35}) {
                CAPTURE(tip);
                CAPTURE(fraction);
                double worst[3] = {};
                for (int k = 0; k < 3; ++k) {
                    const int edges = 8 << k;
                    OneWire wire(edges + 1, edges + 3);
                    std::vector<Vec3> nodes;
                    for (int i = 0; i <= edges; ++i) nodes.emplace_back(std::cos(1.0 * i / edges), std::sin(1.0 * i / edges), 0);
                    wire.place(nodes);
                    WireSpec spec = uniform_spec(10.0, bend, twist_stiffness, stretch);
                    set_rest_shape(wire.rod, spec, false);
                    REQUIRE(wire.accept(OwnedTrial(wire.rod)));
                    spec.shaft.rest_curvature = {0, wire.frames.kappa2[1] > 0 ? 1.0 : -1.0};
                    set_rest_shape(wire.rod, spec, false);
                    split_edge(WireNodes(wire.arrays, 0, spec, {}), tip ? 0 : edges - 1, fraction);
                    wire.rod = wire.arrays.view(0);
                    REQUIRE(wire.update());
                    for (int i = 1; i < wire.rod.n - 1; ++i) {
                        const Vec2 off(wire.frames.kappa1[i] - wire.rod.rest_kappa1[i],
                                       wire.frames.kappa2[i] - wire.rod.rest_kappa2[i]);
                        worst[k] = std::max(worst[k], off.norm() / wire.rod.voronoi_length(i));
                    }
                }
                CAPTURE(worst[0]);
                CHECK(worst[0] < 0.5 / 64);
                CHECK(worst[1] < 0.3 * worst[0]);  // a factor 4 each, with room
                CHECK(worst[2] < 0.3 * worst[1]);
            }
    }

    TEST_CASE("property: split, then merge, returns to where it was")
    {
        for (const bool base : {true, false}) {
            ArcWire wire(10, true);
            const ArcWire start(10, true);
            const int edge = base ? 9 : 3;
            const SplitResult split = split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge, 0.4);
            wire.node_moved(1);
            const SplitResult merge = merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge + 1);
            wire.node_moved(-1);
            REQUIRE(wire.rod.n == 11);
            CHECK(std::abs(split.rest_length_added + merge.rest_length_added) < 1e-14);
            for (int i = 0; i < 11; ++i) {
                CHECK((wire.rod.pos(i) - start.rod.pos(i)).norm() < 1e-15);
                CHECK(std::abs(wire.rod.material_s[i] - start.rod.material_s[i]) < 1e-13);
                CHECK((wire.rod.vel(i) - start.rod.vel(i)).norm() < 1e-3);  // momentum of the middle goes to its neighbours
                if (i == 10) continue;
                CHECK((wire.rod.ref_d1(i) - start.rod.ref_d1(i)).norm() < 1e-14);
                CHECK(std::abs(wire.rod.theta[i] - start.rod.theta[i]) < 1e-2 * ArcWire::twist_rate * 0.1);
                CHECK(wire.rod.spin_rate[i] == about(start.rod.spin_rate[i]).epsilon(1e-12));
                CHECK(axial(wire.rod, i) == about(axial(start.rod, i)).epsilon(1e-9));
            }
            CHECK((wire.momentum() - start.momentum()).norm() < 1e-13);
        }
    }

    TEST_CASE("property: merging keeps force and momentum, and curvature to O(h^2)")
    {
        double curvature[3], twist[3];
        for (int k = 0; k < 3; ++k) {
            const int edges = 8 << k;
            ArcWire wire(edges);
            const Vec3 momentum = wire.momentum();
            const double spin = wire.spin_momentum(), force = axial(wire.rod, edges / 2);
            merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edges / 2);
            wire.node_moved(-1);
            CHECK(axial(wire.rod, edges / 2 - 1) == about(force).epsilon(1e-10));
            CHECK((wire.momentum() - momentum).norm() < 1e-14 * momentum.norm());
            CHECK(std::abs(wire.spin_momentum() - spin) < 1e-14 * spin);
            std::tie(curvature[k], twist[k]) = wire.worst_curvature_and_twist();
        }
        CHECK(curvature[0] < 1.0 / 64);
        CHECK(curvature[2] < 0.1 * curvature[0]);
        CHECK(twist[0] < 1.0 / 64);
        CHECK(twist[2] < 0.1 * twist[0]);
    }

    // The base edge of a wire that slides out of a sleeve along its own arc. A node born at the sleeve changes forces by the
    // polygon's error times the ratio of the new and old base edge. Its change of speeds stretches no edge.
    TEST_CASE(
        "property: a node born at the sleeve leaves moments, speeds and lengths as they are, the more the nearer it is born")
    {
        double curvature[2];
        for (int k = 0; k < 2; ++k) {
            ArcWire wire(10);
            const double born = k == 0 ? 0.1 : 0.01, speed = 0.3, force = axial(wire.rod, 9);
            for (int i = 0; i <= 10; ++i) {  // along the arc, towards the tip
                const Vec3 t = i == 0    ? wire.rod.tangent(0)
                               : i == 10 ? wire.clamps[0].tangent
                                         : (wire.rod.tangent(i - 1) + wire.rod.tangent(i)).normalized();
                wire.rod.set_vel(i, -speed * t);
            }
            const auto [before, twist] = wire.worst_curvature_and_twist();
            SplitScratch scratch;
            const Vec3 momentum = wire.momentum();
            const SplitResult result = split_base_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), 1 - born, scratch);
            wire.node_moved(1);
            const RodView& rod = wire.rod;
            CHECK(axial(rod, 9) == about(force).epsilon(1e-10));
            CHECK(axial(rod, 10) == about(force).epsilon(1e-10));
            curvature[k] = std::abs(wire.worst_curvature_and_twist().first - before);
            CHECK((wire.momentum() - momentum).norm() < 1e-14 * momentum.norm());
            // between the last nodes no length changes; the base edge grows as fast as the new node leaves it
            CHECK(std::abs(rod.tangent(9).dot(rod.vel(10) - rod.vel(9))) < 1e-14);
            CHECK(result.base_rate == about(-rod.tangent(10).dot(rod.vel(10))).epsilon(1e-12));
            // the rest moves as before, except for the polygon's momentum of one node in ten
            CHECK(std::abs(rod.vel(9).norm() / speed - 1) < 0.1 * 0.05 * 0.05);
            // chord against arc: an angle kappa h/2 of 0.05, phi^2/2 of the speed
            CHECK(std::abs(result.base_rate / speed - 1) < 0.05 * 0.05 / 2 * 1.2);
        }
        CAPTURE(curvature[0]);
        CHECK(curvature[0] < 0.01);
        CHECK(curvature[1] <= 0.15 * curvature[0]);  // both none where the new node is bent less than its neighbours
    }

    TEST_CASE("property: many turns stored between tip and clamp survive a split")
    {
        ArcWire wire(10);
        const double turns = 40;
        for (int j = 0; j < 10; ++j) wire.rod.theta[j] += turns * 0.5 * (wire.rod.material_s[j] + wire.rod.material_s[j + 1]);
        wire.clamps[0].turns += turns * wire.rod.material_s[10];
        wire.clamps[0].director = turned(wire.clamps[0].director, wire.clamps[0].tangent, turns * wire.rod.material_s[10]);
        REQUIRE(wire.accept(OwnedTrial(wire.rod)));
        REQUIRE(wire.update());
        const double torque = clamp_torque(wire.rod, wire.clamps, wire.frames, 0);
        CHECK(torque == about(twist_stiffness * (turns + ArcWire::twist_rate)).epsilon(1e-3));
        for (const int edge : {9, 4}) {
            split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps), edge, 0.5);
            wire.node_moved(1);
            REQUIRE(wire.update());
            // the lengths that twist is counted over change by (kappa h)^2/32 = 3e-4
            CHECK(clamp_torque(wire.rod, wire.clamps, wire.frames, 0) == about(torque).epsilon(1e-3));
            for (int i = 1; i < wire.rod.n - 1; ++i)
                CHECK(wire.frames.twist[i] / wire.rod.voronoi_length(i) == about(turns + ArcWire::twist_rate).epsilon(2e-3));
        }
    }

    TEST_CASE("property: a wire whose rest shape is its placed one keeps its total rest curvature")
    {
        ArcWire wire(10);
        set_rest_shape(wire.rod, wire.spec, true);
        const auto total = [&] {
            double sum[2] = {0, 0};
            for (int i = 0; i < wire.rod.n; ++i) {
                sum[0] += std::hypot(wire.rod.rest_kappa1[i], wire.rod.rest_kappa2[i]);
                sum[1] += wire.rod.rest_twist[i];
            }
            return std::pair(sum[0], sum[1]);
        };
        const auto before = total();
        REQUIRE(before.first > 0.9);
        split_edge(WireNodes(wire.arrays, 0, wire.spec, wire.clamps, true), 4, 0.3);
        wire.node_moved(1);
        CHECK(total().first == about(before.first).epsilon(1e-2));  // lengths of 2-vectors that differ in direction
        CHECK(total().second == about(before.second).epsilon(1e-12));
        merge_edges(WireNodes(wire.arrays, 0, wire.spec, wire.clamps, true), 5);
        wire.node_moved(-1);
        CHECK(total().second == about(before.second).epsilon(1e-12));
    }
}

}  // namespace seldinger::test::test_split
