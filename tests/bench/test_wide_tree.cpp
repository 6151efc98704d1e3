// The wide tree's promises: every triangle in one leaf, every box round its contents, few nodes, bounded depth.
#include "vessel/mesh_fixtures.h"
#include "vessel/tree.h"
#include "wide/wide_tree.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace test_wide_tree {

using namespace seldinger;
using namespace seldinger::test;

namespace {

struct Seen {
    std::vector<int> triangles;
    int deepest = 0;
    bool inside = true, ordered = true;
};

/// Visits the subtree of child k of a node and within its box, given as the grid's lines in double.
void visit(const WallTree& tree, const WideTree& wide, std::uint32_t at, int depth, Seen& seen)
{
    const WideNode& node = wide.nodes[at];
    seen.deepest = std::max(seen.deepest, depth);
    for (std::size_t k = 0; k < 8; ++k) {
        const std::uint32_t child = node.child[k];
        if (child == SEL_WIDE_NONE) continue;
        const auto line = [&](std::size_t d, uchar q) { return node.origin[d] + static_cast<double>(node.step[d]) * q; };
        if (!SEL_WIDE_IS_LEAF(child)) {
            seen.ordered &= child > at;
            const WideNode& below = wide.nodes[child];
            for (std::size_t d = 0; d < 3; ++d)  // a node's grid begins and ends with its triangles
                seen.inside &= line(d, node.lo[d][k]) <= below.origin[d] &&
                               line(d, node.hi[d][k]) >= below.origin[d] + 254.99 * static_cast<double>(below.step[d]);
            visit(tree, wide, child, depth + 1, seen);
            continue;
        }
        const std::size_t first = SEL_WIDE_FIRST(child), count = SEL_WIDE_COUNT(child);
        for (std::size_t t = 0; t < count; ++t) {
            ++seen.triangles[first + t];
            for (std::size_t i = 0; i < 9; ++i) {
                const float x = wide.vertices[9 * first + i * count + t];
                seen.inside &= x == tree.vertices[9 * (first + t) + i];
                seen.inside &= line(i % 3, node.lo[i % 3][k]) <= x && line(i % 3, node.hi[i % 3][k]) >= x;
            }
        }
    }
}

void check_wide(const WallMesh& mesh, bool fills = false)
{
    const WallTree tree = build_wall_tree(mesh);
    const WideTree wide = build_wide_tree(tree);
    Seen seen;
    seen.triangles.resize(tree.triangle_count());
    visit(tree, wide, 0, 1, seen);
    CHECK(seen.inside);
    CHECK(seen.ordered);
    CHECK(std::all_of(seen.triangles.begin(), seen.triangles.end(), [](int n) { return n == 1; }));
    CHECK(7 * seen.deepest + 8 <= SEL_WIDE_STACK);
    CHECK(wide.vertices.size() == tree.vertices.size() + 8);
    if (fills) CHECK(sizeof(WideNode) * wide.nodes.size() < 6 * tree.triangle_count());  // bytes; the binary tree has 26
}

}  // namespace

TEST_SUITE("vessel/wide_tree")
{
    TEST_CASE("property: a tube, coarse and fine")
    {
        for (int triangles : {200, 2000, 60000}) check_wide(make_tube(tube_spec(0.01, 0.1, triangles)).mesh, triangles > 200);
    }

    TEST_CASE("property: one triangle, coinciding triangles, a line of triangles, none")
    {
        WallMesh one;
        one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        one.triangles = {{0, 1, 2}};
        check_wide(one);
        WallMesh same = one;
        same.triangles.assign(1000, {0, 1, 2});
        check_wide(same);
        // sizes over 30 powers of two in one row: the deepest trees that there are
        WallMesh row;
        for (int i = 0; i < 3000; ++i) {
            const double x = std::ldexp(1.0, -(i % 60)) * (1 + i / 60);
            const auto first = static_cast<std::int32_t>(row.vertices.size());
            row.vertices.insert(row.vertices.end(), {Vec3(x, 0, 0), Vec3(1.5 * x, 0, 0), Vec3(x, x, 0)});
            row.triangles.push_back({first, first + 1, first + 2});
        }
        check_wide(row);
        CHECK(build_wide_tree(WallTree{}).nodes.empty());
    }
}

}  // namespace test_wide_tree
