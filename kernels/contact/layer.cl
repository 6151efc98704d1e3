// The published layer detection: pairs of an edge, and their forces. Reduction: contact_reduce in capsule.cl.
//   launch  engine/contact/layer.cpp       test  tests/contact/test_layer.cpp, tests/contact/test_twin.cpp
#include "shared/layer.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// Steps 1-5 for every edge.
//   item    one edge; range rounded up to the work-group size
//   reads   edges [item_count]; hi, lo [nodes][3]; tree; vertices [T][9]
//   writes  candidates [item_count][slots], counts [item_count]: how many were found, also beyond `slots`;
//           touching [item_count] L' [m]
SEL_KERNEL void layer_find(const ContactParams par, __global const LayerEdge* restrict edges, __global const float* restrict hi,
                           __global const real* restrict lo, __global const TreeNode* restrict nodes,
                           __global const float* restrict vertices, __global uint* restrict candidates,
                           __global uint* restrict counts, __global real* restrict touching)
{
    const uint item = get_global_id(0);
    if (item < par.item_count)
        counts[item] =
            find_pairs(edges[item], hi, lo, nodes, vertices, par.slots, candidates + (ulong)item * par.slots, touching + item);
}

// Forces of pairs.
//   item    one pair, ordered by edge and triangle
//   reads   pairs [item_count]; edges; touches_t0 of the last step's pairs      writes  touches, forces, barys [item_count]
SEL_KERNEL void layer_evaluate(const ContactParams par, __global const LayerPair* restrict pairs,
                               __global const LayerEdge* restrict edges, __global const float* restrict vertices,
                               __global const float* restrict hi, __global const real* restrict lo,
                               __global const real* restrict theta, __global const float* restrict hi_t0,
                               __global const real* restrict lo_t0, __global const real* restrict theta_t0,
                               __global const TouchState* restrict touches_t0, __global TouchState* restrict touches,
                               __global SampleForce* restrict forces, __global real* restrict barys)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        real bary;
        write_force(evaluate_pair(item, par, pairs[item], edges[pairs[item].edge], vertices, hi, lo, theta, hi_t0, lo_t0, theta_t0,
                                  touches_t0, touches, &bary),
                    forces + item);
        barys[item] = bary;
    }
}
