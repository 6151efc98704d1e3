// Bounds of a node's grandchildren side by side, for nearest points far from the wall.
#include "core/check.h"
#include "core/parallel.h"
#include "vessel/tree.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr std::uint32_t most_bounded = 4096;  // triangles below a node; a larger piece of a vessel's wall is bent too far
// Queries compute in float. With u = 2^-24, E the sum of the tree's extents and no coordinate of a point beyond E
// (nearest_on_wall), the height along a normal and the distance from an axis are each wrong by less than 17 u E. Twice that is
// added to every bound.
constexpr double slack_of_extent = 0x1p-19;
constexpr double shorter = 2e-7;  // a plane's normal, rounded to float, is never longer than 1

struct Below {  // of a node
    std::uint32_t first = 0, end = 0;  // triangles, leaf order
    Vec3 area = Vec3::Zero();          // sum of their vectors
};

/// Children stand behind their parent, and cover its triangles one after the other.
std::vector<Below> gather(const WallTree& tree)
{
    std::vector<Below> below(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        const TreeNode& node = tree.nodes[i];
        Below& here = below[i];
        if (SEL_IS_INNER(node.count)) {
            const Below &left = below[node.left_or_first], &right = below[node.left_or_first + 1];
            here = {left.first, right.end, left.area + right.area};
            continue;
        }
        here.first = node.left_or_first;
        here.end = here.first + SEL_LEAF_TRIANGLES(node.count);
        for (std::uint32_t k = here.first; k < here.end; ++k) here.area += double_area(tree.triangle(k));
    }
    return below;
}

/// A cylinder around the node's triangles, or a ball around its box where they are many.
void bound(const WallTree& tree, const TreeNode& node, const Below& below, double slack, TreeQuad& quad, std::size_t k)
{
    for (std::size_t d = 0; d < 3; ++d) quad.centre[d][k] = node.lo[d] + 0.5f * (node.hi[d] - node.lo[d]);
    const Vec3 centre(quad.centre[0][k], quad.centre[1][k], quad.centre[2][k]);
    const double length = below.area.norm();
    double highest = 0, lowest = 0, reach2 = 0;
    if (below.end - below.first > most_bounded || !(length > 0)) {
        for (int d = 0; d < 3; ++d) {
            const double half = std::max(node.hi[d] - centre[d], centre[d] - node.lo[d]);
            reach2 += half * half;
        }
    } else {
        for (std::size_t d = 0; d < 3; ++d) quad.normal[d][k] = static_cast<float>(below.area[d] / length * (1 - shorter));
        const Vec3 normal(quad.normal[0][k], quad.normal[1][k], quad.normal[2][k]);
        highest = -std::numeric_limits<double>::infinity();
        lowest = -highest;
        for (const float *v = &tree.vertices[9 * below.first], *end = v + 9 * (below.end - below.first); v != end; v += 3) {
            const Vec3 w = Vec3(v[0], v[1], v[2]) - centre;
            const double height = normal.dot(w);
            highest = std::max(highest, height);
            lowest = std::min(lowest, height);
            reach2 = std::max(reach2, w.squaredNorm() - height * height);
        }
    }
    quad.highest[k] = static_cast<float>(highest + slack);
    quad.lowest[k] = static_cast<float>(lowest - slack);
    quad.reach[k] = static_cast<float>((1 + 1e-6) * std::sqrt(reach2) + slack);
}

/// The nodes that get a quad, parents first and each beside its own children, and where their own children are.
struct Layout {
    std::vector<std::uint32_t> node;
    std::vector<TreeQuad> quads;
};

/// Two to four of them: children that are leaves, and the children of those that are not.
std::size_t grandchildren(const WallTree& tree, std::uint32_t node, std::uint32_t (&found)[4])
{
    std::size_t count = 0;
    for (std::uint32_t child = tree.nodes[node].left_or_first, end = child + 2; child < end; ++child) {
        const TreeNode& below = tree.nodes[child];
        if (!SEL_IS_INNER(below.count)) found[count++] = child;
        else found[count++] = below.left_or_first, found[count++] = below.left_or_first + 1;
    }
    return count;
}

Layout lay_out(const WallTree& tree)
{
    struct Next {
        std::uint32_t node, parent, slot;
    };
    Layout layout;
    layout.node.reserve(tree.nodes.size() / 3);
    layout.quads.reserve(tree.nodes.size() / 3);
    for (std::vector<Next> stack = {{0, 0, 0}}; !stack.empty();) {
        const Next next = stack.back();
        stack.pop_back();
        const auto here = static_cast<std::uint32_t>(layout.quads.size());
        if (here > 0) layout.quads[next.parent].child[next.slot] = here;
        layout.node.push_back(next.node);
        TreeQuad& quad = layout.quads.emplace_back();
        std::uint32_t found[4];
        for (auto k = static_cast<std::uint32_t>(grandchildren(tree, next.node, found)); k-- > 0;) {
            const TreeNode& node = tree.nodes[found[k]];
            if (SEL_IS_INNER(node.count)) stack.push_back({found[k], here, k});
            else
                quad.child[k] =
                    TreeQuad::leaf | (SEL_LEAF_TRIANGLES(node.count) - 1) << TreeQuad::count_shift | node.left_or_first;
        }
    }
    return layout;
}

}  // namespace

std::vector<TreeQuad> make_quads(const WallTree& tree)
{
    if (tree.nodes.empty() || !SEL_IS_INNER(tree.nodes[0].count)) return {};
    SEL_ASSERT(tree.triangle_count() <= TreeQuad::first_triangle + 1);
    const std::vector<Below> below = gather(tree);
    const double slack = slack_of_extent * tree.extent();
    Layout layout = lay_out(tree);
    for_each_item(static_cast<int>(layout.quads.size()), 512, [&](int i) {
        TreeQuad& quad = layout.quads[static_cast<std::size_t>(i)];
        std::uint32_t found[4];
        const std::size_t count = grandchildren(tree, layout.node[static_cast<std::size_t>(i)], found);
        for (std::size_t k = 0; k < count; ++k) bound(tree, tree.nodes[found[k]], below[found[k]], slack, quad, k);
        for (std::size_t k = count; k < 4; ++k) quad.reach[k] = -std::numeric_limits<float>::infinity();  // farther than all
    });
    return std::move(layout.quads);
}

}  // namespace seldinger
