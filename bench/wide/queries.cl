// The two queries that bench/peers compares with other libraries.
//   launch  bench/peers/ours.cpp       test  tests/bench/test_wide_walk.cpp, bench/peers (every answer against the others')
#include "wide/wide_walk.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// All triangles within a distance of a capsule's axis.
//   item    one query; range rounded up to the work-group size
//   reads   queries [item_count]; nodes; vertices of the leaves [m]
//   writes  found [item_count][slots] triangles in leaf order; counts [item_count], also beyond `slots`
SEL_KERNEL void query_capsule(const uint item_count, const uint slots, __global const CapsuleQuery* restrict queries,
                              __global const WideNode* restrict nodes, __global const float* restrict vertices,
                              __global uint* restrict found, __global uint* restrict counts)
{
    const uint item = get_global_id(0);
    if (item < item_count) counts[item] = find_within(queries[item], nodes, vertices, slots, found + (ulong)item * slots);
}

// Nearest point of the mesh.
//   item    one query      reads  points [item_count][3] [m]; nodes; vertices of the leaves [m]
//   writes  nearest [item_count][3] [m], triangles [item_count] in leaf order
SEL_KERNEL void query_nearest(const uint item_count, __global const real* restrict points,
                              __global const WideNode* restrict nodes, __global const float* restrict vertices,
                              __global real* restrict nearest, __global uint* restrict triangles)
{
    const uint item = get_global_id(0);
    if (item < item_count) {
        const vec3 p = make_vec3(points[3 * item], points[3 * item + 1], points[3 * item + 2]);
        vec3 closest;
        triangles[item] = find_nearest(p, nodes, vertices, &closest);
        nearest[3 * item] = closest.x;
        nearest[3 * item + 1] = closest.y;
        nearest[3 * item + 2] = closest.z;
    }
}
