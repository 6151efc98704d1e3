// Building the AABB tree. Triangles travel through the build as small records that are partitioned in place, so that every
// pass reads memory in order: half the time of sorting indices for 3 million triangles.
#include "vessel/tree.h"

#include "core/check.h"
#include "vessel/mesh_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <thread>

namespace seldinger {
namespace {

using Lane4 = Eigen::Array4f;  // x, y, z and a lane along for the ride: one vector instruction for a box

constexpr int most_bins = 16;
constexpr float kBoxCost = 1.0f, kTriangleCost = 1.5f;  // an exact capsule-triangle test costs a few box tests
constexpr int kMaxDepth = SEL_TREE_STACK - 1;

struct Item {  // one triangle on its way into a leaf
    Lane4 lo, hi;
    // the id rides in lo's fourth lane with bit 30 set: a normal number, since arithmetic on denormal ones is slow
    void set_id(std::uint32_t id) { lo[3] = std::bit_cast<float>(id | 0x40000000u); }
    [[nodiscard]] std::uint32_t id() const { return std::bit_cast<std::uint32_t>(lo[3]) & 0x3fffffffu; }
    [[nodiscard]] float twice_centre(int axis) const { return lo[axis] + hi[axis]; }
};

struct Box {
    Lane4 lo = Lane4::Constant(3e38f), hi = Lane4::Constant(-3e38f);
    void add(const Lane4& l, const Lane4& h)
    {
        lo = lo.min(l);
        hi = hi.max(h);
    }
    void add(const Box& b) { add(b.lo, b.hi); }
    [[nodiscard]] float half_area() const
    {
        const Lane4 d = hi - lo;
        return d[0] < 0 ? 0.0f : d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
    }
    void store(TreeNode& node) const
    {
        for (int d = 0; d < 3; ++d) {
            node.lo[d] = lo[d];
            node.hi[d] = hi[d];
        }
    }
};

struct Bounds {
    Box box, centres;  // of the triangles; of their doubled centres
};

Bounds bounds(const Item* begin, const Item* end)
{
    Bounds result;
    for (const Item* it = begin; it != end; ++it) {
        result.box.add(it->lo, it->hi);
        const Lane4 centre = it->lo + it->hi;
        result.centres.add(centre, centre);
    }
    return result;
}

/// Levels that median splits need to bring n triangles down to leaves.
int median_levels(std::size_t n) { return n <= SEL_TREE_LEAF ? 0 : std::bit_width((n - 1) / SEL_TREE_LEAF); }

struct Split {
    int axis = -1;  // -1: no useful plane
    float offset = 0, scale = 0;
    int bins = 0, bin = 0;  // items in bins < bin go left
    float cost = 3e38f;
    [[nodiscard]] int bin_of(const Item& item) const
    {
        return std::min(bins - 1, static_cast<int>((item.twice_centre(axis) - offset) * scale));
    }
};

/// Best plane between bins on each axis, over the spread of the centres.
Split best_split(const Item* begin, const Item* end, const Box& centres)
{
    const std::ptrdiff_t items = end - begin;
    const int bins = items <= 8 ? 4 : items <= 64 ? 8 : most_bins;  // small ranges: bins cost more than triangles
    Split best;
    const Lane4 spread = centres.hi - centres.lo;
    const float widest = std::max({spread[0], spread[1], spread[2]});
    for (int axis = 0; axis < 3; ++axis) {
        // a narrow axis rarely wins, and for large ranges its pass over memory is what the build time is made of
        if (!(spread[axis] > 0) || spread[axis] < 0.3f * widest) continue;
        Split split{axis, centres.lo[axis], static_cast<float>(bins) / spread[axis], bins, 0, 3e38f};
        if (!(split.scale < 3e38f)) continue;
        std::array<Box, most_bins> box;
        std::array<std::uint32_t, most_bins> count{};
        for (const Item* it = begin; it != end; ++it) {
            const auto b = static_cast<std::size_t>(split.bin_of(*it));
            box[b].add(it->lo, it->hi);
            ++count[b];
        }
        std::array<float, most_bins> right_cost{};
        Box sweep;
        std::uint32_t n = 0;
        for (auto b = static_cast<std::size_t>(bins) - 1; b > 0; --b) {
            sweep.add(box[b]);
            right_cost[b] = sweep.half_area() * static_cast<float>(n += count[b]);
        }
        sweep = Box{};
        n = 0;
        for (std::size_t b = 1; b < static_cast<std::size_t>(bins); ++b) {
            sweep.add(box[b - 1]);
            n += count[b - 1];
            const float cost = sweep.half_area() * static_cast<float>(n) + right_cost[b];
            if (n > 0 && n < static_cast<std::uint32_t>(items) && cost < best.cost) {
                best = split;
                best.bin = static_cast<int>(b);
                best.cost = cost;
            }
        }
    }
    return best;
}

/// Splits at the middle of the widest axis by rank. Ties go by id, so that the result is one and the same.
Item* median_split(Item* begin, Item* end, const Box& box)
{
    int axis = 0;
    for (int d = 1; d < 3; ++d)
        if (box.hi[d] - box.lo[d] > box.hi[axis] - box.lo[axis]) axis = d;
    Item* middle = begin + (end - begin + 1) / 2;
    std::nth_element(begin, middle, end, [axis](const Item& a, const Item& b) {
        return a.twice_centre(axis) != b.twice_centre(axis) ? a.twice_centre(axis) < b.twice_centre(axis) : a.id() < b.id();
    });
    return middle;
}

/// Where to divide [begin, end), or null when it is to be a leaf.
Item* divide(Item* begin, Item* end, const Bounds& range, int depth)
{
    const Box& box = range.box;
    const auto n = static_cast<std::size_t>(end - begin);
    if (n <= 1) return nullptr;
    if (depth + 1 + median_levels(n) >= kMaxDepth) return n <= SEL_TREE_LEAF ? nullptr : median_split(begin, end, box);
    const Split split = best_split(begin, end, range.centres);
    if (n <= SEL_TREE_LEAF) {
        const float leaf_cost = kTriangleCost * static_cast<float>(n) * box.half_area();
        if (split.axis < 0 || 2 * kBoxCost * box.half_area() + kTriangleCost * split.cost >= leaf_cost) return nullptr;
    }
    if (split.axis < 0) return median_split(begin, end, box);  // all centres in one place
    return std::partition(begin, end, [&](const Item& item) { return split.bin_of(item) < split.bin; });
}

struct Range {  // a subtree still to be built
    Item *begin, *end;
    int depth;
    std::uint32_t node;
};

struct Builder {
    const Item* items;
    std::vector<TreeNode> nodes;
    int depth = 0;

    /// Fills nodes[range.node]; ranges of more than `grain` triangles are handed back in `later` instead of built.
    void build(Range range, std::size_t grain, std::vector<Range>* later)
    {
        SEL_ASSERT(range.depth <= kMaxDepth);
        if (later && static_cast<std::size_t>(range.end - range.begin) <= grain) {
            later->push_back(range);
            return;
        }
        const Bounds extent = bounds(range.begin, range.end);
        TreeNode node{};
        extent.box.store(node);
        Item* middle = divide(range.begin, range.end, extent, range.depth);
        depth = std::max(depth, range.depth);
        if (!middle) {
            node.left_or_first = static_cast<std::uint32_t>(range.begin - items);
            node.count = static_cast<std::uint32_t>(range.end - range.begin);
            nodes[range.node] = node;
            return;
        }
        node.left_or_first = static_cast<std::uint32_t>(nodes.size());
        nodes[range.node] = node;
        nodes.resize(nodes.size() + 2);
        build({range.begin, middle, range.depth + 1, node.left_or_first}, grain, later);
        build({middle, range.end, range.depth + 1, node.left_or_first + 1}, grain, later);
    }
};

/// Builds the top in this thread, the subtrees below it on `threads`, and joins them in their order.
void build_nodes(WallTree& tree, std::vector<Item>& items, int threads)
{
    Builder top{items.data(), {}, 0};
    top.nodes.reserve(items.size() + 2);
    top.nodes.resize(1);
    std::vector<Range> subtrees;
    const Range all{items.data(), items.data() + items.size(), 0, 0};
    top.build(all, threads > 1 ? items.size() / 8 + 1 : 0, threads > 1 ? &subtrees : nullptr);

    std::vector<Builder> parts(subtrees.size(), Builder{items.data(), {}, 0});
    std::atomic<std::size_t> next{0};
    auto work = [&] {
        for (std::size_t k = next++; k < parts.size(); k = next++) {
            Range range = subtrees[k];
            range.node = 0;
            parts[k].nodes.reserve(static_cast<std::size_t>(range.end - range.begin));
            parts[k].nodes.resize(1);
            parts[k].build(range, 0, nullptr);
        }
    };
    if (!subtrees.empty()) {
        std::thread helper(work);
        work();
        helper.join();
    }
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const auto offset = static_cast<std::uint32_t>(top.nodes.size()) - 1;  // part node i > 0 becomes offset + i
        for (TreeNode& node : parts[k].nodes)
            if (SEL_IS_INNER(node.count)) node.left_or_first += offset;
        top.nodes[subtrees[k].node] = parts[k].nodes[0];
        top.nodes.insert(top.nodes.end(), parts[k].nodes.begin() + 1, parts[k].nodes.end());
        top.depth = std::max(top.depth, parts[k].depth);
    }
    tree.nodes = std::move(top.nodes);
    tree.depth = top.depth;
}

void write_triangle(WallTree& tree, const WallMesh& mesh, std::size_t k)
{
    const auto& corner = mesh.triangles[tree.original[k]];
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 p = mesh.vertices[static_cast<std::size_t>(corner[c])] - tree.centre;
        for (int d = 0; d < 3; ++d) tree.vertices[9 * k + 3 * c + static_cast<std::size_t>(d)] = static_cast<float>(p[d]);
    }
    const Vec3 area = double_area(tree.triangle(k));  // of the rounded triangle: that one is the wall
    const Vec3 normal = area.norm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
    for (int d = 0; d < 3; ++d) tree.normals[3 * k + static_cast<std::size_t>(d)] = static_cast<float>(normal[d]);
}

void write_triangles(WallTree& tree, const WallMesh& mesh)
{
    tree.vertices.resize(9 * tree.original.size());
    tree.normals.resize(3 * tree.original.size());
    for (std::size_t k = 0; k < tree.original.size(); ++k) write_triangle(tree, mesh, k);
}

Vec3 centre_of(const WallMesh& mesh)
{
    Box3 box;
    for (const Vec3& v : mesh.vertices) box.extend(v);
    return box.center();
}

/// Whether the nodes are a tree whose leaves have all triangles, in their order, and the triangles are those of a mesh.
bool is_division(const TreeDivision& division, std::size_t triangles)
{
    if (division.original.size() != triangles || division.edge_bits.size() != triangles) return false;
    std::vector<bool> seen(triangles, false);
    for (const std::uint32_t t : division.original) {
        if (t >= triangles || seen[t]) return false;
        seen[t] = true;
    }
    struct Next {
        std::size_t node;
        int depth;
    };
    std::size_t visited = 0, next_triangle = 0;
    for (std::vector<Next> stack = {{0, 0}}; !stack.empty();) {
        const auto [i, depth] = stack.back();
        stack.pop_back();
        if (i >= division.nodes.size() || depth >= SEL_TREE_STACK) return false;
        ++visited;
        const auto [left_or_first, count] = division.nodes[i];
        if (count == 0) {
            if (left_or_first <= i || SEL_IS_RIGHT(left_or_first)) return false;  // children stand behind their parent, in pairs
            stack.push_back({left_or_first + std::size_t{1}, depth + 1});
            stack.push_back({left_or_first, depth + 1});
            continue;
        }
        if (left_or_first != next_triangle || SEL_LEAF_TRIANGLES(count) == 0 || SEL_LEAF_TRIANGLES(count) > SEL_TREE_LEAF)
            return false;
        next_triangle += SEL_LEAF_TRIANGLES(count);
    }
    return visited == division.nodes.size() && next_triangle == triangles;
}

/// From the leaves up; children stand behind their parent. @return the depth of the deepest leaf
int write_boxes(WallTree& tree)
{
    std::vector<std::uint8_t> height(tree.nodes.size(), 0);
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        TreeNode& node = tree.nodes[i];
        Box box;
        if (!SEL_IS_INNER(node.count)) {
            const std::size_t first = node.left_or_first, end = first + SEL_LEAF_TRIANGLES(node.count);
            for (const float *v = &tree.vertices[9 * first], *stop = v + 9 * (end - first); v != stop; v += 3) {
                const Lane4 p(v[0], v[1], v[2], 0);
                box.add(p, p);
            }
        } else {
            for (const std::size_t child : {node.left_or_first, node.left_or_first + 1}) {
                const TreeNode& below = tree.nodes[child];
                box.add(Lane4(below.lo[0], below.lo[1], below.lo[2], 0), Lane4(below.hi[0], below.hi[1], below.hi[2], 0));
                height[i] = std::max<std::uint8_t>(height[i], height[child] + 1);
            }
        }
        box.store(node);
    }
    return height[0];
}

/// Inner nodes below the root get their parent's index (tree_types.h).
void link_parents(std::vector<TreeNode>& nodes)
{
    SEL_ASSERT(nodes.size() < (1u << 29));
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        if (!SEL_IS_INNER(nodes[i].count)) continue;
        const std::uint32_t left = nodes[i].left_or_first;
        SEL_ASSERT(!SEL_IS_RIGHT(left));
        for (const std::uint32_t child : {left, left + 1})
            if (SEL_IS_INNER(nodes[child].count)) nodes[child].count = i << 3;
    }
}

/// The slab of a leaf whose box and whose triangles' vertices are there (tree_types.h).
void set_slab(const WallTree& tree, TreeNode& leaf)
{
    leaf.count = SEL_LEAF_TRIANGLES(leaf.count);
    const std::size_t first = leaf.left_or_first, end = first + leaf.count;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::size_t t = first; t < end; ++t) {
        const Eigen::Map<const Eigen::Vector3f> a(&tree.vertices[9 * t]), b(&tree.vertices[9 * t + 3]),
            c(&tree.vertices[9 * t + 6]);
        sum += (b - a).cross(c - a);
    }
    if (sum[2] < 0) sum = -sum;
    const float length = sum.norm();
    if (!(length > 0)) return;
    const auto step = [](float u) { return static_cast<std::uint32_t>(std::clamp((u + 1) * 511.5f + 0.5f, 0.0f, 1023.0f)); };
    const std::uint32_t a_bits = step(sum[0] / (length + sum[2])), b_bits = step(sum[1] / (length + sum[2]));
    // from here on with the normal as it will be read
    const double a = SEL_SLAB_TURN(a_bits), b = SEL_SLAB_TURN(b_bits), c = a * a + b * b;
    const Vec3 normal = Vec3(2 * a, 2 * b, 1 - c) / (1 + c);
    const Vec3 lo(leaf.lo[0], leaf.lo[1], leaf.lo[2]), half = (Vec3(leaf.hi[0], leaf.hi[1], leaf.hi[2]) - lo) / 2,
                                                       centre = lo + half;
    double most = 0;
    for (std::size_t k = 9 * first; k < 9 * end; k += 3)
        most = std::max(most, std::abs(normal.dot(Vec3(tree.vertices[k], tree.vertices[k + 1], tree.vertices[k + 2]) - centre)));
    const double extents = half.sum();
    // a step more than needed: kernels compute in float, too
    const double steps = extents > 0 ? most / extents * SEL_SLAB_STEPS + 1 : SEL_SLAB_STEPS + 1;
    if (steps < SEL_SLAB_STEPS)
        leaf.count |= a_bits << 3 | b_bits << 13 | (static_cast<std::uint32_t>(std::ceil(steps)) + 1) << 23;
}

std::vector<Item> make_items(const WallMesh& mesh, const Vec3& centre)
{
    std::vector<Lane4> rounded(mesh.vertices.size());
    for (std::size_t v = 0; v < rounded.size(); ++v) {
        const Vec3 local = mesh.vertices[v] - centre;
        rounded[v] << static_cast<float>(local.x()), static_cast<float>(local.y()), static_cast<float>(local.z()), 1.0f;
    }
    std::vector<Item> items(mesh.triangles.size());
    for (std::size_t t = 0; t < items.size(); ++t) {
        const auto& v = mesh.triangles[t];
        const Lane4 &a = rounded[static_cast<std::size_t>(v[0])], &b = rounded[static_cast<std::size_t>(v[1])],
                    &c = rounded[static_cast<std::size_t>(v[2])];
        items[t].lo = a.min(b).min(c);
        items[t].hi = a.max(b).max(c);
        items[t].set_id(static_cast<std::uint32_t>(t));
    }
    return items;
}

std::vector<std::uint8_t> opening_bits(const WallMesh& mesh)
{
    std::vector<std::uint8_t> bits(mesh.triangles.size(), 0);
    const MeshEdges edges = find_edges(mesh);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() == 1) bits[static_cast<std::size_t>(uses[0] / 3)] |= static_cast<std::uint8_t>(1u << (uses[0] % 3));
    }
    return bits;
}

}  // namespace

WallTree build_wall_tree(const WallMesh& mesh, int threads)
{
    WallTree tree;
    if (mesh.triangles.empty()) return tree;
    SEL_ASSERT(mesh.triangles.size() < (1u << 30));  // what an Item's lane holds
    tree.centre = centre_of(mesh);
    if (threads == 0) threads = mesh.triangles.size() > 10000 ? 2 : 1;

    std::vector<std::uint8_t> bits;
    std::thread edge_work;
    if (threads > 1) edge_work = std::thread([&] { bits = opening_bits(mesh); });
    else bits = opening_bits(mesh);
    std::vector<Item> items = make_items(mesh, tree.centre);
    build_nodes(tree, items, threads);
    if (edge_work.joinable()) edge_work.join();
    SEL_ASSERT(tree.depth < SEL_TREE_STACK);

    tree.original.resize(items.size());
    tree.edge_bits.resize(items.size());
    for (std::size_t k = 0; k < items.size(); ++k) {
        tree.original[k] = items[k].id();
        tree.edge_bits[k] = bits[tree.original[k]];
    }
    write_triangles(tree, mesh);
    for (TreeNode& node : tree.nodes)
        if (!SEL_IS_INNER(node.count)) set_slab(tree, node);
    link_parents(tree.nodes);
    return tree;
}

TreeDivision division_of(const WallTree& tree)
{
    TreeDivision division{{}, tree.original, tree.edge_bits};
    division.nodes.reserve(tree.nodes.size());
    for (const TreeNode& node : tree.nodes)
        division.nodes.push_back({node.left_or_first, SEL_IS_INNER(node.count) ? 0 : node.count});
    return division;
}

std::optional<WallTree> divided_wall_tree(const WallMesh& mesh, TreeDivision division)
{
    if (mesh.triangles.empty() || !is_division(division, mesh.triangles.size())) return std::nullopt;
    WallTree tree;
    tree.centre = centre_of(mesh);
    tree.nodes.resize(division.nodes.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        tree.nodes[i].left_or_first = division.nodes[i][0];
        tree.nodes[i].count = division.nodes[i][1];
    }
    tree.original = std::move(division.original);
    tree.edge_bits = std::move(division.edge_bits);
    write_triangles(tree, mesh);
    tree.depth = write_boxes(tree);
    link_parents(tree.nodes);
    return tree;
}

}  // namespace seldinger
