// The surface of a label against the bodies that were voxelised: radius, axis, ends, parts, bits.
#include "core/parallel.h"
#include "repair/repair.h"
#include "voxels/voxels.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>

namespace seldinger::test::test_voxel_surface {

namespace {

using Body = std::function<bool(const Vec3&)>;  // of places in the grid's unit

std::vector<VoxelRun> runs_of(const VoxelGrid& grid, const Body& body)
{
    std::vector<VoxelRun> runs;
    for (std::int32_t row = 0; row < grid.size[1] * grid.size[2]; ++row)
        for (std::int32_t x = 0; x < grid.size[0]; ++x)
            if (body(grid.at(Vec3(x, row % grid.size[1], row / grid.size[1])))) {
                if (!runs.empty() && runs.back().row == row && runs.back().end == x) ++runs.back().end;
                else runs.push_back({row, x, x + 1, 1});
            }
    return runs;
}

/// Distance from the segment a b.
double from_segment(const Vec3& p, const Vec3& a, const Vec3& b)
{
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm();
}

VoxelGrid cube(int n)
{
    VoxelGrid grid;
    grid.size = {n, n, n};
    return grid;
}

struct Tube {
    double radius = 0, axis = 0, inward = 0;  // mean over the facets; mean position off the axis; share of the area that faces in
};

/// Facets within 15 of c along the axis.
Tube measure(const WallMesh& mesh, const Vec3& c, const Vec3& d)
{
    double area = 0, radius = 0, in = 0;
    Vec3 off = Vec3::Zero();
    for (const auto& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k % 3])]; };
        const auto from_axis = [&](const Vec3& p) { return Vec3(p - c - d.dot(p - c) * d); };
        const Vec3 middle = (corner(0) + corner(1) + corner(2)) / 3,
                   normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        if (std::abs(d.dot(middle - c)) > 15) continue;
        const double a = 0.5 * normal.norm();
        area += a;
        off += a * from_axis(middle);
        for (std::size_t k = 0; k < 3; ++k) radius += a / 3 * from_axis(0.5 * (corner(k) + corner(k + 1))).norm();
        in += normal.dot(from_axis(middle)) < 0 ? a : 0;
    }
    return {radius / area, off.norm() / area, in / area};
}

/// Openings of the repaired surface.
std::size_t openings(const VoxelGrid& grid, const LumenVoxels& lumen)
{
    WallMesh mesh = surface_of(grid, lumen, {});
    for (Vec3& p : mesh.vertices) p *= 1e-3;
    const RepairReport report = repair(mesh);
    CHECK_FALSE(report.inverted);
    CHECK(report.flipped == 0);
    CHECK(report.components == 1);
    CHECK(report.non_manifold_edges == 0);
    CHECK(report.slivers <= report.triangles / 1000);
    return report.loops.size();
}

}  // namespace

TEST_SUITE("voxels/voxel_surface") {
    // Bounds for one tube are what is promised. A label is rounded itself: along a row or a diagonal of voxels all sections are
    // alike, and their area, which is all that is known, is off by more. Means of eight places have to be nearer: no bias.
    TEST_CASE("analytic: a tube's radius is right to 5, 3 and 1 % for 2, 3 and 5 voxels, its axis to a fifth of a voxel")
    {
        const double s = std::sin(0.5236), c = std::cos(0.5236);
        const std::pair<Vec3, std::string> directions[] = {{Vec3(s, -s * c, c * c), "30 degrees about two axes"},
                                                           {Vec3(1, 0.8, 0.55).normalized(), "far from any axis"},
                                                           {Vec3(0.3, 0.1, 1).normalized(), "19 degrees"},
                                                           {Vec3(0.07, 0.05, 1).normalized(), "5 degrees"}};
        std::mt19937 random(7);
        std::uniform_real_distribution<double> shift(-0.5, 0.5);
        for (const auto& [radius, bound, bias] :
             {std::tuple{2.0, 0.05, 0.015}, {3.0, 0.03, 0.008}, {5.0, 0.01, 0.004}, {12.0, 0.005, 0.001}})
            for (const auto& [d, name] : directions) {
                CAPTURE(radius);
                CAPTURE(name);
                const VoxelGrid grid = cube(radius > 10 ? 70 : 56);
                double mean = 0;
                constexpr int places = 8;
                for (int k = 0; k < places; ++k) {
                    const Vec3 at = Vec3::Constant(0.5 * grid.size[0]) + Vec3(shift(random), shift(random), shift(random));
                    const std::vector<VoxelRun> runs =
                        runs_of(grid, [&](const Vec3& p) { return from_segment(p, at - 99 * d, at + 99 * d) < radius; });
                    const Tube tube = measure(surface_of(grid, lumen_of(grid, runs), {}), at, d);
                    CHECK(std::abs(tube.radius / radius - 1) < bound);
                    CHECK(tube.axis < 0.2);
                    CHECK(tube.inward > 0.999);
                    mean += (tube.radius / radius - 1) / places;
                }
                CHECK(std::abs(mean) < bias);
            }
    }

    TEST_CASE("analytic: a surface at a fraction of 0.5 lies where linear interpolation puts it")
    {
        const Vec3 d = Vec3(0.4, 0.3, 1).normalized(), at(20.3, 19.8, 20.1);
        const VoxelGrid grid = cube(40);
        const Body body = [&](const Vec3& p) { return from_segment(p, at - 99 * d, at + 99 * d) <= 3; };
        std::vector<float> fraction;
        for (int row = 0; row < 1600; ++row)
            for (int x = 0; x < 40; ++x)
                fraction.push_back(static_cast<float>(std::clamp(
                    0.5 + 0.25 * (3 - from_segment(Vec3(x, row % 40, row / 40), at - 99 * d, at + 99 * d)), 0.0, 1.0)));
        const Tube tube = measure(surface_of(grid, lumen_of(grid, runs_of(grid, body)), fraction), at, d);
        CHECK(std::abs(tube.radius / 3 - 1) < 0.005);  // an eighth of the bend over an edge: (1/8) (1/3) 1^2 of 3
        CHECK(tube.axis < 0.01);
    }

    TEST_CASE("property: a left-handed grid has the mirrored surface, which faces in")
    {
        VoxelGrid grid = cube(40);
        grid.step = Mat3::columns({-0.5, 0, 0}, {0, 0.5, 0.1}, {0, 0, 1.5});  // sheared, too
        grid.origin = {30, -4, 100};
        const Vec3 at = grid.at({20, 20, 20}), d = Vec3(0.1, 0.3, 1).normalized();
        const auto runs = runs_of(grid, [&](const Vec3& p) { return from_segment(p, at - 99 * d, at + 99 * d) < 4.5; });
        const Tube tube = measure(surface_of(grid, lumen_of(grid, runs), {}), at, d);
        CHECK(std::abs(tube.radius / 4.5 - 1) < 0.01);
        CHECK(tube.axis < 0.1);
        CHECK(tube.inward > 0.999);
    }

    TEST_CASE("property: the same bits for one thread and for three")
    {
        const VoxelGrid grid = cube(60);
        const LumenVoxels lumen = lumen_of(grid, runs_of(grid, [](const Vec3& p) {
                                               return from_segment(p, {9, 9, 9}, {50, 44, 90}) < 12;
                                           }));
        set_thread_count(1);
        const WallMesh one = surface_of(grid, lumen, {});
        set_thread_count(3);
        const WallMesh three = surface_of(grid, lumen, {});
        set_thread_count(0);
        REQUIRE(one.vertices.size() > 4096);  // more than one piece
        CHECK(one.vertices == three.vertices);
        CHECK(one.triangles == three.triangles);
    }

    TEST_CASE("property: flat ends and ends on the image's border are open, round ones are not")
    {
        const VoxelGrid grid = cube(64);
        const Vec3 a(30.2, 31.4, 20.3), b(33.1, 29.7, 50.4), d = (b - a).normalized();
        for (const double radius : {2.6, 3.0, 4.3, 6.0, 9.0}) {
            CAPTURE(radius);
            const Body round = [&](const Vec3& p) { return from_segment(p, a, b) < radius; };
            const Body cut = [&](const Vec3& p) {
                return from_segment(p, a - 9 * d, b + 9 * d) < radius && p.z() > 19 && p.z() < 45;
            };
            const Body through = [&](const Vec3& p) { return from_segment(p, a - 99 * d, b) < radius; };
            CHECK(openings(grid, lumen_of(grid, runs_of(grid, round))) == 0);
            const LumenVoxels flat = lumen_of(grid, runs_of(grid, cut)), border = lumen_of(grid, runs_of(grid, through));
            CHECK(openings(grid, flat) == 2);
            CHECK(openings(grid, border) == 1);
            REQUIRE(flat.notes.size() == 1);
            CHECK(flat.notes[0].starts_with("Openings where the label ends flat (caps were cut out), 2: ["));
            REQUIRE(border.notes.size() == 1);
            CHECK(border.notes[0].starts_with("Openings where the lumen leaves the image, 1: ["));
        }
    }

    TEST_CASE("property: an arch of 3 voxels' radius keeps its ends, and its top is no flat end")
    {
        const VoxelGrid grid = cube(64);
        const auto runs = runs_of(grid, [](const Vec3& p) {
            const double out = std::hypot(p.x() - 31.3, p.z() - 30.6) - 18;
            return p.z() > 30.6 && std::hypot(out, p.y() - 31.8) < 3;
        });
        CHECK(openings(grid, lumen_of(grid, runs)) == 2);
    }

    TEST_CASE("property: the largest part is the vessel; what is left out, touches or is hollow is named with volume and place")
    {
        const VoxelGrid grid = cube(40);
        const auto in = [](const Vec3& p, const Vec3& low, const Vec3& high) {
            return (p - low).minCoeff() >= 0 && (high - p).minCoeff() >= 0;
        };
        const LumenVoxels lumen =
            lumen_of(grid, runs_of(grid, [&](const Vec3& p) {
                         return (in(p, {4, 4, 4}, {11, 11, 33}) &&
                                 !in(p, {7, 7, 20}, {7, 8, 20})) ||  // the vessel with a cavity of two voxels
                                in(p, {12, 12, 4}, {15, 15, 20}) ||  // meets it in an edge
                                in(p, {30, 30, 30}, {31, 33, 34});   // an island
                     }));
        REQUIRE(lumen.notes.size() == 4);
        CHECK(lumen.notes[0] ==
              "The largest part, 1.92 ml, is the vessel; 1 part not joined to it was left out: 0.04 ml at [30.5, 31.5, 32] mm.");
        CHECK(lumen.notes[1].find(
                  "1 part only touches the vessel (1.92 ml) at edges or corners of voxels and was left out: 0.272 ml at "
                  "[13.5, 13.5, 12] mm.") == 0);
        CHECK(lumen.notes[2] == "1 cavity within the label was filled: 0.002 ml at [7, 7.5, 20] mm.");
        CHECK(lumen.notes[3].starts_with("Openings where the label ends flat"));
        CHECK(openings(grid, lumen) == 2);
    }
}

}  // namespace seldinger::test::test_voxel_surface
