#ifndef SEL_SHARED_TREE_TYPES_H
#define SEL_SHARED_TREE_TYPES_H
// Layout of the wall's AABB tree, read by C++ and by OpenCL C. Built by engine/bodies/vessel/tree.cpp.
//
// Coordinates are float32 relative to the tree's centre (WallTree::centre, double, world frame): a vertex is rounded once,
// and the rounded triangle IS the wall from then on. Boxes are the exact minima and maxima of those floats, so a
// box holds its triangles with no margin to add.
#include "shared/portable.h"

SEL_BEGIN

// Levels that a traversal on the host may have to remember; kernels climb (walk.h). Each level of the tree pushes at most one
// sibling, and the builder keeps leaves at depth < SEL_TREE_STACK (root: depth 0) whatever the mesh.
#define SEL_TREE_STACK 48
#define SEL_TREE_LEAF 4  // most triangles in a leaf
#define SEL_LEAF_TRIANGLES(count) ((count)&7u)
#define SEL_IS_INNER(count) (SEL_LEAF_TRIANGLES(count) == 0)
#define SEL_PARENT(count) ((count) >> 3)         // of an inner node that is not the root
#define SEL_IS_RIGHT(index) (((index)&1u) == 0)  // child; the root counts as one
#define SEL_SLAB_STEPS 510

// Inner node: three bits of `count` are 0, the others are the index of its parent (0 at the root). Children at left_or_first,
// which is odd, and left_or_first + 1, always behind their parent.
// Leaf: SEL_LEAF_TRIANGLES(count) > 0 triangles from left_or_first on, in leaf order. The other 29 bits are the leaf's
// slab: between which two planes its triangles lie. A box round a slanting piece of wall is as thick as it is wide. The slab is
// as thin as the wall is flat, so that a point near the wall sees which of many small leaves can be nearest. Slabs of inner
// nodes save 1/3 of the boxes and cost as much work in slabs.
//   bits 3-12, 13-22   unit normal n = (2a, 2b, 1 - c)/(1 + c), c = a^2 + b^2 (stereographic, either sign): a, b by SEL_SLAB_TURN
//        23-31         k > 0: |n . (x - centre of the box)| <= (k - 1)/510 of the sum of the box's half extents; 0: no slab
#define SEL_HAS_SLAB(count) ((count) >> 23)
#define SEL_SLAB_TURN(bits) ((real)(bits) * (real)(1 / 511.5) - 1)
#define SEL_SLAB_HEIGHT(count, half_extents) (((real)((count) >> 23) - 1) * (real)(1.0 / SEL_SLAB_STEPS) * (half_extents))

typedef struct TreeNode {
    float lo[3];  // [m], relative to the tree's centre
    uint left_or_first;
    float hi[3];  // [m]
    uint count;
} TreeNode;  // 32 bytes

// Bits of WallTree::edge_bits, one byte a triangle: edge e runs from vertex e to vertex (e + 1) % 3.
#define SEL_EDGE_IS_OPENING(bits, e) (((bits) >> (e)) & 1u)  // no neighbour there: the boundary feature of an opening

#ifdef __cplusplus
static_assert(sizeof(TreeNode) == 32, "layout shared with kernels");
#endif
SEL_END
#endif
