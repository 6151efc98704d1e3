// What surrounds the solve of a step with the normal laws of shared/hard_law.h.
//   launch  engine/contact/hard_contact.cpp       test  tests/contact/test_twin.cpp
#include "shared/hard_step.h"
#include "shared/sweep.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// Multipliers at the start of a solve.
//   item    one sample; range rounded up to the work-group size
//   reads   models, places [samples]; touches_t0 [samples][2]      writes  hard [samples][2]
SEL_KERNEL void contact_start(const ContactParams par, __global const SampleModel* restrict models,
                              __global const SamplePlace* restrict places, __global const TouchState* restrict touches_t0,
                              __global HardState* restrict hard)
{
    const uint s = get_global_id(0);
    if (s < par.item_count)
        for (uint k = 2 * s; k < 2 * s + 2; ++k) hard[k] = hard_start(touches_t0[k], places[s].stamp, models[s], par);
}

// Multipliers after a solve; those of a sample with no wall near are zero.
//   item    one sample
//   reads   models, places, counts [samples]; touches_t0, touches, hard [samples][2]
//   writes  next [samples][2]; ratios [samples]: largest miss over the one allowed
SEL_KERNEL void contact_multipliers(const ContactParams par, __global const SampleModel* restrict models,
                                    __global const SamplePlace* restrict places, __global const uint* restrict counts,
                                    __global const TouchState* restrict touches_t0, __global const TouchState* restrict touches,
                                    __global const HardState* restrict hard, __global HardState* restrict next,
                                    __global real* restrict ratios)
{
    const uint s = get_global_id(0);
    if (s < par.item_count) {
        TouchState none = touches[2 * s];
        none.flags = 0;
        real ratio = 0;
        for (uint k = 2 * s; k < 2 * s + 2; ++k)
            next[k] =
                hard_next(hard[k], counts[s] > 0 ? touches[k] : none, touches_t0[k], places[s].stamp, models[s], par, &ratio);
        ratios[s] = ratio;
    }
}

// Nearest gap at the start of a step, for the barrier's start.
//   item    one entry of `list` (samples with cells)
//   reads   models, places; cells, counts; the wall; hi, lo [nodes][3]; touches_t0 [samples][2]      writes  gaps [item_count]
//   [m]
SEL_KERNEL void contact_clearance(const ContactParams par, __global const uint* restrict list,
                                  __global const SampleModel* restrict models, __global const SamplePlace* restrict places,
                                  __global const uint* restrict cells, __global const uint* restrict counts,
                                  __global const TreeNode* restrict nodes, __global const float* restrict vertices,
                                  __global const uint* restrict rims, __global const float* restrict hi,
                                  __global const real* restrict lo, __global const TouchState* restrict touches_t0,
                                  __global real* restrict gaps)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        gaps[item] =
            sample_gap(axis_point(places[s].edge, places[s].bary, hi, lo), models[s], par, touches_t0[2 * s],
                       touches_t0[2 * s + 1], places[s].stamp, cells + (ulong)s * par.slots, counts[s], nodes, vertices, rims);
    }
}

// Continuous detection from the last state that was taken to the trial.
//   item    one entry of `list`
//   reads   as contact_clearance, and base_hi, base_lo, hi, lo [nodes][3]      writes  free_way [item_count]
SEL_KERNEL void contact_sweep(const ContactParams par, __global const uint* restrict list,
                              __global const SampleModel* restrict models, __global const SamplePlace* restrict places,
                              __global const uint* restrict cells, __global const uint* restrict counts,
                              __global const TreeNode* restrict nodes, __global const float* restrict vertices,
                              __global const uint* restrict rims, __global const float* restrict base_hi,
                              __global const real* restrict base_lo, __global const float* restrict hi,
                              __global const real* restrict lo, __global real* restrict free_way)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        const SamplePlace place = places[s];
        free_way[item] =
            sweep_sample(axis_point(place.edge, place.bary, base_hi, base_lo), axis_point(place.edge, place.bary, hi, lo),
                         models[s].radius - place.shrink, cells + (ulong)s * par.slots, counts[s], nodes, vertices, rims);
    }
}
