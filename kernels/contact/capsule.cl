// Capsule contact: cells near a sample, evaluation and reduction to edges.
//   launch  engine/contact/capsule.cpp       test  tests/contact/test_twin.cpp
#include "shared/contact_sample.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// A hint where one item is a work-group, that is on a CPU: the records of a thousand wires do not fit its caches, and which come
// next only the list knows. (PoCL's own prefetch() does nothing.)
#if SEL_WORKGROUP == 1 && defined(__clang__)
    #define SEL_AHEAD 4  // items: a third of a microsecond each
static inline void ahead(const __global void* at, uint bytes)
{
    for (uint k = 0; k < bytes; k += 64) __builtin_prefetch((const __global char*)at + k);
}
#else
    #define SEL_AHEAD 0
static inline void ahead(const __global void* at, uint bytes) {}
#endif

// Cells of the tree near listed samples (walk.h).
//   item    one entry of `list`; range rounded up to the work-group size
//   reads   list [item_count] sample index; models, places [samples]; hi, lo [nodes][3] [m]; tree; vertices [T][9] [m]
//   writes  clearances [samples]; cells [samples][slots], counts [samples], found [item_count]: how many hold what is within
//   radius + reach + slack, also beyond `slots`; 0: nothing is
SEL_KERNEL void contact_find(const ContactParams par, const real slack, __global const uint* restrict list,
                             __global const SampleModel* restrict models, __global const SamplePlace* restrict places,
                             __global const float* restrict hi, __global const real* restrict lo,
                             __global const TreeNode* restrict nodes, __global const float* restrict vertices,
                             __global uint* restrict cells, __global uint* restrict counts, __global uint* restrict found,
                             __global Clearance* restrict clearances)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        const AxisPoint at = axis_point(places[s].edge, places[s].bary, hi, lo);
        const real radius = models[s].radius, range = radius + models[s].reach + slack;
        const uint count = find_cells(at.offset, at.origin, range, SEL_CELL_SIZE * radius, nodes, vertices, par.slots,
                                      cells + (ulong)s * par.slots);
        counts[s] = found[item] = count;
        clearances[s] = found_clearance(at.origin + at.offset, range, slack, radius, count);
    }
}

// How far listed samples are from the wall.
//   item    one entry of `list`
//   reads   list [item_count]; places [samples]; hi, lo; tree; vertices     writes  distances [item_count] [m], at most `most`
SEL_KERNEL void contact_distance(const uint item_count, const real most, __global const uint* restrict list,
                                 __global const SamplePlace* restrict places, __global const float* restrict hi,
                                 __global const real* restrict lo, __global const TreeNode* restrict nodes,
                                 __global const float* restrict vertices, __global real* restrict distances)
{
    const uint item = get_global_id(0);
    if (item < item_count) {
        const AxisPoint at = axis_point(places[list[item]].edge, places[list[item]].bary, hi, lo);
        distances[item] = wall_distance(at.origin + at.offset, most, nodes, vertices);
    }
}

// Forces of active samples.
//   item    one entry of `list` (samples with cells, ordered by wire and edge)
//   reads   ... and touches_t0, hard [samples][2]; clearances [samples]
//   writes  forces, barys [item_count]; touches [samples][2]; clearances
SEL_KERNEL void contact_evaluate(
    const ContactParams par, __global const uint* restrict list, __global const SampleModel* restrict models,
    __global const SamplePlace* restrict places, __global const uint* restrict cells, __global const uint* restrict counts,
    __global const TreeNode* restrict nodes, __global const float* restrict vertices, __global const uint* restrict rims,
    __global const float* restrict hi, __global const real* restrict lo, __global const real* restrict theta,
    __global const float* restrict hi_t0, __global const real* restrict lo_t0, __global const real* restrict theta_t0,
    __global const TouchState* restrict touches_t0, __global TouchState* restrict touches, __global SampleForce* restrict forces,
    __global real* restrict barys, __global const HardState* restrict hard, __global Clearance* restrict clearances)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        if (SEL_AHEAD > 0 && item + SEL_AHEAD < par.item_count) {
            const uint then = list[item + SEL_AHEAD];
            ahead(touches_t0 + 2 * then, 2 * sizeof(TouchState));
            ahead(touches + 2 * then, 2 * sizeof(TouchState));
            ahead(models + then, sizeof(SampleModel));
            ahead(forces + item + SEL_AHEAD, sizeof(SampleForce));
        }
        write_force(sample_force(s, par, models[s], places[s], cells + (ulong)s * par.slots, counts[s], nodes, vertices, rims, hi,
                                 lo, theta, hi_t0, lo_t0, theta_t0, touches_t0, touches, hard, clearances + s),
                    forces + item);
        barys[item] = places[s].bary;
    }
}

// Segmented sum of forces and tangents: one edge per item, samples in order, so the same bits come from any number of threads.
//   item    one active edge; its samples are first[item] .. first[item + 1] - 1
//   reads   first [item_count + 1]; forces, barys      writes  edges [item_count]
SEL_KERNEL void contact_reduce(const uint item_count, __global const uint* restrict first,
                               __global const SampleForce* restrict forces, __global const real* restrict barys,
                               __global EdgeForce* restrict edges)
{
    const uint item = get_global_id(0);
    if (item < item_count) edges[item] = reduce_edge(forces, barys, first[item], first[item + 1]);
}
