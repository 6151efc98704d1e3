// Repair: each kind of damage on its own, then all at once.
#include "core/error.h"
#include "mesh_fixtures.h"
#include "repair/repair.h"
#include "support/approx.h"
#include "support/refusal.h"

#include <algorithm>
#include <limits>

namespace seldinger::test::test_repair {

TEST_SUITE("repair/repair")
{
    TEST_CASE("property: a sound tube as a soup comes back whole, welded and facing inwards")
    {
        const WallMesh tube = make_tube(tube_spec(0.01, 0.1, 3000)).mesh;
        WallMesh soup = as_soup(tube);
        for (Vec3& v : soup.vertices)
            v = Vec3(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())) +
                Vec3(1, 1, 1);  // what an STL stores
        const RepairReport report = repair(soup);
        CHECK(report.triangles == static_cast<long>(tube.triangles.size()));
        CHECK(report.vertices == static_cast<long>(tube.vertices.size()));
        CHECK(report.vertices_welded == static_cast<long>(3 * tube.triangles.size() - tube.vertices.size()));
        CHECK(report.loops.size() == 2);
        CHECK(report.flipped == 0);
        CHECK_FALSE(report.inverted);
        CHECK(report.degenerate_dropped == 0);
    }

    TEST_CASE("property: printed with six digits it still welds")
    {
        const WallMesh tube = make_tube(tube_spec(0.01, 0.1, 3000)).mesh;
        WallMesh soup = as_soup(tube);
        std::size_t k = 0;
        for (Vec3& v : soup.vertices)  // the sixth digit of 0.1 m, differently in each copy
            for (int d = 0; d < 3; ++d) v[d] += (++k % 3 == 0 ? 4e-8 : k % 3 == 1 ? -4e-8 : 0.0);
        CHECK(repair(soup).vertices == static_cast<long>(tube.vertices.size()));
    }

    TEST_CASE("property: every tenth triangle flipped, and all of them outwards")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 3000)).mesh;
        long flips = 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 10) {
            flip(mesh, t);
            ++flips;
        }
        WallMesh outward = mesh;
        for (std::size_t t = 0; t < outward.triangles.size(); ++t) flip(outward, t);
        const RepairReport a = repair(mesh), b = repair(outward);
        CHECK(a.flipped == flips);
        CHECK_FALSE(a.inverted);
        CHECK(b.flipped == flips);
        CHECK(b.inverted);
        CHECK(facing_out_of_x_tube(mesh) == 0);
        CHECK(facing_out_of_x_tube(outward) == 0);
    }

    TEST_CASE("property: duplicates, in either orientation, go")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 3000)).mesh;
        const std::size_t before = mesh.triangles.size();
        for (std::size_t t = 0; t < 40; ++t) mesh.triangles.push_back(mesh.triangles[7 * t]);
        for (std::size_t t = 0; t < 40; ++t) {
            mesh.triangles.push_back(mesh.triangles[11 * t + 600]);
            flip(mesh, mesh.triangles.size() - 1);
        }
        const RepairReport report = repair(mesh);
        CHECK(report.duplicates_dropped == 80);
        CHECK(mesh.triangles.size() == before);
        CHECK(report.non_manifold_edges == 0);
        CHECK(report.loops.size() == 2);
        CHECK(facing_out_of_x_tube(mesh) == 0);
    }

    TEST_CASE("property: a fold - two triangles face to face on a closed wall - goes without leaving a hole")
    {
        WallMesh mesh = sphere(0.01, Vec3::Zero(), 3);
        {
            WallMesh welded = mesh;
            (void)repair(welded);
            mesh = welded;
        }
        const std::size_t before = mesh.triangles.size();
        // a vertex over an edge's neighbour: the pair hangs on three existing vertices that form no triangle of the wall
        const auto t = mesh.triangles[0];
        std::int32_t across = -1;
        for (const auto& n : mesh.triangles) {
            int shared = 0;
            std::int32_t other = -1;
            for (const std::int32_t v : n) (v == t[0] || v == t[1] || v == t[2]) ? ++shared : (other = v);
            const bool has_third = std::find(n.begin(), n.end(), t[2]) != n.end();
            if (shared == 2 && has_third) {
                across = other;
                break;
            }
        }
        REQUIRE(across >= 0);
        mesh.triangles.push_back({t[0], t[1], across});
        mesh.triangles.push_back({t[1], t[0], across});
        const RepairReport report = repair(mesh);
        CHECK(report.duplicates_dropped == 2);
        CHECK(mesh.triangles.size() == before);
        CHECK(report.boundary_edges == 0);
        CHECK(report.non_manifold_edges == 0);
    }

    TEST_CASE("property: small holes close, the tube's ends stay open")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 6000)).mesh;
        const std::size_t before = mesh.triangles.size();
        // one lone triangle, and a patch of every triangle within 2.5 mm of a point of the wall
        const Vec3 patch = Vec3(0.05, 0.01, 0);
        long patch_size = 0;
        const auto lone = mesh.triangles[200];
        std::erase_if(mesh.triangles, [&](const auto& t) {
            if (t == lone) return true;
            const bool in = (mesh.vertices[static_cast<std::size_t>(t[0])] - patch).norm() < 0.0025;
            patch_size += in;
            return in;
        });
        REQUIRE(patch_size > 10);
        WallMesh open = mesh;
        const RepairReport report = repair(mesh);
        CHECK(report.hole_loops_closed == 2);
        const std::string note = report.notes.front();  // which, by which rule, and what leaves them open
        CHECK(note.starts_with("2 small holes were closed: at ["));
        CHECK(has(note, "at [0.05"));
        CHECK(has(note, "(at most 4 edges)"));
        CHECK(has(note, "(flat in the wall, below half of the lumen's radius)"));
        CHECK(note.ends_with(". vessel.close_holes = false leaves them open."));
        const RepairReport left = repair(open, false);
        CHECK(left.loops.size() == 4);
        CHECK(left.hole_loops_closed == 0);
        CHECK(open.triangles.size() < mesh.triangles.size());
        CHECK(report.loops.size() == 2);
        CHECK(report.non_manifold_edges == 0);
        CHECK(mesh.triangles.size() <= before);
        CHECK(facing_out_of_x_tube(mesh) == 0);
        for (const BoundaryLoop& loop : report.loops) CHECK(loop.radius == about(0.01).epsilon(1e-9));
    }

    TEST_CASE("property: what is not a number goes, with its hole")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 6000)).mesh;
        WallMesh soup = as_soup(mesh);
        soup.vertices[3 * 500].x() = std::numeric_limits<double>::quiet_NaN();
        soup.vertices[3 * 900 + 1].y() = std::numeric_limits<double>::infinity();
        const RepairReport report = repair(soup);
        CHECK(report.non_finite_dropped == 2);
        CHECK(report.hole_loops_closed == 2);
        CHECK(report.loops.size() == 2);
        CHECK(report.triangles == static_cast<long>(mesh.triangles.size()));
        CHECK(std::all_of(soup.vertices.begin(), soup.vertices.end(), [](const Vec3& v) { return v.allFinite(); }));
    }

    TEST_CASE("property: a T-junction - an edge on one side, two on the other - closes without a flat triangle")
    {
        // cut one triangle's edge in two without telling its neighbour
        WallMesh mesh = sphere(0.01, Vec3::Zero(), 3);
        (void)repair(mesh);
        const auto t = mesh.triangles[5];
        const auto middle = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.push_back(0.5 *
                                (mesh.vertices[static_cast<std::size_t>(t[0])] + mesh.vertices[static_cast<std::size_t>(t[1])]));
        mesh.triangles[5] = {t[0], middle, t[2]};
        mesh.triangles.push_back({middle, t[1], t[2]});
        const RepairReport report = repair(mesh);
        CHECK(report.boundary_edges == 0);
        CHECK(report.non_manifold_edges == 0);
        double least = 1;
        for (std::size_t k = 0; k < mesh.triangles.size(); ++k) least = std::min(least, triangle_quality(triangle_of(mesh, k)));
        CHECK(least > 0.1);
    }

    TEST_CASE("property: two vessels side by side, one read inside out, both face their own lumen")
    {
        const Vec3 left(-0.03, 0, 0), right(0.03, 0, 0);
        WallMesh mesh = sphere(0.01, left, 3), other = sphere(0.01, right, 3);
        for (std::size_t t = 0; t < other.triangles.size(); ++t) flip(other, t);
        append(mesh, other);
        const RepairReport report = repair(mesh);
        CHECK(report.components == 2);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle3 tri = triangle_of(mesh, t);
            const Vec3 centroid = (tri.a + tri.b + tri.c) / 3;
            REQUIRE(double_area(tri).dot((centroid.x() < 0 ? left : right) - centroid) > 0);
        }
    }

    TEST_CASE("property: a body inside a lumen is an obstacle: its wall faces away from it")
    {
        WallMesh mesh = sphere(0.02, Vec3::Zero(), 3);
        append(mesh, sphere(0.004, Vec3(0.005, 0, 0), 2));
        (void)repair(mesh);
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle3 tri = triangle_of(mesh, t);
            const Vec3 centroid = (tri.a + tri.b + tri.c) / 3;
            if (centroid.norm() > 0.015) REQUIRE(double_area(tri).dot(-centroid) > 0);
            else REQUIRE(double_area(tri).dot(centroid - Vec3(0.005, 0, 0)) > 0);
        }
    }

    TEST_CASE("property: what bounds no lumen is refused, with the reason")
    {
        const auto refused = [](WallMesh mesh) { return !refusal([&] { return repair(mesh); }, ErrorKind::BadFile).empty(); };
        WallMesh one;
        one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        one.triangles = {{0, 1, 2}};
        CHECK(refused(one));
        CHECK(refused(WallMesh{}));
        VesselSpec plane{.size = 1, .triangles = 100};
        CHECK(refused(make_plane(plane).mesh));
        WallMesh nan = make_tube(tube_spec(0.01, 0.1, 500)).mesh;
        for (Vec3& v : nan.vertices) v = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
        CHECK(refused(nan));
        WallMesh point = make_tube(tube_spec(0.01, 0.1, 500)).mesh;
        for (Vec3& v : point.vertices) v.setZero();
        CHECK(refused(point));
    }

    TEST_CASE("property: repairing a repaired mesh changes nothing")
    {
        WallMesh mesh = as_soup(make_tube(tube_spec(0.01, 0.1, 3000)).mesh);
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 7) flip(mesh, t);
        mesh.triangles.erase(mesh.triangles.begin() + 1000);
        mesh.triangles.push_back(mesh.triangles[3]);
        (void)repair(mesh);
        WallMesh again = mesh;
        const RepairReport report = repair(again);
        CHECK(again.triangles == mesh.triangles);
        CHECK(report.vertices_welded + report.degenerate_dropped + report.duplicates_dropped + report.flipped +
                  report.hole_loops_closed ==
              0);
    }
}

}  // namespace seldinger::test::test_repair
