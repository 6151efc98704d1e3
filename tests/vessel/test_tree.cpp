// The wall's tree against brute force, and its promises about depth, boxes and determinism.
#include "mesh_fixtures.h"
#include "vessel/tree.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <numbers>
#include <random>

namespace test_tree {

using namespace seldinger;
using namespace seldinger::test;

namespace {

double nearest_by_force(const WallTree& tree, const Vec3& p)
{
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < tree.triangle_count(); ++k) {
        const Vec3 local = p - tree.centre;
        best = std::min(best, (local - closest_point(local, tree.triangle(k)).point).squaredNorm());
    }
    return best;
}

/// Every leaf triangle lies in all boxes above it; every triangle is in one leaf; depth and leaf size are kept.
void check_structure(const WallTree& tree)
{
    struct Visit {
        std::uint32_t node;
        int depth;
    };
    std::vector<Visit> stack = {{0, 0}};
    std::vector<int> seen(tree.triangle_count(), 0);
    std::size_t visited = 0;
    int deepest = 0;
    bool inside = true, ordered = true, small = true;
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        ++visited;
        deepest = std::max(deepest, visit.depth);
        const TreeNode& node = tree.nodes[visit.node];
        if (node.count == 0) {
            for (std::uint32_t c = 0; c < 2; ++c) {
                const std::uint32_t child = node.left_or_first + c;
                ordered &= child > visit.node;
                for (int d = 0; d < 3; ++d)
                    inside &= tree.nodes[child].lo[d] >= node.lo[d] && tree.nodes[child].hi[d] <= node.hi[d];
                stack.push_back({child, visit.depth + 1});
            }
            continue;
        }
        small &= SEL_LEAF_TRIANGLES(node.count) <= SEL_TREE_LEAF;
        for (std::uint32_t k = node.left_or_first; k < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++k) {
            ++seen[k];
            for (std::size_t i = 0; i < 9; ++i)
                inside &= tree.vertices[9 * k + i] >= node.lo[i % 3] && tree.vertices[9 * k + i] <= node.hi[i % 3];
        }
    }
    CHECK(inside);
    CHECK(ordered);
    CHECK(small);
    CHECK(visited == tree.nodes.size());
    CHECK(deepest == tree.depth);
    CHECK(tree.depth < SEL_TREE_STACK);
    CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    std::vector<std::uint32_t> ids = tree.original;
    std::sort(ids.begin(), ids.end());
    bool all = true;
    for (std::size_t i = 0; i < ids.size(); ++i) all &= ids[i] == i;
    CHECK(all);
}

WallMesh random_soup(std::size_t count, double size, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1, 1);
    WallMesh mesh;
    for (std::size_t t = 0; t < count; ++t) {
        const Vec3 at(place(random), place(random), place(random));
        for (int c = 0; c < 3; ++c) mesh.vertices.push_back(at + size * Vec3(place(random), place(random), place(random)));
        const auto first = static_cast<std::int32_t>(3 * t);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

}  // namespace

TEST_SUITE("vessel/tree")
{
    TEST_CASE("property: nearest point equals brute force, a metre from the origin too")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 2000)).mesh;
        append(mesh, random_soup(300, 0.005, 3));
        for (Vec3& v : mesh.vertices) v += Vec3(1, -2, 0.5);
        const WallTree tree = build_wall_tree(mesh);
        check_structure(tree);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(-0.05, 0.15);
        for (int i = 0; i < 500; ++i) {
            const Vec3 p = Vec3(1, -2, 0.5) + Vec3(place(random), 0.3 * place(random), 0.3 * place(random));
            const TreeHit hit = nearest_on_wall(tree, p);
            REQUIRE(hit.triangle >= 0);
            // the same arithmetic on the same triangles: equal to the bit
            CHECK(hit.distance2 == nearest_by_force(tree, p));
            CHECK((hit.point - p).norm() == doctest::Approx(std::sqrt(hit.distance2)).epsilon(1e-9));
        }
    }

    TEST_CASE("property: planes over nodes and a guess save visits and change no answer")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 20000)).mesh;
        append(mesh, random_soup(300, 0.005, 3));
        for (Vec3& v : mesh.vertices) v += Vec3(1, -2, 0.5);
        const WallTree plain = build_wall_tree(mesh);
        WallTree tree = plain;
        add_slabs(tree);
        REQUIRE(tree.slabs.size() == tree.nodes.size());
        // no vertex reaches over the plane of a leaf that holds it
        bool below = true;
        for (std::size_t i = 0; i < tree.nodes.size(); ++i)
            for (std::size_t k = 9 * tree.nodes[i].left_or_first; k < 9 * (tree.nodes[i].left_or_first + SEL_LEAF_TRIANGLES(tree.nodes[i].count)); k += 3) {
                const TreeSlab& s = tree.slabs[i];
                below &= double(s.normal[0]) * tree.vertices[k] + double(s.normal[1]) * tree.vertices[k + 1] +
                             double(s.normal[2]) * tree.vertices[k + 2] <= s.highest;
            }
        CHECK(below);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(-0.05, 0.15), small(-1e-4, 1e-4);
        std::uint64_t visits = 0, visits_before = 0;
        for (int i = 0; i < 300; ++i) {
            // every other one near the tube's axis, where all of the wall round it is equally near
            const Vec3 p = Vec3(1, -2, 0.5) + (i % 2 ? Vec3(place(random), small(random), small(random))
                                                     : Vec3(place(random), 0.3 * place(random), 0.3 * place(random)));
            const TreeHit before = nearest_on_wall(plain, p, std::numeric_limits<double>::infinity(), &visits_before);
            const auto guess = static_cast<std::int64_t>(random() % tree.triangle_count());
            for (const std::int64_t first : {std::int64_t{-1}, guess, before.triangle}) {
                const TreeHit hit = nearest_on_wall(tree, p, std::numeric_limits<double>::infinity(), first < 0 ? &visits : nullptr, first);
                CHECK(hit.distance2 == before.distance2);
                CHECK(hit.triangle == before.triangle);
                CHECK(hit.point == before.point);
                CHECK(hit.feature == before.feature);
            }
        }
        CHECK(visits < visits_before / 2);
    }

    TEST_CASE("property: a limit hides what is farther and nothing else")
    {
        const WallTree tree = build_wall_tree(make_tube(tube_spec(0.01, 0.1, 2000)).mesh);
        const Vec3 p(0.05, 0, 0.004);
        const double distance = std::sqrt(nearest_on_wall(tree, p).distance2);
        CHECK(nearest_on_wall(tree, p, 1.001 * distance).triangle >= 0);
        CHECK(nearest_on_wall(tree, p, 0.999 * distance).triangle == -1);
    }

    TEST_CASE("property: overlapping triangles are a superset of those that touch the box")
    {
        const WallMesh mesh = random_soup(2000, 0.05, 11);
        const WallTree tree = build_wall_tree(mesh);
        std::mt19937 random(5);
        std::uniform_real_distribution<double> place(-1, 1);
        std::vector<std::uint32_t> found;
        std::size_t touched = 0;
        for (int i = 0; i < 100; ++i) {
            const Vec3 lo(place(random), place(random), place(random)), hi = lo + Vec3(0.2, 0.1, 0.3);
            overlapping_triangles(tree, lo, hi, found);
            CHECK(std::is_sorted(found.begin(), found.end()));
            for (std::uint32_t k = 0; k < tree.triangle_count(); ++k) {
                Box3 box;
                const Triangle3 t = tree.triangle(k);
                for (const Vec3& v : {t.a, t.b, t.c}) box.extend(v + tree.centre);
                if (box.min().cwiseMax(lo) != box.min().cwiseMax(lo).cwiseMin(box.max().cwiseMin(hi))) continue;  // nothing in common
                ++touched;
                REQUIRE(std::binary_search(found.begin(), found.end(), k));
            }
            CHECK(found.size() < tree.triangle_count() / 4);  // it does cull
        }
        REQUIRE(touched > 100);
    }

    TEST_CASE("analytic: rays from a sphere's centre meet it within its sagitta")
    {
        const double radius = 0.02;
        const WallMesh mesh = sphere(radius, Vec3(0.3, 0, 0), 4);
        const WallTree tree = build_wall_tree(mesh);
        // a facet's plane lies within R - sqrt(R^2 - c^2) of the sphere, c its circumradius a b c / (4 A)
        double circumradius = 0;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle3 tri = triangle_of(mesh, t);
            const double product = (tri.b - tri.a).norm() * (tri.c - tri.b).norm() * (tri.a - tri.c).norm();
            circumradius = std::max(circumradius, product / (2 * double_area(tri).norm()));
        }
        const double least = std::sqrt(radius * radius - circumradius * circumradius);
        std::mt19937 random(2);
        std::normal_distribution<double> gauss;
        for (int i = 0; i < 200; ++i) {
            // axis-parallel rays first: they meet vertices and run along box faces
            const Vec3 d = i < 6 ? Vec3((i < 3 ? 1 : -1) * Vec3::Unit(i % 3))
                                 : Vec3(Vec3(gauss(random), gauss(random), gauss(random)).normalized());
            const double t = first_hit(tree, Vec3(0.3, 0, 0), d);
            CHECK(t <= radius * (1 + 1e-6));
            CHECK(t >= least * (1 - 1e-6));  // vertices are rounded to float32
        }
        CHECK(std::isinf(first_hit(tree, Vec3(0, 0, 0.03), Vec3::UnitX())));
    }

    TEST_CASE("property: one triangle, coinciding triangles, a line of triangles")
    {
        WallMesh one;
        one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        one.triangles = {{0, 1, 2}};
        const WallTree tree = build_wall_tree(one);
        check_structure(tree);
        CHECK(tree.nodes.size() == 1);
        CHECK(nearest_on_wall(tree, Vec3(0.2, 0.2, 1)).distance2 == doctest::Approx(1.0).epsilon(1e-6));
        CHECK(tree.edge_bits[0] == 7);

        WallMesh same = one;
        same.triangles.assign(1000, {0, 1, 2});
        check_structure(build_wall_tree(same));

        // sizes over 30 powers of two in one row: what makes a surface-area split peel one triangle at a time
        WallMesh row;
        for (int i = 0; i < 3000; ++i) {
            const double x = std::ldexp(1.0, -(i % 60)) * (1 + i / 60);
            const auto first = static_cast<std::int32_t>(row.vertices.size());
            row.vertices.insert(row.vertices.end(), {Vec3(x, 0, 0), Vec3(1.5 * x, 0, 0), Vec3(x, x, 0)});
            row.triangles.push_back({first, first + 1, first + 2});
        }
        check_structure(build_wall_tree(row));
        CHECK(build_wall_tree(WallMesh{}).nodes.empty());
        CHECK(nearest_on_wall(build_wall_tree(WallMesh{}), Vec3::Zero()).triangle == -1);
    }

    TEST_CASE("property: one thread and two build the same bits")
    {
        const WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 60000)).mesh;
        const WallTree one = build_wall_tree(mesh, 1), two = build_wall_tree(mesh, 2);
        check_structure(two);
        REQUIRE(one.nodes.size() == two.nodes.size());
        CHECK(one.original.size() == two.original.size());
        CHECK(one.depth == two.depth);
        CHECK(one.edge_bits.size() == mesh.triangles.size());
        const WallTree again = build_wall_tree(mesh, 2);
        CHECK(std::memcmp(two.nodes.data(), again.nodes.data(), two.nodes.size() * sizeof(TreeNode)) == 0);
        CHECK(two.original == again.original);
        CHECK(one.original == two.original);
    }

    TEST_CASE("analytic: opening bits are set on the two rims and nowhere else")
    {
        const WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 2000)).mesh;
        const WallTree tree = build_wall_tree(mesh);
        int bits = 0, elsewhere = 0;
        for (std::size_t k = 0; k < tree.triangle_count(); ++k)
            for (int e = 0; e < 3; ++e) {
                if (!SEL_EDGE_IS_OPENING(tree.edge_bits[k], e)) continue;
                ++bits;
                const Triangle3 t = tree.triangle(k);
                const Vec3 ends[3] = {t.a, t.b, t.c};
                const double x0 = ends[e].x() + tree.centre.x(), x1 = ends[(e + 1) % 3].x() + tree.centre.x();
                elsewhere += std::abs(x0 - x1) > 1e-6 || std::min(std::abs(x0), std::abs(x0 - 0.1)) > 1e-6;
            }
        const auto around = std::count_if(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return v.x() == 0; });
        CHECK(bits == 2 * around);
        CHECK(elsewhere == 0);
    }
}

}  // namespace test_tree
