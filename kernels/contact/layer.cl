// The published layer detection: pairs of an edge, and their forces. Their sums: edge_sums.cl.
//   launch  engine/physics/contact/layer.cpp       test  tests/contact/test_layer.cpp, tests/contact/test_host_reference.cpp
#define SEL_LAW_FN SEL_STAGE_CALL
#include "shared/kernel.h"
#include "shared/layer.h"

// Steps 1-5 for every edge.
//   item    one edge; range rounded up to the work-group size
//   reads   edges [item_count]; nodes; wall
//   writes  candidates [item_count][slots], counts [item_count]: how many were found, also beyond `slots`;
//           touching [item_count] L' [m]
SEL_WALK_KERNEL void layer_find(const ContactParams par, __global const LayerEdge* restrict edges, SEL_NODE_ARGUMENTS(node),
                                SEL_WALL_ARGUMENTS, __global uint* restrict candidates, __global uint* restrict counts,
                                __global real* restrict touching)
{
    const uint item = get_global_id(0);
    if (item < par.item_count)
        counts[item] =
            find_pairs(edges[item], SEL_NODES(node), SEL_WALL, par.slots, candidates + (ulong)item * par.slots, touching + item);
}

// Forces of pairs.
//   item    one pair, ordered by edge and triangle
//   reads   pairs [item_count]; edges; wall; nodes, at the trial and at the start of the step; states_t0 of the last step's pairs
//   writes  states, forces, barys [item_count]
SEL_WALK_KERNEL void layer_evaluate(const ContactParams par, __global const LayerPair* restrict pairs,
                               __global const LayerEdge* restrict edges, SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS(node),
                               SEL_NODE_ARGUMENTS(node_t0), __global const ContactState* restrict states_t0,
                               __global ContactState* restrict states, __global ContactForce* restrict forces,
                               __global real* restrict barys)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count) return;
    const LayerPair pair = pairs[item];
    const LayerEdge edge = edges[pair.edge];
    const ContactState old = pair.last != SEL_NO_EDGE ? states_t0[pair.last] : empty_pair(pair.triangle, edge.reach);
#if SEL_SUMS_IN_MEMORY
    evaluate_pair(pair, edge, par, SEL_NODES(node), SEL_NODES(node_t0), wall_vertices, old, states + item, forces + item,
                  barys + item);
#else
    ContactState now;
    ContactForce force;
    evaluate_pair(pair, edge, par, SEL_NODES(node), SEL_NODES(node_t0), wall_vertices, old, &now, &force, barys + item);
    states[item] = now;
    write_force(force, forces + item);
#endif
}
