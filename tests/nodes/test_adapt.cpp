// engine/bodies/nodes/adapt.cpp: refined edges, coarsened edges, kept edges; and that it ends.

#include "nodes/adapt.h"
#include "rod/rod_fixture.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace seldinger::test::test_adapt {

namespace {

constexpr int capacity = 600;

/// A wire of 0.3 m along a plane curve of given curvature [1/m] at arc length s [m], its nodes on the curve, moving.
struct CurvedWire : OneWire {
    WireSpec spec;
    NodePlanner planner;
    double added = 0;  // rest length [m]

    CurvedWire(int n, const std::function<double(double)>& curvature, std::vector<WireSectionRange> sections = {})
        : OneWire(n, capacity)
    {
        spec = uniform_spec(0.3, 5e-4, 3.8e-4, 1e4);
        spec.shaft.radius = 0.4445e-3;
        spec.sections = std::move(sections);
        std::vector<Vec3> nodes;
        Vec3 p = Vec3::Zero();
        double angle = 0;
        const int fine = 200;  // midpoint rule, exact to (length / fine)^2 of an edge: far below what is judged
        const double ds = 0.3 / (n - 1) / fine;
        for (int i = 0; i < n; ++i) {
            nodes.push_back(p);
            for (int k = 0; k < fine; ++k) {
                const double kappa = curvature((i * fine + k + 0.5) * ds);
                p += ds * Vec3(std::cos(angle + 0.5 * kappa * ds), std::sin(angle + 0.5 * kappa * ds), 0);
                angle += kappa * ds;
            }
        }
        place(nodes);
        set_rest_shape(rod, spec, false);
        for (int i = 0; i < n; ++i) rod.set_vel(i, Vec3(0.02, 0.01 * i, -0.03));
        planner = NodePlanner(spec, capacity);
    }
    /// One call as a step makes it. @return whether anything changed
    bool adapt(const NodeDemands& demands = {})
    {
        const auto changes = planner.plan(rod, spec, demands, capacity);
        if (changes.empty()) return false;
        added += apply_changes(WireNodes(arrays, 0, spec, {}), changes);
        rod = arrays.view(0);
        return true;
    }
    /// @return calls until nothing changes any more, or -1
    int settle(const NodeDemands& demands = {}, int most = 1000)
    {
        for (int k = 0; k < most; ++k)
            if (!adapt(demands)) return k;
        return -1;
    }
    [[nodiscard]] Vec3 momentum() const
    {
        Vec3 p = Vec3::Zero();
        for (int i = 0; i < rod.n; ++i) p += rod.mass[i] * rod.vel(i);
        return p;
    }
    [[nodiscard]] double nearest_node(double s) const
    {
        double best = 1;
        for (int i = 0; i < rod.n; ++i) best = std::min(best, std::abs(rod.material_s[i] - s));
        return best;
    }
    void check_edges() const
    {
        for (int j = 0; j < rod.n - 1; ++j) {
            CAPTURE(j);
            const double h = rod.rest_length[j];
            CHECK(h >= spec.min_edge * (1 - 1e-3));  // surpluses of rest length: (kappa h)^2/32 at most
            CHECK(h <= spec.max_edge * (1 + 1e-3));
            if (j == 0) continue;
            const double ratio = h / rod.rest_length[j - 1];
            CHECK(std::max(ratio, 1 / ratio) <= 1.05 * edge_ratio_limit);  // the slack of spread_marks
        }
    }
};

// straight, then a bend of 25 mm radius entered and left smoothly, then straight
double bend(double s)
{
    const double u = (s - 0.12) / 0.06;
    return u > 0 && u < 1 ? 40 * std::pow(std::sin(3.14159265358979 * u), 2) : 0.0;
}

}  // namespace

TEST_SUITE("nodes/adapt")
{
    // On a circle the moment is constant: only the first two terms of e(h) are left, and e(h) = edge_error gives h in closed
    // form.
    TEST_CASE("analytic: the longest edge on a circle")
    {
        const double kappa = 30, lever = 0.03;
        CurvedWire wire(301, [&](double) { return kappa; });
        for (const CurvatureMeasure measure : {CurvatureMeasure::Angle, CurvatureMeasure::Tangent}) {
            wire.rod.curvature = measure;
            const double a = measure == CurvatureMeasure::Angle ? 0 : 1.0 / 12;
            const auto longest = wire.planner.longest_edges(wire.rod, wire.spec, {});
            const double expected = std::cbrt(wire.spec.edge_error / (kappa * kappa / 24 + a * lever * kappa * kappa * kappa));
            // curvature phi/h or 2 tan(phi/2)/h of nodes on the circle: (kappa h)^2/24 relative and less, 4e-5 at h = 1 mm
            for (int j = 40; j < 298; ++j) CHECK(longest[j] == about(expected).epsilon(1e-4));
            CHECK(expected > wire.spec.min_edge);
            CHECK(expected < wire.spec.max_edge);
        }
    }

    // A moment that is linear from a force at one node: only the jump of shear there counts, D = F.
    TEST_CASE("analytic: the longest edge beside a force")
    {
        const double force = 0.05, stiffness = 5e-4, step = 0.002;
        // kappa = F (0.1 - |s - 0.15|)/(2 B), F/2 of shear on either side
        CurvedWire wire(151, [&](double s) { return std::max(0.0, force * (0.1 - std::abs(s - 0.15)) / (2 * stiffness)); });
        const auto longest = wire.planner.longest_edges(wire.rod, wire.spec, {});
        // Curvature is the mean over a cell, which rounds the peak off: the node at the force sees (1 - 1/4) of it, its
        // neighbours 1/8 each; an edge has one of either.
        const double jump = 0.5 * (0.75 + 0.125) * force;
        const double by_force = std::sqrt(wire.spec.edge_error * 12 * stiffness / (0.03 * jump));
        const double kappa = force * 0.1 / (2 * stiffness);
        const double by_curvature = std::cbrt(wire.spec.edge_error / (kappa * kappa / 24));
        REQUIRE(by_force < by_curvature);
        // node 75 is the peak; moments are known where nodes are, to step of 0.1
        CHECK(longest[74] == about(by_force).epsilon(2 * step / 0.1));
        CHECK(longest[75] == about(longest[74]).epsilon(1e-3));
    }

    TEST_CASE("property: edges stay within their bounds and their ratio, and a wire that stands still comes to rest in its nodes")
    {
        for (const int n : {31, 61, 151, 281}) {
            CAPTURE(n);
            CurvedWire wire(n, bend);
            const Vec3 before = wire.momentum();
            const int calls = wire.settle();
            REQUIRE(calls >= 0);
            wire.check_edges();
            CHECK((wire.momentum() - before).norm() <= 1e-12 * before.norm());  // rounding of at most a few hundred changes
            // the bend is finer than the straight parts, whose edges are nearly the longest
            double in_bend = 0;
            int edges_in_bend = 0;
            for (int j = 0; j < wire.rod.n - 1; ++j) {
                const double s = 0.5 * (wire.rod.material_s[j] + wire.rod.material_s[j + 1]);
                if (s < 0.135 || s > 0.165) continue;
                in_bend += wire.rod.rest_length[j];
                ++edges_in_bend;
            }
            REQUIRE(edges_in_bend > 0);
            CHECK(in_bend / edges_in_bend < 0.5 * wire.rod.rest_length[wire.rod.n / 8]);
            CHECK(wire.settle() == 0);
        }
    }

    TEST_CASE("property: on a straight wire every node goes that nothing needs")
    {
        CurvedWire wire(281, [](double) { return 0.0; });
        REQUIRE(wire.settle() >= 0);
        wire.check_edges();
        // two neighbours always come to more than max_edge
        for (int j = 1; j < wire.rod.n - 1; ++j)
            CHECK(wire.rod.rest_length[j - 1] + wire.rod.rest_length[j] > wire.spec.max_edge / edge_ratio_limit);
        CHECK(wire.rod.n < 60);
        CHECK(std::abs(wire.added) < 1e-15);  // chords are arcs here
    }

    TEST_CASE("property: nodes at holds, loads and boundaries of sections stay, and boundaries get theirs")
    {
        WireSection soft = uniform_spec(0.3, 1e-5, 8e-6, 1e4).shaft;
        CurvedWire wire(281, bend, {{0.0, 0.0305, soft}});
        const std::vector<double> kept = {wire.rod.material_s[57], wire.rod.material_s[140], wire.rod.material_s[222]};
        NodeDemands demands;
        demands.kept = kept;
        REQUIRE(wire.settle(demands) >= 0);
        REQUIRE(wire.rod.n < 200);  // others did go
        // material_s moves by the surpluses, some micrometres
        for (const double s : kept) CHECK(wire.nearest_node(s) < 1e-5);
        CHECK(wire.nearest_node(0.0305) < 1e-3);  // a node that was nearer than min_edge serves
        CurvedWire coarse(31, bend, {{0.0, 0.0345, soft}});
        REQUIRE(coarse.settle() >= 0);
        CHECK(coarse.nearest_node(0.0345) < 1e-5);
    }

    TEST_CASE("property: a wire of constant length gives its surplus back exactly")
    {
        CurvedWire wire(31, bend);
        const double length = wire.rod.material_s[30];
        REQUIRE(wire.settle() >= 0);
        REQUIRE(wire.added > 1e-7);  // splits on the bend
        const double mass = std::accumulate(wire.rod.mass.begin(), wire.rod.mass.end(), 0.0);
        shorten_evenly(wire.rod, wire.spec, wire.added, false);
        CHECK(wire.rod.material_s[wire.rod.n - 1] == about(length).epsilon(1e-14));
        const double shorter = std::accumulate(wire.rod.mass.begin(), wire.rod.mass.end(), 0.0);
        CHECK(shorter == about(mass * length / (length + wire.added)).epsilon(1e-12));
    }
}

}  // namespace seldinger::test::test_adapt
