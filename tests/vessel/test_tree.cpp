// The wall's tree against brute force, and its promises about depth, boxes and determinism.
#include "mesh_fixtures.h"
#include "support/approx.h"
#include "vessel/inside.h"
#include "vessel/shared_tree.h"
#include "vessel/tree.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

namespace seldinger::test::test_tree {

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
        if (SEL_IS_INNER(node.count)) {
            for (std::uint32_t c = 0; c < 2; ++c) {
                const std::uint32_t child = node.left_or_first + c;
                ordered &= child > visit.node && SEL_IS_RIGHT(child) == (c == 1);
                if (SEL_IS_INNER(tree.nodes[child].count)) ordered &= SEL_PARENT(tree.nodes[child].count) == visit.node;
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
            CHECK((hit.point - p).norm() == about(std::sqrt(hit.distance2)).epsilon(1e-9));
        }
    }

    TEST_CASE("property: quads hold their triangles, each triangle in one leaf")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 20000)).mesh;
        append(mesh, random_soup(300, 0.005, 3));
        const WallTree tree = build_wall_tree(mesh);
        const std::vector<TreeQuad> quads = make_quads(tree);
        REQUIRE(quads.size() > 1);
        std::vector<int> seen(tree.triangle_count(), 0);
        long planes = 0, outside = 0;
        // the triangles below a quad's descendant, first and end
        const std::function<std::pair<std::uint32_t, std::uint32_t>(std::uint32_t)> look = [&](std::uint32_t at) {
            if (at & TreeQuad::leaf) {
                const std::uint32_t first = at & TreeQuad::first_triangle, end = first + (at >> TreeQuad::count_shift & 3) + 1;
                for (std::uint32_t k = first; k < end; ++k) ++seen[k];
                return std::pair(first, end);
            }
            const TreeQuad& quad = quads[at];
            std::pair<std::uint32_t, std::uint32_t> all{~0u, 0u};
            for (std::size_t k = 0; k < 4 && quad.reach[k] >= 0; ++k) {
                const auto [first, end] = look(quad.child[k]);
                all = {std::min(all.first, first), std::max(all.second, end)};
                const Vec3 centre(quad.centre[0][k], quad.centre[1][k], quad.centre[2][k]),
                    normal(quad.normal[0][k], quad.normal[1][k], quad.normal[2][k]);
                planes += normal.norm() > 0;
                outside += normal.norm() > 1;
                for (const float *v = &tree.vertices[9 * first], *stop = v + 9 * (end - first); v != stop; v += 3) {
                    const Vec3 w = Vec3(v[0], v[1], v[2]) - centre;
                    outside += normal.norm() > 0 && (normal.dot(w) > quad.highest[k] || normal.dot(w) < quad.lowest[k]);
                    outside += (w - normal.dot(w) * normal).norm() > quad.reach[k];
                }
            }
            return all;
        };
        CHECK(look(0) == std::pair<std::uint32_t, std::uint32_t>(0u, static_cast<std::uint32_t>(tree.triangle_count())));
        CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
        CHECK(planes > static_cast<long>(quads.size()));
        CHECK(outside == 0);
    }

    TEST_CASE("property: quads and a guess save visits and change no answer")
    {
        // From tables to the thousandth part of a hair: floats round alike at every size. Three bodies, where ties are many: a
        // tube seen from its axis, a sphere from its middle, and flat facets cut into pieces.
        for (const double scale : {1.0, 1e-6, 1e4}) {
            WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 20000)).mesh;
            append(mesh, sphere(0.01, Vec3(-0.02, 0, 0), 4));
            append(mesh, random_soup(300, 0.005, 3));
            const Vec3 away(1, -2, 0.5);
            for (Vec3& v : mesh.vertices) v = scale * (v + away);
            const WallTree tree = build_wall_tree(mesh);
            const std::vector<TreeQuad> quads = make_quads(tree);
            std::mt19937 random(7);
            std::uniform_real_distribution<double> place(-0.05, 0.15), small(-1e-4, 1e-4), tiny(-1e-12, 1e-12), wide(-4, 4);
            std::uint64_t visits = 0, visits_before = 0;
            for (int i = 0; i < 400; ++i) {
                const Vec3 from[] = {{place(random), 0.3 * place(random), 0.3 * place(random)},
                                     {place(random), small(random), small(random)},
                                     {-0.02 + tiny(random), tiny(random), 0},
                                     {wide(random), wide(random), wide(random)}};
                const Vec3 p = i % 8 == 7 ? mesh.vertices[random() % mesh.vertices.size()] : Vec3(scale * (from[i % 4] + away));
                const TreeHit before =
                    nearest_on_wall(tree, p, std::numeric_limits<double>::infinity(), i % 4 == 1 ? &visits_before : nullptr);
                const auto guess = static_cast<std::int64_t>(random() % tree.triangle_count());
                for (const std::int64_t first : {std::int64_t{-1}, guess, before.triangle})
                    for (const double limit :
                         {std::numeric_limits<double>::infinity(), (1 + 1e-9) * std::sqrt(before.distance2) + 1e-300}) {
                        const bool count = i % 4 == 1 && first < 0 && std::isinf(limit);
                        const TreeHit hit = nearest_on_wall(tree, p, limit, count ? &visits : nullptr, first, quads);
                        CHECK(hit.distance2 == before.distance2);
                        CHECK(hit.triangle == before.triangle);
                        CHECK(hit.point == before.point);
                        CHECK(hit.feature == before.feature);
                    }
                if (before.distance2 > 0)
                    CHECK(nearest_on_wall(tree, p, 0.999 * std::sqrt(before.distance2), nullptr, -1, quads).triangle == -1);
            }
            CHECK(visits < visits_before / 2);  // near the tube's axis
        }
        CHECK(make_quads(WallTree{}).empty());
        CHECK(make_quads(build_wall_tree(random_soup(1, 1, 1))).empty());  // its root is a leaf
    }

    TEST_CASE("property: who asks for one mesh shares one tree; another content has another")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 2000)).mesh;
        const std::shared_ptr<const WallTree> first = shared_wall_tree(mesh);
        const LumenQuery lumen(WallMesh(mesh), {});
        CHECK(&lumen.tree() == first.get());
        CHECK(shared_wall_tree(mesh) == first);
        shrink_kept_wall_tree();
        CHECK(shared_wall_tree(mesh) == first);  // others have it still
        const WallMesh small = make_tube(tube_spec(0.01, 0.1, 500)).mesh;
        const WallTree made = *shared_wall_tree(small);
        shrink_kept_wall_tree();
        CHECK(shared_wall_tree(small)->vertices == made.vertices);  // from its division
        CHECK(shared_wall_tree(small)->original == made.original);
        keep_wall_tree(mesh, *first);
        CHECK(shared_wall_tree(mesh) != first);
        CHECK(shared_wall_tree(mesh)->original == first->original);
        const WallMesh before = mesh;
        mesh.vertices[7].x() = std::nextafter(mesh.vertices[7].x(), 1.0);
        const std::shared_ptr<const WallTree> moved = shared_wall_tree(mesh);
        CHECK(moved != first);
        std::swap(mesh.triangles[0], mesh.triangles[1]);
        CHECK(shared_wall_tree(mesh) != moved);
        // the tree of the first mesh, made anew, has the bits of the one that its users still have
        const std::shared_ptr<const WallTree> again = shared_wall_tree(before);
        CHECK(again->original == first->original);
        CHECK(again->vertices == first->vertices);
        CHECK(std::memcmp(again->nodes.data(), first->nodes.data(), first->nodes.size() * sizeof(TreeNode)) == 0);
    }

    TEST_CASE("property: a tree made from its division is the same tree; another mesh's or a damaged one is none")
    {
        WallMesh mesh = make_tube(tube_spec(0.01, 0.1, 20000)).mesh;
        append(mesh, random_soup(300, 0.005, 3));
        const WallTree tree = build_wall_tree(mesh);
        const TreeDivision division = division_of(tree);
        const std::optional<WallTree> again = divided_wall_tree(mesh, division);
        REQUIRE(again);
        check_structure(*again);
        CHECK(again->centre == tree.centre);
        CHECK(again->vertices == tree.vertices);
        CHECK(again->normals == tree.normals);
        CHECK(again->original == tree.original);
        CHECK(again->edge_bits == tree.edge_bits);
        REQUIRE(again->nodes.size() == tree.nodes.size());
        bool same = true;
        for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
            const TreeNode &a = again->nodes[i], &b = tree.nodes[i];
            same &= a.left_or_first == b.left_or_first && a.count == b.count && std::equal(a.lo, a.lo + 3, b.lo) &&
                    std::equal(a.hi, a.hi + 3, b.hi);
        }
        CHECK(same);

        WallMesh shorter = mesh;
        shorter.triangles.pop_back();
        CHECK_FALSE(divided_wall_tree(shorter, division));
        CHECK_FALSE(divided_wall_tree(WallMesh{}, TreeDivision{}));
        const auto refused = [&](const auto& damage) {
            TreeDivision damaged = division;
            damage(damaged);
            return !divided_wall_tree(mesh, damaged);
        };
        const std::size_t leaf = static_cast<std::size_t>(
            std::find_if(division.nodes.begin(), division.nodes.end(), [](const auto& n) { return n[1] > 0; }) -
            division.nodes.begin());
        CHECK(refused([](TreeDivision& d) { d.original[3] = d.original[4]; }));
        CHECK(refused([](TreeDivision& d) { d.original[3] = ~0u; }));
        CHECK(refused([](TreeDivision& d) { d.edge_bits.pop_back(); }));
        CHECK(refused([](TreeDivision& d) { d.nodes.pop_back(); }));
        CHECK(refused([](TreeDivision& d) { d.nodes[0][0] = 0; }));
        CHECK(refused([](TreeDivision& d) { d.nodes[0][0] = ~0u; }));
        CHECK(refused([&](TreeDivision& d) { d.nodes[leaf][0] += 1; }));
        CHECK(refused([&](TreeDivision& d) { d.nodes[leaf][1] = 7; }));
        CHECK(refused([&](TreeDivision& d) { d.nodes[leaf] = {0, 0}; }));
    }

    TEST_CASE("property: a limit hides what is farther and nothing else")
    {
        const WallTree tree = build_wall_tree(make_tube(tube_spec(0.01, 0.1, 2000)).mesh);
        const Vec3 p(0.05, 0, 0.004);
        const double distance = std::sqrt(nearest_on_wall(tree, p).distance2);
        CHECK(nearest_on_wall(tree, p, 1.001 * distance).triangle >= 0);
        CHECK(nearest_on_wall(tree, p, 0.999 * distance).triangle == -1);
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
        CHECK(nearest_on_wall(tree, Vec3(0.2, 0.2, 1)).distance2 == about(1.0).epsilon(1e-6));
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

}  // namespace seldinger::test::test_tree
