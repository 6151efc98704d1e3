// Walks through small subtrees of the wall's tree ("cells": tree nodes not much larger than the wire is thick), leaf by leaf, in
// the tree's own order. A sample keeps a list of the cells near it; what is asked of the wall at every evaluation walks through
// these alone, and leaves out what is too far. So the lists are as long, and an evaluation as many box tests deep, for three
// million triangles as for thirty thousand (a few more levels), and what is found is the same as if every triangle of the cells
// had been looked at, in the same order.
#ifndef SEL_SHARED_WALK_H
#define SEL_SHARED_WALK_H
#include "shared/tree_types.h"
#include "shared/triangle.h"

SEL_BEGIN

// A cell is a leaf, or a node no longer than this many radii in any direction.
#define SEL_CELL_SIZE 2

// Leaves out boxes by rounded distances: by this fraction too few, so that none is left out that a triangle's own rounded
// distance admits.
#ifdef SEL_FLOAT32
    #define SEL_WALK_MARGIN ((real)1e-4)
#else
    #define SEL_WALK_MARGIN ((real)1e-6)
#endif

typedef struct Walk {
    uint stack[SEL_TREE_STACK];
    uint top, next;  // next: of the cells
} Walk;

// Least squared distance from p to a box; p and the box relative to `origin`.
SEL_FN real box_near2(vec3 p, TreeNode box, vec3 origin)
{
    const real x = max_r(max_r(((real)box.lo[0] - origin.x) - p.x, p.x - ((real)box.hi[0] - origin.x)), 0);
    const real y = max_r(max_r(((real)box.lo[1] - origin.y) - p.y, p.y - ((real)box.hi[1] - origin.y)), 0);
    const real z = max_r(max_r(((real)box.lo[2] - origin.z) - p.z, p.z - ((real)box.hi[2] - origin.z)), 0);
    return x * x + y * y + z * z;
}

// How far a box reaches along `side` beyond p, at most.
SEL_FN real box_beyond(vec3 p, TreeNode box, vec3 origin, vec3 side)
{
    const real x = (side.x > 0 ? (real)box.hi[0] : (real)box.lo[0]) - origin.x - p.x;
    const real y = (side.y > 0 ? (real)box.hi[1] : (real)box.lo[1]) - origin.y - p.y;
    const real z = (side.z > 0 ? (real)box.hi[2] : (real)box.lo[2]) - origin.z - p.z;
    return x * side.x + y * side.y + z * side.z;
}

// Least squared distance from p to what lies in the leaf's slab and within the half diagonal of its box from the box's centre.
SEL_FN real slab_distance2(vec3 p, TreeNode leaf, vec3 origin)
{
    const real ex = ((real)leaf.hi[0] - (real)leaf.lo[0]) / 2, ey = ((real)leaf.hi[1] - (real)leaf.lo[1]) / 2,
               ez = ((real)leaf.hi[2] - (real)leaf.lo[2]) / 2;
    const vec3 q = make_vec3(p.x - ((real)leaf.lo[0] - origin.x) - ex, p.y - ((real)leaf.lo[1] - origin.y) - ey,
                             p.z - ((real)leaf.lo[2] - origin.z) - ez);
    const real a = (real)((leaf.count >> 3) & 1023u) / (real)511.5 - 1, b = (real)((leaf.count >> 13) & 1023u) / (real)511.5 - 1;
    const real x = (a + b) / 2, y = (a - b) / 2;
    const vec3 n = make_vec3(x, y, 1 - fabs(x) - fabs(y));
    const real rho = sqrt(ex * ex + ey * ey + ez * ez),
               half_thickness = (real)((leaf.count >> 23) - 1u) / (real)SEL_SLAB_STEPS * rho;
    const real along = dot3(q, n), height2 = along * along / dot3(n, n);
    const real up = max_r(sqrt(height2) - half_thickness, 0), aside = max_r(sqrt(max_r(dot3(q, q) - height2, 0)) - rho, 0);
    return up * up + aside * aside;
}

// The next leaf whose box is within range2 of p and, unless it is within shell2, reaches beyond p along `side`. @return found one
SEL_FN int next_leaf(Walk* walk, SEL_GLOBAL const uint* cells, uint count, SEL_GLOBAL const TreeNode* nodes, vec3 p, vec3 origin,
                     real range2, real shell2, vec3 side, TreeNode* leaf)
{
    for (;;) {
        if (walk->top == 0) {
            if (walk->next == count) return 0;
            walk->stack[walk->top++] = cells[walk->next++];
        }
        const TreeNode node = nodes[walk->stack[--walk->top]];
        const real d2 = box_near2(p, node, origin);
        if (d2 > range2 || (d2 > shell2 && box_beyond(p, node, origin, side) < 0)) continue;
        if (node.count > 0) {
            if (node.count >> 23) {
                const real nearer2 = slab_distance2(p, node, origin);
                if (nearer2 > range2 || (nearer2 > shell2 && box_beyond(p, node, origin, side) < 0)) continue;
            }
            *leaf = node;
            leaf->count = SEL_LEAF_TRIANGLES(node.count);
            return 1;
        }
        walk->stack[walk->top++] = node.left_or_first + 1;
        walk->stack[walk->top++] = node.left_or_first;
    }
}

// Squared distance from p to triangle t, both relative to `origin`.
SEL_FN real triangle_distance2(vec3 p, vec3 origin, uint t, SEL_GLOBAL const float* vertices)
{
    int feature;
    const vec3 v = p - closest_on_triangle(p, load_triangle(vertices, t, origin), &feature);
    return dot3(v, v);
}

// Is there a triangle within range2 of p in the subtree below `node`?
SEL_FN int any_within(uint node, vec3 p, vec3 origin, real range2, SEL_GLOBAL const TreeNode* nodes,
                      SEL_GLOBAL const float* vertices)
{
    uint stack[SEL_TREE_STACK];
    uint top = 0;
    stack[top++] = node;
    while (top > 0) {
        const TreeNode box = nodes[stack[--top]];
        if (box_near2(p, box, origin) > range2) continue;
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(box.count); ++k)
            if (triangle_distance2(p, origin, box.left_or_first + k, vertices) <= range2) return 1;
        if (box.count > 0) continue;
        stack[top++] = box.left_or_first + 1;
        stack[top++] = box.left_or_first;
    }
    return 0;
}

// Cells that hold every triangle within `range` of p (relative to `origin`), in the tree's own order. Writes at most `slots` of
// them; @return how many there are; 0 where no triangle is within range, however near the boxes are
SEL_FN uint find_cells(vec3 p, vec3 origin, real range, real size, SEL_GLOBAL const TreeNode* nodes,
                       SEL_GLOBAL const float* vertices, uint slots, SEL_GLOBAL uint* found)
{
    const real range2 = range * range;
    uint stack[SEL_TREE_STACK];
    uint top = 0, count = 0;
    int any = 0;
    stack[top++] = 0;
    while (top > 0) {
        const uint at = stack[--top];
        const TreeNode node = nodes[at];
        if (box_near2(p, node, origin) > range2) continue;
        const real x = (real)node.hi[0] - (real)node.lo[0], y = (real)node.hi[1] - (real)node.lo[1],
                   z = (real)node.hi[2] - (real)node.lo[2];
        if (node.count == 0 && (x > size || y > size || z > size)) {
            stack[top++] = node.left_or_first + 1;
            stack[top++] = node.left_or_first;
            continue;
        }
        if (!any) any = any_within(at, p, origin, range2, nodes, vertices);
        if (count < slots) found[count] = at;
        ++count;
    }
    return any ? count : 0;
}

SEL_END
#endif
