// Meshes made to crash repair and centreline, to keep them busy, or to make them report lumens that do not exist.
#include "core/error.h"
#include "mesh_fixtures.h"
#include "repair/repair.h"
#include "support/refusal.h"
#include "vessel/extract_centreline.h"
#include "vessel/inside.h"
#include "vessel/medial_graph.h"
#include "vessel/mesh_edges.h"

#include <cmath>
#include <numbers>
#include <random>

namespace seldinger::test::test_hostile_meshes {

namespace {

std::string refusal(WallMesh mesh)
{
    const auto work = [&] {
        const RepairReport report = repair(mesh);
        return extract_centreline(mesh, report.loops, LumenQuery(mesh, report.loops));
    };
    return test::refusal(work, ErrorKind::BadFile);
}

Vec3 anywhere(std::mt19937& rng, double size)
{
    std::uniform_real_distribution<double> place(-size, size);
    const double x = place(rng), y = place(rng);
    return {x, y, place(rng)};
}

WallMesh soup_of(std::size_t vertices, std::size_t triangles)
{
    std::mt19937 rng(5);
    WallMesh mesh;
    for (std::size_t v = 0; v < vertices; ++v) mesh.vertices.push_back(anywhere(rng, 0.01));
    std::uniform_int_distribution<std::int32_t> any(0, static_cast<std::int32_t>(vertices) - 1);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::int32_t a = any(rng), b = any(rng);
        mesh.triangles.push_back({a, b, any(rng)});
    }
    return mesh;
}

}  // namespace

TEST_SUITE("vessel/hostile_meshes")
{
    TEST_CASE("property: a spike is refused by its place; a vessel that is merely long is not")
    {
        const WallMesh tube = make_tube(tube_spec(0.003, 0.03, 1500)).mesh;
        for (const double away : {1.0, 10.0, 400.0, 990.0})
            for (const std::size_t v : {std::size_t{0}, tube.vertices.size() / 2}) {  // on a rim, and beside it
                WallMesh spiked = tube;
                spiked.vertices[v] = {0.01, away, 0};
                CAPTURE(away);
                CHECK(has(refusal(spiked), "take out what lies far away"));
            }
        CHECK(refusal(make_tube(tube_spec(0.003, 3, 20000)).mesh).empty());
    }

    TEST_CASE("property: one corner of a wall moved anywhere: an answer, with paths and spheres inside the wall's box")
    {
        std::mt19937 rng(9);
        const WallMesh tube = make_tube(tube_spec(0.003, 0.03, 600)).mesh;
        for (int k = 0; k < 40; ++k) {
            WallMesh moved = as_soup(tube);
            moved.vertices[rng() % moved.vertices.size()] = anywhere(rng, 0.04);
            const RepairReport report = repair(moved);
            Box3 box;
            for (const Vec3& v : moved.vertices) box.extend(v);
            const LumenQuery lumen(moved, report.loops);
            const Enclosure enclosure(moved, report.loops, lumen);
            const MedialGraph graph = build_medial_graph(moved, find_edges(moved), report.loops, lumen, enclosure);
            for (std::size_t b = 0; b < graph.ball_count(); ++b) {
                CHECK(box.exteriorDistance(graph.centre[b]) <= 1e-9);
                CHECK(std::isfinite(graph.radius[b]));
            }
            const Centreline line = extract_centreline(moved, report.loops, lumen);
            for (const Vec3& p : line.points) CHECK(box.exteriorDistance(p) <= 1e-4);
            CHECK(line.total_length() < 40 * 0.03);
        }
    }

    TEST_CASE("property: where the wall has no direction there is no sphere, and paths end all the same")
    {
        // two tetrahedra that are one another's inside out, joined in all corners: every vertex normal is 0
        WallMesh mesh;
        mesh.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}};
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {0, 2, 3}};
        const LumenQuery lumen(mesh, {});
        for (std::size_t v = 0; v < 4; ++v) CHECK(lumen.vertex_normal(static_cast<std::int32_t>(v)).norm() == 0);
        const MedialGraph graph = build_medial_graph(mesh, find_edges(mesh), {}, lumen, Enclosure(mesh, {}, lumen));
        for (const double radius : graph.radius) CHECK(radius < 1e-9);
        const MedialPaths paths = cheapest_paths(graph, 0);
        for (const double length : paths.length) CHECK_FALSE(std::isnan(length));
        CHECK(std::isfinite(extract_centreline(mesh, {}, lumen).total_length()));
    }

    TEST_CASE("property: costs that are no numbers lead nowhere, and the search ends")
    {
        MedialGraph graph;
        const double nan = std::numeric_limits<double>::quiet_NaN();
        graph.centre = {Vec3(0, 0, 0), Vec3(nan, 0, 0), Vec3(1, 0, 0)};
        graph.radius = {1, std::numeric_limits<double>::infinity(), 1};
        graph.row = {0, 2, 4, 6};
        graph.link_to = {1, 2, 0, 2, 0, 1};
        const MedialPaths paths = cheapest_paths(graph, 0);
        CHECK(paths.length[2] == 1);
        CHECK(paths.towards_root[1] == -1);
    }

    TEST_CASE("property: loose parts one inside the other, and soups, are refused as too tangled instead of waited for")
    {
        WallMesh nested;
        for (int k = 0; k < 5000; ++k) append(nested, sphere(0.01 + 1e-5 * k, Vec3::Zero(), 0));
        CHECK(has(refusal(nested), "too tangled: telling which of its parts lie inside others"));
        CHECK(has(refusal(soup_of(9000, 35000)), "too tangled"));
        CHECK_FALSE(refusal(soup_of(300, 40000)).empty());
    }

    TEST_CASE("property: a fan of thousands of triangles on one edge, and round one vertex, is gone through once")
    {
        constexpr int count = 200000;  // gone through for each of them: 4e10 steps
        WallMesh edge, star;
        edge.vertices = {{0, 0, 0}, {0, 0, 0.01}};
        star.vertices = {{0, 0, 0}};
        for (int k = 0; k < count; ++k) {
            const double angle = 2 * std::numbers::pi * k / count;
            edge.vertices.push_back(0.01 * Vec3(std::cos(angle), std::sin(angle), 0.5));
            edge.triangles.push_back({0, 1, k + 2});
            star.vertices.push_back(0.01 * Vec3(std::cos(angle), std::sin(angle), 0.01 * (k % 2)));
            if (k % 2 == 1) star.triangles.push_back({0, k, k + 1});
        }
        CHECK(has(refusal(edge), "flat patch"));
        CHECK(boundary_chains(star, find_edges(star)).size() == count / 2);
    }

    TEST_CASE("property: a rim of thousands of vertices is one loop, found in one go")
    {
        constexpr std::int32_t count = 300000;  // looked for in the whole walk at each step: 4e10
        WallMesh ring;
        for (std::int32_t k = 0; k < count; ++k) {
            const double angle = 2 * std::numbers::pi * k / count;
            ring.vertices.push_back(0.01 * Vec3(std::cos(angle), std::sin(angle), 0));
            ring.vertices.push_back(0.01 * Vec3(std::cos(angle), std::sin(angle), 1));
        }
        for (std::int32_t k = 0; k < count; ++k) {
            const std::int32_t a = 2 * k, b = 2 * ((k + 1) % count);
            ring.triangles.push_back({a, b, a + 1});
            ring.triangles.push_back({b, b + 1, a + 1});
        }
        const auto chains = boundary_chains(ring, find_edges(ring));
        REQUIRE(chains.size() == 2);
        CHECK(chains[0].size() == count);
        CHECK(chains[1].size() == count);
    }

    TEST_CASE("property: a flap that comes off a triangle at a time is refused when it is thousands long")
    {
        // a tube of four sides, and on one row of its edges a fan to a point in the lumen: each end has one loose triangle
        constexpr std::int32_t sides = 4, rings = 5000;
        WallMesh mesh;
        for (std::int32_t i = 0; i < rings; ++i)
            for (std::int32_t k = 0; k < sides; ++k)
                mesh.vertices.emplace_back(1e-4 * i, 0.003 * std::cos(1.5708 * k), 0.003 * std::sin(1.5708 * k));
        for (std::int32_t i = 0; i + 1 < rings; ++i)
            for (std::int32_t k = 0; k < sides; ++k) {
                const std::int32_t u = i * sides + k, v = i * sides + (k + 1) % sides;
                mesh.triangles.push_back({u, v, u + sides});
                mesh.triangles.push_back({v, v + sides, u + sides});
            }
        const auto middle = static_cast<std::int32_t>(mesh.vertices.size());
        mesh.vertices.emplace_back(0.5e-4 * rings, 1e-4, 2e-4);
        for (std::int32_t i = 2; i + 3 < rings; ++i) mesh.triangles.push_back({i * sides, (i + 1) * sides, middle});
        CHECK(has(refusal(mesh), "too tangled: taking off flaps"));
    }

    TEST_CASE("property: hundreds of the largest holes that are filled are refused")
    {
        WallMesh plates;
        constexpr int corners = 200;
        for (int p = 0; p < 200; ++p) {
            const auto first = static_cast<std::int32_t>(plates.vertices.size());
            for (int ring = 0; ring < 2; ++ring)
                for (int k = 0; k < corners; ++k) {
                    const double angle = 2 * std::numbers::pi * k / corners, r = ring == 0 ? 0.9e-3 : 4e-3;
                    plates.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.02 * p);
                }
            const std::int32_t tip = static_cast<std::int32_t>(plates.vertices.size());
            plates.vertices.emplace_back(0, 0, 0.02 * p + 0.012);
            for (std::int32_t k = 0; k < corners; ++k) {
                const std::int32_t a = first + k, b = first + (k + 1) % corners;
                plates.triangles.push_back({a, b, a + corners});
                plates.triangles.push_back({b, b + corners, a + corners});
                plates.triangles.push_back({a + corners, b + corners, tip});
            }
        }
        CHECK(has(refusal(plates), "too tangled: filling its holes"));
    }
}

}  // namespace seldinger::test::test_hostile_meshes
