// Layout of the wall on the device: AABB tree and triangle soup in leaf order. Built by engine/vessel/tree.cpp.
#ifndef SEL_SHARED_TREE_TYPES_H
#define SEL_SHARED_TREE_TYPES_H
#include "shared/portable.h"

SEL_BEGIN

// Node of a binary tree, 32 bytes. Inner: count = 0, children at left_or_first and left_or_first + 1. Leaf: triangles
// left_or_first .. + count - 1. Boxes are relative to the mesh centre [m], rounded outward.
typedef struct TreeNode {
    float lo[3];
    uint left_or_first;
    float hi[3];
    uint count;
} TreeNode;

#define SEL_TREE_STACK 48  // entries; the builder proves its depth is below
#define SEL_LEAF_SIZE 4    // most triangles in a leaf

SEL_END
#ifdef __cplusplus
static_assert(sizeof(seldinger::TreeNode) == 32, "layout shared with kernels");
#endif
#endif
