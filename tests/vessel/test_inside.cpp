// Signed distance and leaving through openings.
#include "mesh_fixtures.h"
#include "repair/repair.h"
#include "vessel/inside.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace seldinger::test::test_inside {

TEST_SUITE("vessel/inside")
{
    TEST_CASE("analytic: signed distance in a tube is R - r to within the facets' sagitta")
    {
        const double radius = 0.01;
        const WallMesh mesh = make_tube(tube_spec(radius, 0.1, 8000)).mesh;
        const RepairReport report = describe(mesh);
        const LumenQuery lumen(mesh, report.loops);
        const auto around = static_cast<double>(
            std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return v.x() == 0; }));
        const double sagitta = radius * (1 - std::cos(std::numbers::pi / around));
        std::mt19937 random(1);
        std::uniform_real_distribution<double> x(0.02, 0.08), r(0, 2 * radius), phi(0, 2 * std::numbers::pi);
        for (int i = 0; i < 1000; ++i) {
            const double distance = r(random), angle = phi(random);
            const LumenPlace place = lumen.locate(Vec3(x(random), distance * std::cos(angle), distance * std::sin(angle)));
            // + 1e-8: vertices are rounded to float32 of 0.05 m once
            CHECK(place.signed_distance <= radius - distance + 1e-8);
            CHECK(place.signed_distance >= radius - distance - sagitta - 1e-8);
            CHECK(place.opening == -1);
        }
    }

    TEST_CASE("property: the sign agrees with the winding number, sharp corners included")
    {
        // a five-pointed prism: convex and concave edges, acute and blunt corners
        WallMesh mesh;
        for (const double z : {0.0, 1.0})
            for (int k = 0; k < 10; ++k) {
                const double phi = std::numbers::pi * k / 5, r = k % 2 == 0 ? 1.0 : 0.35;
                mesh.vertices.emplace_back(r * std::cos(phi), r * std::sin(phi), z);
            }
        mesh.vertices.emplace_back(0, 0, 0);
        mesh.vertices.emplace_back(0, 0, 1);
        for (int k = 0; k < 10; ++k) {
            const int a = k, b = (k + 1) % 10;
            mesh.triangles.insert(mesh.triangles.end(),
                                  {{{a, b, b + 10}}, {{a, b + 10, a + 10}}, {{20, b, a}}, {{21, a + 10, b + 10}}});
        }
        const RepairReport report = repair(mesh);
        REQUIRE(report.boundary_edges == 0);
        const LumenQuery lumen(mesh, report.loops);
        std::mt19937 random(4);
        std::uniform_real_distribution<double> place(-1.2, 1.2);
        int inside = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 p(place(random), place(random), place(random) + 0.5);
            double turns = 0;
            for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
                turns += solid_angle(p, triangle_of(mesh, t)) / (4 * std::numbers::pi);
            const bool in = std::abs(turns) > 0.5;
            inside += in;
            CHECK(lumen.inside(p) == in);
        }
        REQUIRE(inside > 100);
    }

    TEST_CASE("property: a point on an opening is inside; beyond it, it has left there; beside the tube it is outside")
    {
        const WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 4000)).mesh;
        const RepairReport report = describe(mesh);
        const LumenQuery lumen(mesh, report.loops);
        REQUIRE(report.loops.size() == 2);
        const int start = report.loops[0].centre.x() < 0.05 ? 0 : 1;
        for (const double y : {0.0, 0.004, 0.009}) {
            CHECK(lumen.inside(Vec3(0, y, 0)));
            CHECK(lumen.inside(Vec3(1e-4, y, 0)));
            CHECK_FALSE(lumen.inside(Vec3(-1e-4, y, 0)));
            CHECK(lumen.locate(Vec3(-1e-4, y, 0)).opening == start);
            CHECK(lumen.locate(Vec3(0.13, y, 0)).opening == 1 - start);
        }
        const LumenPlace beside = lumen.locate(Vec3(0.05, 0.012, 0));
        CHECK(beside.opening == -1);
        CHECK(beside.signed_distance < 0);
        CHECK_FALSE(beside.inside());
        CHECK(beside.normal.dot(-Vec3::UnitY()) > 0.99);
    }
}

}  // namespace seldinger::test::test_inside
