// Collapses the binary tree into nodes of eight children, subtrees of large meshes on two threads.
#include "wide/wide_tree.h"

#include "core/check.h"
#include "vessel/tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <thread>
#include <utility>

namespace seldinger {
namespace {

/// For every node of the binary tree, from the leaves up.
struct Span {
    std::uint32_t first, count;  // triangles below it
    // Were it the root of a wide node, that node would have `children` children and `level` levels of wide nodes from it down; 0:
    // a leaf. Nodes fill from the leaves up, where most of them are: two nodes of a level become one as long as their children
    // fit, and children of the next one when they do not.
    std::uint8_t level, children;
};

std::vector<Span> find_spans(const WallTree& tree)
{
    std::vector<Span> spans(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {  // children stand behind their parents
        const TreeNode& node = tree.nodes[i];
        Span& span = spans[i];
        if (!SEL_IS_INNER(node.count)) {
            span = {node.left_or_first, SEL_LEAF_TRIANGLES(node.count), 0, 0};
            continue;
        }
        const Span &left = spans[node.left_or_first], &right = spans[node.left_or_first + 1];
        span = {left.first, left.count + right.count, 0, 0};
        if (span.count <= SEL_WIDE_LEAF) continue;
        const std::uint8_t level = std::max({left.level, right.level, std::uint8_t{1}});
        const int children = (left.level == level ? left.children : 1) + (right.level == level ? right.children : 1);
        span.level = children <= 8 ? level : level + 1;
        span.children = static_cast<std::uint8_t>(children <= 8 ? children : 2);
    }
    return spans;
}

struct Builder {
    const WallTree& tree;
    const std::vector<Span>& spans;
    WideTree wide{};
    std::vector<std::uint32_t> roots{};  // of each wide node, in the binary tree

    /// Nodes of the binary tree that become children of a wide node of `level`, in their order.
    void add_children(std::uint32_t node, int level, std::vector<std::uint32_t>& children) const
    {
        if (spans[node].level < level) {
            children.push_back(node);
            return;
        }
        add_children(tree.nodes[node].left_or_first, level, children);
        add_children(tree.nodes[node].left_or_first + 1, level, children);
    }
    void find_children(std::size_t at, std::vector<std::uint32_t>& children) const
    {
        children.clear();
        add_children(roots[at], std::max<int>(spans[roots[at]].level, 1), children);
    }

    /// Numbers the nodes below `at`, which has its own: siblings side by side, each followed by its subtree.
    void link(std::size_t at)
    {
        std::vector<std::uint32_t> children;
        find_children(at, children);
        const std::size_t first = roots.size();
        std::uint32_t child[8];
        std::fill(std::begin(child), std::end(child), SEL_WIDE_NONE);
        for (std::size_t k = 0; k < children.size(); ++k) {
            const Span& span = spans[children[k]];
            const bool leaf = span.level == 0;
            child[k] = leaf ? 1u << 31 | (span.count - 1) << 28 | span.first : static_cast<std::uint32_t>(roots.size());
            if (!leaf) roots.push_back(children[k]);
        }
        const std::size_t end = roots.size();
        wide.nodes.resize(end);
        std::copy(std::begin(child), std::end(child), std::begin(wide.nodes[at].child));
        for (std::size_t k = first; k < end; ++k) link(k);
    }

    /// Boxes of the children of `at` and vertices of those that are leaves.
    void fill(std::size_t at, const std::vector<std::uint32_t>& children)
    {
        WideNode& node = wide.nodes[at];
        const TreeNode& all = tree.nodes[roots[at]];
        for (std::size_t d = 0; d < 3; ++d) {
            const double origin = all.lo[d], end = all.hi[d];
            float step = (all.hi[d] - all.lo[d]) / 255;
            while (origin + 255.0 * step < end) step = std::nextafter(step, std::numeric_limits<float>::infinity());
            node.origin[d] = all.lo[d];
            node.step[d] = step;
            for (std::size_t k = 0; k < children.size(); ++k) {
                const TreeNode& box = tree.nodes[children[k]];
                // outwards, and judged by what the grid's lines are: exact in double, of 24 and 8 bits
                double lo = step > 0 ? std::floor((box.lo[d] - origin) / step) : 0,
                       hi = step > 0 ? std::ceil((box.hi[d] - origin) / step) : 0;
                if (origin + lo * step > box.lo[d]) --lo;
                if (origin + hi * step < box.hi[d]) ++hi;
                SEL_ASSERT(lo >= 0 && hi <= 255);
                node.lo[d][k] = static_cast<uchar>(lo);
                node.hi[d][k] = static_cast<uchar>(hi);
            }
        }
        for (const std::uint32_t child : node.child) {
            if (child == SEL_WIDE_NONE || !SEL_WIDE_IS_LEAF(child)) continue;
            const std::size_t first = 9 * std::size_t{SEL_WIDE_FIRST(child)}, count = SEL_WIDE_COUNT(child);
            for (std::size_t k = 0; k < count; ++k)
                for (std::size_t i = 0; i < 9; ++i) wide.vertices[first + i * count + k] = tree.vertices[first + 9 * k + i];
        }
    }
    void fill_range(std::size_t begin, std::size_t end)
    {
        std::vector<std::uint32_t> children;
        for (std::size_t at = begin; at < end; ++at) {
            find_children(at, children);
            fill(at, children);
        }
    }
};

}  // namespace

WideTree build_wide_tree(const WallTree& tree)
{
    if (tree.nodes.empty()) return {};
    SEL_ASSERT(tree.triangle_count() < (1u << 28));  // what a child's word holds
    const std::vector<Span> spans = find_spans(tree);
    Builder builder{tree, spans};
    builder.roots = {0};
    builder.wide.nodes.resize(1);
    builder.wide.vertices.resize(tree.vertices.size() + 8);
    builder.link(0);
    const std::size_t count = builder.wide.nodes.size(), half = count > 1000 ? count / 2 : count;
    std::thread helper;
    if (half < count) helper = std::thread([&] { builder.fill_range(half, count); });
    builder.fill_range(0, half);
    if (helper.joinable()) helper.join();
    return std::move(builder.wide);
}

}  // namespace seldinger
