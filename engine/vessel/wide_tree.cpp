#include "vessel/wide_tree.h"

#include "core/check.h"
#include "vessel/tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

/// Triangles [first, first + count) below a node of the binary tree.
struct Span {
    std::uint32_t first, count;
};

std::vector<Span> find_spans(const WallTree& tree)
{
    std::vector<Span> spans(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {  // children stand behind their parents
        const TreeNode& node = tree.nodes[i];
        if (node.count > 0) spans[i] = {node.left_or_first, SEL_LEAF_TRIANGLES(node.count)};
        else
            spans[i] = {spans[node.left_or_first].first, spans[node.left_or_first].count + spans[node.left_or_first + 1].count};
    }
    return spans;
}

float half_area(const TreeNode& node)
{
    const float x = node.hi[0] - node.lo[0], y = node.hi[1] - node.lo[1], z = node.hi[2] - node.lo[2];
    return x * y + y * z + z * x;
}

struct Builder {
    const WallTree& tree;
    const std::vector<Span>& spans;
    WideTree wide{};

    [[nodiscard]] bool is_leaf(std::uint32_t node) const { return spans[node].count <= SEL_WIDE_LEAF; }

    /// The nodes of the binary tree that become children: two levels opened whole, then the largest one after the other.
    std::size_t choose_children(std::uint32_t node, std::array<std::uint32_t, 8>& children) const
    {
        std::size_t count = 1;
        children[0] = node;
        std::array<int, 8> depth{};
        while (count < 8) {
            std::size_t widest = count;
            float most = -1;
            for (std::size_t k = 0; k < count; ++k) {
                if (is_leaf(children[k])) continue;
                const float size = depth[k] < 3 ? std::numeric_limits<float>::max() : half_area(tree.nodes[children[k]]);
                if (size > most) most = size, widest = k;
            }
            if (widest == count) break;
            const std::uint32_t left = tree.nodes[children[widest]].left_or_first;
            children[widest] = left;
            depth[count] = ++depth[widest];
            children[count++] = left + 1;
        }
        return count;
    }

    void set_box(WideNode& to, int k, const TreeNode& box) const
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
        std::array<std::uint32_t, 8> children{};
        const std::size_t count = choose_children(from, children);
        std::fill(std::begin(node.child), std::end(node.child), SEL_WIDE_NONE);
        for (std::size_t k = 0; k < count; ++k) {
            set_box(node, static_cast<int>(k), tree.nodes[children[k]]);
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
