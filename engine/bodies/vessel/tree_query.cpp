// Queries of the wall's tree on the host, in double precision on the rounded wall.
#include "core/check.h"
#include "vessel/tree.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

double box_distance2(const TreeNode& node, const Vec3& p)
{
    double sum = 0;
    for (int d = 0; d < 3; ++d) {
        const double outside = std::max({node.lo[d] - p[d], 0.0, p[d] - node.hi[d]});
        sum += outside * outside;
    }
    return sum;
}

/// Entry distance of the ray into the box, infinity when it misses it.
double box_entry(const TreeNode& node, const Vec3& origin, const Vec3& inverse)
{
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    for (int d = 0; d < 3; ++d) {
        if (std::isinf(inverse[d])) {  // the ray runs along this slab: 0 * infinity must not decide
            if (origin[d] < node.lo[d] || origin[d] > node.hi[d]) return std::numeric_limits<double>::infinity();
            continue;
        }
        const double a = (node.lo[d] - origin[d]) * inverse[d], b = (node.hi[d] - origin[d]) * inverse[d];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    // widened by the rounding of the six products, so that a ray along a face is not lost
    return enter <= leave * (1 + 1e-14) ? enter : std::numeric_limits<double>::infinity();
}

/// Ray parameter of the hit, infinity when missed [Moeller & Trumbore 1997, doi:10.1080/10867651.1997.10487468].
double ray_triangle(const Vec3& origin, const Vec3& direction, const Triangle3& t)
{
    const Vec3 ab = t.b - t.a, ac = t.c - t.a, h = direction.cross(ac);
    const double det = ab.dot(h);
    const double miss = std::numeric_limits<double>::infinity();
    if (det == 0) return miss;
    const Vec3 s = origin - t.a;
    const double u = s.dot(h) / det;
    if (!(u >= 0 && u <= 1)) return miss;
    const Vec3 q = s.cross(ab);
    const double v = direction.dot(q) / det;
    if (!(v >= 0 && u + v <= 1)) return miss;
    return ac.dot(q) / det;
}

/// Descends the tree from the root, nearer parts first, and skips parts farther away than the best so far.
struct NearestSearch {
    using Four = Eigen::Array4f;

    NearestSearch(const WallTree& wall, const Vec3& from, double limit) : tree(wall), local(from)
    {
        best.distance2 = limit * limit;
    }

    void look_at(std::uint32_t k)
    {
        const ClosestPoint c = closest_point(local, tree.triangle(k));
        const double d2 = (local - c.point).squaredNorm();
        if (d2 < best.distance2 || (d2 == best.distance2 && (best.triangle < 0 || k < best.triangle)))
            best = {d2, k, c.point, c.feature};
    }
    void look_at(std::uint32_t first, std::uint32_t count)
    {
        looked_at += 1 + count;
        for (std::uint32_t k = first; k < first + count; ++k) look_at(k);
    }

    void by_boxes()
    {
        std::uint32_t stack[SEL_TREE_STACK];
        double entry[SEL_TREE_STACK];
        int top = 0;
        std::uint32_t current = 0;
        double current_entry = 0;
        while (true) {
            if (current_entry <= best.distance2) {
                const TreeNode& node = tree.nodes[current];
                if (!SEL_IS_INNER(node.count)) {
                    look_at(node.left_or_first, SEL_LEAF_TRIANGLES(node.count));
                } else {
                    looked_at += 3;
                    const std::uint32_t left = node.left_or_first;
                    const double dl = box_distance2(tree.nodes[left], local), dr = box_distance2(tree.nodes[left + 1], local);
                    const bool left_first = dl <= dr;
                    const double nearer = left_first ? dl : dr, other = left_first ? dr : dl;
                    if (other <= best.distance2) {
                        SEL_ASSERT(top < SEL_TREE_STACK);
                        stack[top] = left_first ? left + 1 : left;
                        entry[top++] = other;
                    }
                    if (nearer <= best.distance2) {
                        current = left_first ? left : left + 1;
                        current_entry = nearer;
                        continue;
                    }
                }
            }
            if (top == 0) break;
            current = stack[--top];
            current_entry = entry[top];
        }
    }

    /// Bounds in float, lowered by their rounding (tree_quads.cpp): parts that they exclude are farther away in double, too.
    void by_quads(std::span<const TreeQuad> quads)
    {
        struct Entry {
            std::uint32_t child;
            float distance2;
        };
        Entry stack[2 * SEL_TREE_STACK];  // three for every two levels
        int top = 0;
        const float p[3] = {static_cast<float>(local[0]), static_cast<float>(local[1]), static_cast<float>(local[2])};
        for (std::uint32_t current = 0;;) {
            if (current & TreeQuad::leaf) {
                look_at(current & TreeQuad::first_triangle, (current >> TreeQuad::count_shift & 3) + 1);
            } else {
                looked_at += 5;
                const TreeQuad& quad = quads[current];
                const Four distance2 = quad_distance2(quad, p);
                const float far = farthest();
                Entry nearest{0, std::numeric_limits<float>::infinity()};
                for (int k = 0; k < 4; ++k) {
                    Entry entry{quad.child[k], distance2[k]};
                    if (!(entry.distance2 <= far)) continue;
                    if (entry.distance2 < nearest.distance2) std::swap(entry, nearest);
                    if (entry.distance2 <= far) stack[top++] = entry;
                }
                SEL_ASSERT(top <= 2 * SEL_TREE_STACK - 3);
                if (nearest.distance2 <= far) {
                    current = nearest.child;
                    continue;
                }
            }
            const float far = farthest();
            while (top > 0 && stack[top - 1].distance2 > far) --top;
            if (top == 0) break;
            current = stack[--top].child;
        }
    }

    const WallTree& tree;
    Vec3 local;  // relative to the tree's centre
    TreeHit best;
    std::uint64_t looked_at = 0;

private:

    /// Bounds above this are above the best, and finite.
    [[nodiscard]] float farthest() const
    {
        return static_cast<float>(std::min(best.distance2 * (1 + 2e-7), static_cast<double>(std::numeric_limits<float>::max())));
    }

    static Four four(const float (&values)[4]) { return Eigen::Map<const Four, Eigen::Aligned16>(values); }

    /// Squared distances of the point from the quad's descendants, never more than the true ones.
    static Four quad_distance2(const TreeQuad& quad, const float (&p)[3])
    {
        const Four x = p[0] - four(quad.centre[0]), y = p[1] - four(quad.centre[1]), z = p[2] - four(quad.centre[2]);
        const Four height = four(quad.normal[0]) * x + four(quad.normal[1]) * y + four(quad.normal[2]) * z;
        // the difference of squares, less its rounding of 15 u of the first and what the normal's length adds to the second
        const Four aside2 = (1 - 1e-6f) * (x * x + y * y + z * z) - (1 + 1e-6f) * (height * height);
        const Four along = (height - four(quad.highest)).max(four(quad.lowest) - height).max(0.0f),
                   aside = (aside2.max(0.0f).sqrt() - four(quad.reach)).max(0.0f);
        return (1 - 1e-6f) * (along * along + aside * aside);
    }
};

/// All triangles (leaf order) in the leaves to which `is_near` leads. @return nodes that it was asked about
template <class IsNear>
std::uint64_t triangles_of_leaves(const WallTree& tree, std::vector<std::uint32_t>& result, IsNear is_near)
{
    result.clear();
    if (tree.nodes.empty()) return 0;
    std::uint32_t stack[SEL_TREE_STACK + 1];
    int top = 0;
    std::uint64_t asked = 0;
    stack[top++] = 0;
    while (top > 0) {
        const TreeNode& node = tree.nodes[stack[--top]];
        ++asked;
        if (!is_near(node)) continue;
        if (!SEL_IS_INNER(node.count)) {
            for (std::uint32_t k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) result.push_back(node.left_or_first + k);
            continue;
        }
        SEL_ASSERT(top + 2 <= SEL_TREE_STACK + 1);
        stack[top++] = node.left_or_first + 1;
        stack[top++] = node.left_or_first;
    }
    return asked;
}

}  // namespace

TreeHit nearest_on_wall(const WallTree& tree, const Vec3& p, double limit, std::uint64_t* visits, std::int64_t guess,
                        std::span<const TreeQuad> quads)
{
    if (tree.nodes.empty()) {
        TreeHit nothing;
        nothing.distance2 = limit * limit;
        return nothing;
    }
    NearestSearch search(tree, p - tree.centre, limit);
    if (guess >= 0) search.look_at(static_cast<std::uint32_t>(guess));
    // farther away, floats are not fine enough for quads (tree_quads.cpp)
    if (!quads.empty() && search.local.cwiseAbs().maxCoeff() <= tree.extent()) search.by_quads(quads);
    else search.by_boxes();
    if (visits) *visits += search.looked_at;
    search.best.point += tree.centre;
    return search.best;
}

double first_hit(const WallTree& tree, const Vec3& origin, const Vec3& direction, double skip, std::uint64_t* visits,
                 std::int64_t* triangle)
{
    double best = std::numeric_limits<double>::infinity();
    if (tree.nodes.empty()) return best;
    const Vec3 local = origin - tree.centre, inverse = Vec3::Constant(1).cwiseQuotient(direction);
    std::uint32_t stack[SEL_TREE_STACK + 1];
    int top = 0;
    std::uint64_t looked_at = 0;
    stack[top++] = 0;
    while (top > 0) {
        const TreeNode& node = tree.nodes[stack[--top]];
        ++looked_at;
        if (!(box_entry(node, local, inverse) < best)) continue;
        if (!SEL_IS_INNER(node.count)) {
            looked_at += SEL_LEAF_TRIANGLES(node.count);
            for (std::uint32_t k = node.left_or_first; k < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++k) {
                const double t = ray_triangle(local, direction, tree.triangle(k));
                if (!(t >= skip && t < best)) continue;
                best = t;
                if (triangle) *triangle = static_cast<std::int64_t>(k);
            }
            continue;
        }
        const bool left_first = box_entry(tree.nodes[node.left_or_first], local, inverse) <=
                                box_entry(tree.nodes[node.left_or_first + 1], local, inverse);
        SEL_ASSERT(top + 2 <= SEL_TREE_STACK + 1);
        stack[top++] = node.left_or_first + (left_first ? 1 : 0);
        stack[top++] = node.left_or_first + (left_first ? 0 : 1);
    }
    if (visits) *visits += looked_at;
    return best;
}

void triangles_around(const WallTree& tree, const Vec3& p, std::vector<std::uint32_t>& result, std::uint64_t* visits)
{
    const Vec3 local = p - tree.centre;
    const float at[3] = {static_cast<float>(local[0]), static_cast<float>(local[1]), static_cast<float>(local[2])};
    const std::uint64_t nodes = triangles_of_leaves(tree, result, [&](const TreeNode& node) {
        bool inside = true;
        for (int d = 0; d < 3; ++d) inside &= node.lo[d] <= at[d] && at[d] <= node.hi[d];
        return inside;
    });
    if (visits) *visits += nodes + result.size();
}

}  // namespace seldinger
