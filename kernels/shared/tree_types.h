#ifndef SEL_SHARED_TREE_TYPES_H
#define SEL_SHARED_TREE_TYPES_H
// Layout of the wall's AABB tree, read by C++ and by OpenCL C. Built by engine/vessel/tree.cpp.
//
// Coordinates are float32 relative to the tree's centre (WallTree::centre, double, world frame): a vertex is rounded once,
// and the rounded triangle IS the wall from then on. Boxes are the exact minima and maxima of those floats, so a
// box holds its triangles with no margin to add.
#ifdef __cplusplus
    #include <cstdint>
namespace seldinger {
using uint = std::uint32_t;
#endif

// Levels a traversal may have to remember. Each level of the tree pushes at most one sibling, and the builder keeps
// leaves at depth < SEL_TREE_STACK (root: depth 0) whatever the mesh.
#define SEL_TREE_STACK 48
#define SEL_TREE_LEAF 4  // most triangles in a leaf

// count == 0: inner node, children at left_or_first and left_or_first + 1 (always behind their parent).
// count  > 0: leaf, triangles left_or_first ... left_or_first + count - 1 in leaf order.
typedef struct TreeNode {
    float lo[3];         // [m], relative to the tree's centre
    uint left_or_first;
    float hi[3];         // [m]
    uint count;
} TreeNode;              // 32 bytes

// Bits of WallTree::edge_bits, one byte a triangle: edge e runs from vertex e to vertex (e + 1) % 3.
#define SEL_EDGE_IS_OPENING(bits, e) (((bits) >> (e)) & 1u)  // no neighbour there: the rim of an opening

#ifdef __cplusplus
static_assert(sizeof(TreeNode) == 32, "layout shared with kernels");
}  // namespace seldinger
#endif
#endif
