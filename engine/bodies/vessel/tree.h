#pragma once
// AABB tree over the wall: the flat arrays that kernels read, and the same queries on the host.
//
// Binned surface-area heuristic [Wald 2007, doi:10.1109/RT.2007.4342588], leaves of at most four triangles. Median
// splits take over where the heuristic would let the tree grow deeper than a traversal stack of SEL_TREE_STACK holds.
// Two threads may build it; the result does not depend on them.

#include "shared/tree_types.h"
#include "vessel/triangle_geometry.h"
#include "vessel/wall_mesh.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace seldinger {

/// Up to four descendants of a node: the children of its children, or children that are leaves. A point sees all of them at once.
/// The triangles of one lie in a cylinder along their mean normal: lowest <= normal . (x - centre) <= highest, and at most
/// `reach` from the axis. From the middle of a lumen all of the wall round it is equally near. A box round a slanting piece of
/// wall is as thick as it is wide, and excludes few of thousands of leaves.
struct alignas(16) TreeQuad {
    static constexpr std::uint32_t leaf = 1u << 31, first_triangle = (1u << 29) - 1;
    static constexpr int count_shift = 29;
    float normal[3][4] = {};  // mean of the triangles' normals, into the lumen, a little shorter than 1; 0: a ball instead
    float highest[4] = {}, lowest[4] = {};  // [m]
    float centre[3][4] = {};  // [m], relative to the tree's centre
    float reach[4] = {};      // [m]; -infinity: no descendant
    std::uint32_t child[4] = {};  // index of a quad, or leaf | triangles - 1 << count_shift | first triangle
};

/// The rounded wall and its tree. Arrays in leaf order go to the device as they stand.
struct WallTree {
    Vec3 centre = Vec3::Zero();           // world position of the arrays' origin [m]
    std::vector<TreeNode> nodes;          // root first, children behind their parent; empty without triangles
    std::vector<float> vertices;          // [9 T] leaf order, relative to the centre [m]
    std::vector<float> normals;           // [3 T] leaf order, unit, into the lumen; 0 for a triangle without area
    std::vector<std::uint32_t> original;  // [T] leaf order -> index in WallMesh::triangles
    std::vector<std::uint8_t> edge_bits;  // [T] leaf order, SEL_EDGE_IS_OPENING
    int depth = 0;                        // deepest leaf, root = 0; always < SEL_TREE_STACK

    [[nodiscard]] std::size_t triangle_count() const { return original.size(); }
    /// Sum of the three extents [m].
    [[nodiscard]] double extent() const
    {
        double sum = 0;
        for (int d = 0; d < 3; ++d) sum += static_cast<double>(nodes[0].hi[d]) - nodes[0].lo[d];
        return sum;
    }
    /// Triangle `k` (leaf order) of the rounded wall, relative to the centre.
    [[nodiscard]] Triangle3 triangle(std::size_t k) const
    {
        const float* v = &vertices[9 * k];
        return {Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5]), Vec3(v[6], v[7], v[8])};
    }
};

/// O(T log T). `threads`: 0 uses two when the mesh is large enough to repay them.
[[nodiscard]] WallTree build_wall_tree(const WallMesh& mesh, int threads = 0);

/// What of a tree takes long to find: how it divides its mesh. For files.
struct TreeDivision {
    std::vector<std::array<std::uint32_t, 2>> nodes;  // left_or_first, count
    std::vector<std::uint32_t> original;
    std::vector<std::uint8_t> edge_bits;
};
[[nodiscard]] TreeDivision division_of(const WallTree& tree);
/// The same tree again. Nothing where the division is not one of this mesh. O(T)
[[nodiscard]] std::optional<WallTree> divided_wall_tree(const WallMesh& mesh, TreeDivision division);

/// Bounds for many queries from afar, the root's first: 33 % of the time on fine meshes, with the same answers.
[[nodiscard]] std::vector<TreeQuad> make_quads(const WallTree& tree);

struct TreeHit {
    double distance2 = std::numeric_limits<double>::infinity();  // [m^2]
    std::int64_t triangle = -1;                                  // leaf order; -1: nothing within the limit
    Vec3 point = Vec3::Zero();                                   // world [m]
    TriangleFeature feature = TriangleFeature::Face;
};

/// Nearest point of the wall within `limit` [m] of the world point p; the lower leaf index wins a tie.
/// @param visits  in and out, may be null: the number of visited nodes and triangles is added. Dozens on a vessel's wall, all of
/// them where
///                every box lies in every other
/// @param guess   a triangle that may be near, leaf order; -1: none. It saves time and changes no answer
/// @param quads   of the same tree, or none
[[nodiscard]] TreeHit nearest_on_wall(const WallTree& tree, const Vec3& p, double limit = std::numeric_limits<double>::infinity(),
                                      std::uint64_t* visits = nullptr, std::int64_t guess = -1,
                                      std::span<const TreeQuad> quads = {});

/// Distance along the unit direction to the first triangle that the ray meets, infinity when none. Triangles nearer
/// than `skip` [m] to the origin do not count. @param visits  as above  @param triangle  out, may be null: which one, leaf order
[[nodiscard]] double first_hit(const WallTree& tree, const Vec3& origin, const Vec3& direction, double skip = 0,
                               std::uint64_t* visits = nullptr, std::int64_t* triangle = nullptr);

/// Triangles (leaf order) in the leaves whose boxes the rounded world point lies in: all that have it for a corner, and few
/// others.
/// @param visits  as above
void triangles_around(const WallTree& tree, const Vec3& p, std::vector<std::uint32_t>& result, std::uint64_t* visits = nullptr);

}  // namespace seldinger
