// Loop subdivision: limits, counts, and the invariants of a tube.

#include "repair/repair.h"
#include "shapes/shapes.h"
#include "shapes/subdivide.h"
#include "support/approx.h"
#include "vessel/mesh_edges.h"
#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_subdivide {

namespace {

WallMesh tube_mesh(int triangles)
{
    VesselSpec spec{.shape = VesselShape::Tube, .radius = 0.01, .length = 0.05, .triangles = triangles};
    return make_tube(spec).mesh;
}

Vec3 normal_of(const WallMesh& mesh, std::size_t t)
{
    const auto& [a, b, c] = mesh.triangles[t];
    return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
}

/// Largest angle between the normals of neighbours [rad].
double sharpest(const WallMesh& mesh)
{
    const MeshEdges edges = find_edges(mesh);
    double most = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() == 2)
            most = std::max(most, std::acos(std::min(1.0, normal_of(mesh, uses[0] / 3).dot(normal_of(mesh, uses[1] / 3)))));
    }
    return most;
}

}  // namespace

TEST_SUITE("shapes/subdivide")
{
    TEST_CASE("property: four triangles of each, the same topology and orientation, openings in their planes")
    {
        const WallMesh coarse = tube_mesh(600), fine = subdivide_loop(coarse);
        CHECK(fine.triangles.size() == 4 * coarse.triangles.size());
        const auto euler = [](const WallMesh& m) {
            return static_cast<long>(m.vertices.size()) - static_cast<long>(find_edges(m).count()) +
                   static_cast<long>(m.triangles.size());
        };
        CHECK(euler(fine) == euler(coarse));
        const auto before = describe(coarse), after = describe(fine);
        REQUIRE(before.loops.size() == 2);
        REQUIRE(after.loops.size() == 2);
        CHECK(after.non_manifold_edges == 0);
        for (const BoundaryLoop& loop : after.loops) {
            const auto same = std::find_if(before.loops.begin(), before.loops.end(),
                                           [&](const BoundaryLoop& l) { return (l.centre - loop.centre).norm() < 1e-4; });
            REQUIRE(same != before.loops.end());
            CHECK(loop.inward.dot(same->inward) > 0.999);
            for (const std::int32_t v : loop.vertices)
                CHECK(std::abs((fine.vertices[v] - same->centre).dot(same->inward)) < 1e-12);
        }
        for (std::size_t t = 0; t < fine.triangles.size(); ++t) REQUIRE(normal_of(fine, t).dot(normal_of(coarse, t / 4)) > 0.9);
    }

    // The scheme is a fixed weighting of neighbours: it commutes with affine maps, and leaves a plane a plane.
    TEST_CASE("property: affine maps before or after give the same surface")
    {
        WallMesh coarse = tube_mesh(600);
        const WallMesh fine = subdivide_loop(coarse);
        const Mat3 map = Mat3::rows({1, 0.3, 0}, {0, 0.5, 0.2}, {0.1, 0, 2});
        const Vec3 shift(0.1, -0.2, 0.3);
        for (Vec3& v : coarse.vertices) v = map * v + shift;
        const WallMesh mapped = subdivide_loop(coarse);
        double worst = 0;
        for (std::size_t v = 0; v < fine.vertices.size(); ++v)
            worst = std::max(worst, (mapped.vertices[v] - (map * fine.vertices[v] + shift)).norm());
        CHECK(worst < 1e-15);  // rounding of numbers of size 0.4
    }

    // A quadratic is what Loop's box spline reproduces where every vertex has six neighbours (a lattice of equilateral triangles)
    // up to a constant: its second differences, and so a smooth surface's curvature, survive. Angles between neighbours therefore
    // halve with the edges.
    TEST_CASE("property: angles between neighbours halve: the new triangles are not in the planes of the old")
    {
        WallMesh mesh = tube_mesh(2000);
        double angle = sharpest(mesh);
        for (int round = 0; round < 3; ++round) {
            mesh = subdivide_loop(mesh);
            const double now = sharpest(mesh);
            CHECK(now < 0.62 * angle);
            CHECK(now > 0.4 * angle);
            angle = now;
        }
    }

    // Loop's limit: a vertex of valence n with neighbours on a regular ring round it at height 0 and itself at height 1 goes to
    // (1 - n w) in one round.
    TEST_CASE("analytic: weights of an inner vertex, of a rim vertex and of an edge")
    {
        for (const int n : {3, 4, 6, 9}) {
            WallMesh fan;
            fan.vertices.push_back(Vec3(0, 0, 1));
            for (int k = 0; k < n; ++k) fan.vertices.push_back(Vec3(std::cos(2 * M_PI * k / n), std::sin(2 * M_PI * k / n), 0));
            for (int k = 0; k < n; ++k) fan.triangles.push_back({0, 1 + k, 1 + (k + 1) % n});
            const WallMesh fine = subdivide_loop(fan);
            const double c = 3.0 / 8 + std::cos(2 * M_PI / n) / 4, w = (5.0 / 8 - c * c) / n;
            CHECK(fine.vertices[0].z() == test::about(1 - n * w).epsilon(1e-14));
            // a rim's vertex: three quarters itself, an eighth of each neighbour on the rim; the centre has no say
            CHECK(fine.vertices[1].z() == 0);
            CHECK(fine.vertices[1].x() == test::about(0.75 + 0.25 * std::cos(2 * M_PI / n)).epsilon(1e-14));
            // an edge from the centre: three eighths of its ends, an eighth of the two corners beside it
            int spokes = 0;
            for (std::size_t v = fan.vertices.size(); v < fine.vertices.size(); ++v)
                spokes += std::abs(fine.vertices[v].z() - 3.0 / 8) < 1e-14;
            CHECK(spokes == n);
        }
    }
}

}  // namespace seldinger::test::test_subdivide
