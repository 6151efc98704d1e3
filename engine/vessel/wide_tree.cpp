#include "vessel/wide_tree.h"

#include "core/check.h"
#include "vessel/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

/// Of every node of the binary tree, from the leaves up.
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
        if (node.count > 0) {
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

    [[nodiscard]] bool is_leaf(std::uint32_t node) const { return spans[node].level == 0; }

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

    void set_box(WideNode& to, std::size_t k, const TreeNode& box) const
    {
        for (int d = 0; d < 3; ++d) {
            const double origin = to.origin[d], step = to.step[d];
            const auto line = [&](double q) { return origin + q * step; };  // exact: 24 and 8 bits
            double lo = step > 0 ? std::floor((box.lo[d] - origin) / step) : 0, hi = step > 0 ? std::ceil((box.hi[d] - origin) / step) : 0;
            if (line(lo) > box.lo[d]) --lo;
            if (line(hi) < box.hi[d]) ++hi;
            SEL_ASSERT(lo >= 0 && hi <= 255);
            to.lo[d][k] = static_cast<uchar>(lo);
            to.hi[d][k] = static_cast<uchar>(hi);
        }
    }

    std::uint32_t make_leaf(std::uint32_t node)
    {
        const Span span = spans[node];
        for (std::uint32_t k = 0; k < span.count; ++k)
            for (std::uint32_t i = 0; i < 9; ++i)
                wide.vertices[9 * std::size_t{span.first} + i * span.count + k] = tree.vertices[9 * std::size_t{span.first + k} + i];
        return 1u << 31 | (span.count - 1) << 28 | span.first;
    }

    void build(std::uint32_t from, std::uint32_t to)
    {
        const TreeNode& box = tree.nodes[from];
        WideNode node{};
        for (int d = 0; d < 3; ++d) {
            node.origin[d] = box.lo[d];
            node.step[d] = (box.hi[d] - box.lo[d]) / 255;
            while (static_cast<double>(node.origin[d]) + 255.0 * static_cast<double>(node.step[d]) < box.hi[d])
                node.step[d] = std::nextafter(node.step[d], std::numeric_limits<float>::infinity());
        }
        std::vector<std::uint32_t> children;
        add_children(from, std::max<int>(spans[from].level, 1), children);
        const std::size_t count = children.size();
        std::fill(std::begin(node.child), std::end(node.child), SEL_WIDE_NONE);
        for (std::size_t k = 0; k < count; ++k) {
            set_box(node, k, tree.nodes[children[k]]);
            node.child[k] = is_leaf(children[k]) ? make_leaf(children[k]) : static_cast<std::uint32_t>(wide.nodes.size());
            if (!is_leaf(children[k])) wide.nodes.emplace_back();
        }
        wide.nodes[to] = node;
        for (std::size_t k = 0; k < count; ++k)
            if (!SEL_WIDE_IS_LEAF(node.child[k])) build(children[k], node.child[k]);
    }
};

}  // namespace

WideTree build_wide_tree(const WallTree& tree)
{
    if (tree.nodes.empty()) return {};
    SEL_ASSERT(tree.triangle_count() < (1u << 28));
    const std::vector<Span> spans = find_spans(tree);
    Builder builder{tree, spans};
    builder.wide.vertices.resize(tree.vertices.size() + 8);
    builder.wide.nodes.emplace_back();
    builder.build(0, 0);
    return std::move(builder.wide);
}

}  // namespace seldinger
