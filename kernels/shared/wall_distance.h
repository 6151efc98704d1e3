// Distance of a point from the whole wall.
#ifndef SEL_SHARED_WALL_DISTANCE_H
#define SEL_SHARED_WALL_DISTANCE_H
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

// Distance from p to the nearest triangle, or `most` if none is nearer.
SEL_FN real wall_distance(vec3 p, real most, WallView wall)
{
    const vec3 zero = make_vec3(0, 0, 0);
    real best2 = most * most;
    uint stack[SEL_TREE_STACK];
    real away2[SEL_TREE_STACK];  // of the boxes on the stack
    uint top = 0;
    stack[0] = 0;
    away2[top++] = box_distance2(p, wall.nodes[0]);
    while (top > 0) {
        --top;
        if (away2[top] >= best2) continue;
        const TreeNode node = wall.nodes[stack[top]];
        if (node.count == 0) {  // the nearer child is looked at first
            const uint left = node.left_or_first;
            const real to_left = box_distance2(p, wall.nodes[left]), to_right = box_distance2(p, wall.nodes[left + 1]);
            const uint right_first = to_right < to_left;
            stack[top] = right_first ? left : left + 1;
            away2[top++] = right_first ? to_left : to_right;
            stack[top] = right_first ? left + 1 : left;
            away2[top++] = right_first ? to_right : to_left;
            continue;
        }
        for (uint k = 0; k < SEL_LEAF_TRIANGLES(node.count); ++k) {
            int feature;
            const vec3 v = p - closest_on_triangle(p, load_triangle(wall.vertices, node.left_or_first + k, zero), &feature);
            best2 = min_r(best2, dot3(v, v));
        }
    }
    return sqrt(best2);
}

SEL_END
#endif
