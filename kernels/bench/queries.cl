// The two queries that bench/peers compares with other libraries.
//   launch  bench/peers/ours.cpp       test  bench/peers (every answer against the others')
#include "shared/segment.h"
#include "shared/walk.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// All triangles within a distance of a capsule's axis.
//   item    one query; range rounded up to the work-group size
//   reads   queries [item_count]; nodes; vertices [T][9] [m]
//   writes  found [item_count][slots] triangles in leaf order; counts [item_count], also beyond `slots`
SEL_KERNEL void query_capsule(const uint item_count, const uint slots, __global const CapsuleQuery* restrict queries,
                              __global const TreeNode* restrict nodes, __global const float* restrict vertices,
                              __global uint* restrict found, __global uint* restrict counts)
{
    const uint item = get_global_id(0);
    if (item < item_count) {
        const CapsuleQuery q = queries[item];
        const vec3 a = make_vec3(q.a[0], q.a[1], q.a[2]), b = make_vec3(q.b[0], q.b[1], q.b[2]), zero = make_vec3(0, 0, 0);
        const CapsuleBox capsule = capsule_box(a, b, q.radius);
        const real within2 = q.radius * q.radius;
        uint stack[SEL_TREE_STACK];
        uint top = 0, count = 0;
        stack[top++] = 0;
        while (top > 0) {
            const TreeNode node = nodes[stack[--top]];
            if (!capsule_meets_box(capsule, node)) continue;
            if (node.count == 0) {
                stack[top++] = node.left_or_first + 1;
                stack[top++] = node.left_or_first;
                continue;
            }
            for (uint t = node.left_or_first; t < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++t) {
                if (!segment_within(a, b - a, load_triangle(vertices, t, zero), within2)) continue;
                if (count < slots) found[(ulong)item * slots + count] = t;
                ++count;
            }
        }
        counts[item] = count;
    }
}

// Nearest point of the mesh, by the nearer child first.
//   item    one query      reads  points [item_count][3] [m]      writes  nearest [item_count][3] [m], triangles [item_count] in
//   leaf order
SEL_KERNEL void query_nearest(const uint item_count, __global const real* restrict points,
                              __global const TreeNode* restrict nodes, __global const float* restrict vertices,
                              __global real* restrict nearest, __global uint* restrict triangles)
{
    const uint item = get_global_id(0);
    if (item < item_count) {
        const vec3 p = make_vec3(points[3 * item], points[3 * item + 1], points[3 * item + 2]), zero = make_vec3(0, 0, 0);
        uint stack[SEL_TREE_STACK];
        real entry[SEL_TREE_STACK];
        uint top = 0, best = 0, at = 0;
        real best2 = (real)1e30, here = 0;
        vec3 closest = zero;
        for (;;) {
            const TreeNode node = nodes[at];
            if (here < best2 && node.count == 0) {
                const uint left = node.left_or_first;
                const real dl = box_near2(p, nodes[left], zero), dr = box_near2(p, nodes[left + 1], zero);
                const int left_first = dl <= dr;
                stack[top] = left_first ? left + 1 : left;
                entry[top++] = left_first ? dr : dl;
                at = left_first ? left : left + 1;
                here = left_first ? dl : dr;
                continue;
            }
            if (here < best2)
                for (uint t = node.left_or_first; t < node.left_or_first + SEL_LEAF_TRIANGLES(node.count); ++t) {
                    int feature;
                    const vec3 c = closest_on_triangle(p, load_triangle(vertices, t, zero), &feature), v = p - c;
                    const real d2 = dot3(v, v);
                    if (d2 < best2) {
                        best2 = d2;
                        best = t;
                        closest = c;
                    }
                }
            if (top == 0) break;
            at = stack[--top];
            here = entry[top];
        }
        nearest[3 * item] = closest.x;
        nearest[3 * item + 1] = closest.y;
        nearest[3 * item + 2] = closest.z;
        triangles[item] = best;
    }
}
