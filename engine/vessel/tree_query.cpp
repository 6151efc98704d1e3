// Queries of the wall's tree on the host, in double precision on the rounded wall.
#include "core/check.h"
#include "vessel/tree.h"

#include <algorithm>
#include <cmath>

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

/// Squared distances to the contents of nodes, or lower bounds. @param far  above this any answer above it will do
double least_distance2(const WallTree& tree, const TreeSlab* slabs, std::uint32_t node, const Vec3& p, double far)
{
    if (!slabs) return box_distance2(tree.nodes[node], p);
    const TreeSlab& slab = slabs[node];  // first: most nodes end here, and their boxes stay out of the cache
    const double above = slab.normal[0] * p[0] + slab.normal[1] * p[1] + slab.normal[2] * p[2] - slab.highest;
    const double plane = above > 0 ? above * above : 0.0;
    return plane > far ? plane : std::max(plane, box_distance2(tree.nodes[node], p));
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

}  // namespace

TreeHit nearest_on_wall(const WallTree& tree, const Vec3& p, double limit, std::uint64_t* visits, std::int64_t guess)
{
    TreeHit best;
    best.distance2 = limit * limit;
    if (tree.nodes.empty()) return best;
    const Vec3 local = p - tree.centre;
    const auto look_at = [&](std::uint32_t k) {
        const ClosestPoint c = closest_point(local, tree.triangle(k));
        const double d2 = (local - c.point).squaredNorm();
        if (d2 < best.distance2 || (d2 == best.distance2 && (best.triangle < 0 || k < best.triangle)))
            best = {d2, k, c.point, c.feature};
    };
    if (guess >= 0) look_at(static_cast<std::uint32_t>(guess));
    const TreeSlab* slabs = tree.slabs.empty() ? nullptr : tree.slabs.data();
    std::uint32_t stack[SEL_TREE_STACK];
    double entry[SEL_TREE_STACK];
    int top = 0;
    std::uint64_t looked_at = 0;
    std::uint32_t current = 0;
    double current_entry = 0;
    while (true) {
        if (current_entry <= best.distance2) {
            const TreeNode& node = tree.nodes[current];
            ++looked_at;
            if (node.count > 0) {
                looked_at += SEL_LEAF_TRIANGLES(node.count);
                for (std::uint32_t k = node.left_or_first; k < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++k)
                    look_at(k);
            } else {
                looked_at += 2;
                const std::uint32_t left = node.left_or_first;
                const double dl = least_distance2(tree, slabs, left, local, best.distance2),
                             dr = least_distance2(tree, slabs, left + 1, local, best.distance2);
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
    if (visits) *visits += looked_at;
    best.point += tree.centre;
    return best;
}

double first_hit(const WallTree& tree, const Vec3& origin, const Vec3& direction, double skip, std::uint64_t* visits)
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
        if (node.count > 0) {
            looked_at += SEL_LEAF_TRIANGLES(node.count);
            for (std::uint32_t k = node.left_or_first; k < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++k) {
                const double t = ray_triangle(local, direction, tree.triangle(k));
                if (t >= skip && t < best) best = t;
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

void overlapping_triangles(const WallTree& tree, const Vec3& lo, const Vec3& hi, std::vector<std::uint32_t>& result)
{
    result.clear();
    if (tree.nodes.empty()) return;
    const Vec3 local_lo = lo - tree.centre, local_hi = hi - tree.centre;
    std::uint32_t stack[SEL_TREE_STACK + 1];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const TreeNode& node = tree.nodes[stack[--top]];
        bool apart = false;
        for (int d = 0; d < 3; ++d) apart |= node.lo[d] > local_hi[d] || node.hi[d] < local_lo[d];
        if (apart) continue;
        if (node.count > 0) {
            for (std::uint32_t k = node.left_or_first; k < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++k)
                result.push_back(k);
            continue;
        }
        stack[top++] = node.left_or_first + 1;
        stack[top++] = node.left_or_first;
    }
    // leaf ranges come in increasing order only within a subtree's own items; the caller is promised order
    std::sort(result.begin(), result.end());
}

}  // namespace seldinger
