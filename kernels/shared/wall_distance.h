// Distance of a point from the whole wall.
#ifndef SEL_SHARED_WALL_DISTANCE_H
#define SEL_SHARED_WALL_DISTANCE_H
#include "shared/tree_types.h"
#include "shared/triangle.h"
#include "shared/views.h"

SEL_BEGIN

// Least squared distance from p to a box.
SEL_FN real box_distance2(vec3 p, TreeNode box)
{
    const real x = max_r(max_r((real)box.lo[0] - p.x, p.x - (real)box.hi[0]), 0);
    const real y = max_r(max_r((real)box.lo[1] - p.y, p.y - (real)box.hi[1]), 0);
    const real z = max_r(max_r((real)box.lo[2] - p.z, p.z - (real)box.hi[2]), 0);
    return x * x + y * y + z * z;
}

// Boxes that are not nearer than this part of the least distance so far are not opened.
#define SEL_DISTANCE_PART ((real)0.9)

// A lower bound of the distance from p to the wall, at least SEL_DISTANCE_PART of it; `most` if nothing is nearer.
SEL_PART real wall_distance(vec3 p, real most, WallView wall)
{
    const vec3 zero = make_vec3(0, 0, 0);
    real best2 = most * most, closed2 = best2;  // of triangles; of boxes that stay closed
    if (box_distance2(p, wall.nodes[0]) >= best2) return sqrt(best2);
    uint at = 0, parent = 0;
    const real part2 = SEL_DISTANCE_PART * SEL_DISTANCE_PART;
    ulong aside = 0;  // a bit of every level on the way down: the farther child is still to be looked at
    for (;;) {
        const TreeNode node = wall.nodes[at];
        if (SEL_IS_INNER(node.count)) {  // the nearer child is looked at first
            const uint left = node.left_or_first;
            const real to_left = box_distance2(p, wall.nodes[left]), to_right = box_distance2(p, wall.nodes[left + 1]);
            const real nearer2 = min_r(to_left, to_right);
            if (nearer2 < part2 * best2) {
                parent = at;
                at = to_right < to_left ? left + 1 : left;
                aside = aside << 1 | 1;
                continue;
            }
            closed2 = min_r(closed2, nearer2);
        } else {
            for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) {
                int feature;
                const vec3 v = p - closest_on_triangle(p, load_triangle(wall.vertices, node.left_or_first + k, zero), &feature);
                best2 = min_r(best2, dot3(v, v));
            }
        }
        for (;;) {
            while (at != 0 && (aside & 1) == 0) {
                at = parent;
                parent = SEL_PARENT(wall.nodes[at].count);
                aside >>= 1;
            }
            if (at == 0) return sqrt(min_r(best2, closed2));
            at = SEL_IS_RIGHT(at) ? at - 1 : at + 1;
            aside ^= 1;
            const real here2 = box_distance2(p, wall.nodes[at]);
            if (here2 < part2 * best2) break;
            closed2 = min_r(closed2, here2);
        }
    }
}

SEL_END
#endif
