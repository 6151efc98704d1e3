// Generated walls: sizes, counts, orientation, exact centrelines.
#include "core/error.h"
#include "repair/repair.h"
#include "setup/vessel_load.h"
#include "support/approx.h"
#include "vessel/mesh_edges.h"
#include "vessel/mesh_fixtures.h"

#include <algorithm>
#include <numbers>

namespace seldinger::test::test_shapes {

TEST_SUITE("shapes/shapes")
{
    TEST_CASE("analytic: the tube of experiment 1 has its radius, length, count and openings")
    {
        const GeneratedVessel tube = make_tube(tube_spec(0.018, 0.30, 35000));
        CHECK(std::abs(static_cast<double>(tube.mesh.triangles.size()) - 35000) < 0.02 * 35000);  // whole rows of whole rings
        double off = 0, worst = 1;
        for (const Vec3& v : tube.mesh.vertices) off = std::max(off, std::abs(std::hypot(v.y(), v.z()) - 0.018));
        for (std::size_t t = 0; t < tube.mesh.triangles.size(); ++t)
            worst = std::min(worst, triangle_quality(triangle_of(tube.mesh, t)));
        CHECK(off < 1e-15);
        CHECK(worst > 0.8);  // right triangle with equal legs: sqrt(3)/2
        CHECK(facing_out_of_x_tube(tube.mesh) == 0);
        const RepairReport report = describe(tube.mesh);
        REQUIRE(report.loops.size() == 2);
        CHECK(report.non_manifold_edges == 0);
        CHECK(report.components == 1);
        for (const BoundaryLoop& loop : report.loops) {
            CHECK(loop.radius == about(0.018).epsilon(1e-12));
            CHECK(loop.inward.x() == about(loop.centre.x() < 0.1 ? 1.0 : -1.0).epsilon(1e-12));
        }
        // the floor is a line of vertices at exactly R below the axis, so that a wire lies level on it
        const auto floor = std::count_if(tube.mesh.vertices.begin(), tube.mesh.vertices.end(),
                                         [](const Vec3& v) { return v.z() < -0.018 * (1 - 1e-12); });
        CHECK(floor == static_cast<long>(tube.centreline.points.size()));
        CHECK(tube.centreline.total_length() == about(0.30).epsilon(1e-12));
    }

    TEST_CASE("property: the tube's enclosed volume approaches that of the cylinder from inside")
    {
        const double exact = std::numbers::pi * 0.01 * 0.01 * 0.05;
        for (const int triangles : {500, 5000}) {
            const GeneratedVessel tube = make_tube(tube_spec(0.01, 0.05, triangles));
            double volume = 0;
            for (std::size_t t = 0; t < tube.mesh.triangles.size(); ++t) {
                const Triangle3 tri = triangle_of(tube.mesh, t);
                Vec3 radial = (tri.a + tri.b + tri.c) / 3;
                radial.x() = 0;
                volume -= radial.dot(double_area(tri)) / 4;  // divergence of (0, y, z) is 2; caps do not count
            }
            const auto around =
                std::count_if(tube.mesh.vertices.begin(), tube.mesh.vertices.end(), [](const Vec3& v) { return v.x() == 0; });
            const double n = static_cast<double>(around);
            // a prism over the regular n-gon: area n/2 R^2 sin(2 pi/n)
            CHECK(volume / exact == about(n / 2 * std::sin(2 * std::numbers::pi / n) / std::numbers::pi).epsilon(1e-9));
        }
    }

    TEST_CASE("analytic: the arc's axis is straight, round, straight, with continuous tangents")
    {
        VesselSpec spec{.shape = VesselShape::Arc,
                        .radius = 0.002,
                        .bend_radius = 0.04,
                        .angle = std::numbers::pi,
                        .lead_in = 0.03,
                        .lead_out = 0.09,
                        .axis = Vec3::UnitX(),
                        .normal = Vec3::UnitY(),
                        .triangles = 60000};
        const LoadedVessel vessel = load_vessel(spec);
        CHECK(std::abs(static_cast<double>(vessel.mesh.triangles.size()) - 60000) < 0.03 * 60000);
        const auto& axis = vessel.centreline;
        CHECK((axis.points.front() - Vec3::Zero()).norm() < 1e-15);
        CHECK((axis.points.back() - Vec3(0.03 - 0.09, 0.08, 0)).norm() < 1e-12);
        const double exact = 0.03 + std::numbers::pi * 0.04 + 0.09;
        CHECK(axis.total_length() == about(exact).epsilon(1e-5));  // chords: (step / bend radius)^2 / 24 of the bend
        double off = 0, turn = 0;
        for (std::size_t i = 0; i < axis.points.size(); ++i) {
            const Vec3& p = axis.points[i];
            if (p.x() > 0.03) off = std::max(off, std::abs((p - Vec3(0.03, 0.04, 0)).norm() - 0.04));
            if (i > 0 && i + 1 < axis.points.size()) {
                const Vec3 a = (p - axis.points[i - 1]).normalized(), b = (axis.points[i + 1] - p).normalized();
                turn = std::max(turn, std::acos(std::min(1.0, a.dot(b))));
            }
        }
        CHECK(off < 1e-15);
        CHECK(turn < 0.02);  // one row on the bend turns by row / bend radius = 0.3 mm / 40 mm
        REQUIRE(vessel.report.loops.size() == 2);
        WallMesh mesh = vessel.mesh;
        const RepairReport report = repair(mesh);  // whose own rule for "into the lumen" must agree
        CHECK(report.flipped == 0);
        CHECK_FALSE(report.inverted);
    }

    TEST_CASE("analytic: the plane faces its normal and has its size")
    {
        VesselSpec spec{
            .shape = VesselShape::Plane, .origin = Vec3(1, 2, 3), .normal = Vec3(0, -1, 1), .size = 0.2, .triangles = 800};
        const LoadedVessel plane = load_vessel(spec);
        Vec3 area = Vec3::Zero();
        for (std::size_t t = 0; t < plane.mesh.triangles.size(); ++t) area += 0.5 * double_area(triangle_of(plane.mesh, t));
        CHECK((area - 0.04 * spec.normal.normalized()).norm() < 1e-12);
        CHECK(plane.mesh.triangles.size() == 800);
        CHECK(plane.centreline.empty());
    }

    TEST_CASE("property: impossible sizes are refused")
    {
        CHECK_THROWS_AS((void)load_vessel(tube_spec(0, 0.1, 100)), Error);
        CHECK_THROWS_AS((void)load_vessel(tube_spec(0.01, -1, 100)), Error);
        CHECK_THROWS_AS((void)load_vessel(tube_spec(0.01, 0.1, -5)), Error);
        // shorter than a facet: as near to square as they are, there would be 6e6 around it, and 9e9 of the second
        for (const double length : {1e-10, 1e-16})
            CHECK_THROWS_WITH_AS((void)load_vessel(tube_spec(0.01, length, 20000)), doctest::Contains("vessel.length_m"), Error);
        CHECK_NOTHROW((void)load_vessel(tube_spec(0.01, 1e-3, 20000)));
        VesselSpec arc = tube_spec(0.01, 0, 1000);
        arc.shape = VesselShape::Arc;
        arc.angle = 1;
        arc.bend_radius = 0.01;  // cuts itself
        CHECK_THROWS_AS((void)load_vessel(arc), Error);
        VesselSpec skew = tube_spec(0.01, 0.1, 100);
        skew.axis = Vec3::Zero();
        CHECK_THROWS_AS((void)load_vessel(skew), Error);
    }
}

}  // namespace seldinger::test::test_shapes
