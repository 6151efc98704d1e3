// Start of a step with the barrier law, and the largest feasible step of a trial.
//   launch  engine/physics/contact/barrier_path.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/barrier_path.h"
#include "shared/kernel.h"
#include "shared/sweep.h"

#if !SEL_SUMS_IN_MEMORY

// Nearest gap at the start of a step; in stages: contact_all to contact_gap of evaluation.cl.
//   item    one entry of `list` (quadrature points with near nodes); range rounded up to the work-group size
//   reads   list [item_count]; models, places, counts [points]; near_cells [points][slots]; wall; nodes; states_t0 [points][2]
//   writes  gaps [item_count] [m]
SEL_KERNEL void contact_clearance(const ContactParams par, __global const uint* restrict list,
                                  __global const QuadratureModel* restrict models,
                                  __global const QuadraturePlace* restrict places, __global const uint* restrict near_cells,
                                  __global const uint* restrict counts, SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS(node),
                                  __global const ContactState* restrict states_t0, __global real* restrict gaps)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        const NearWallView near = near_wall_view(SEL_WALL, near_cells + (ulong)s * par.slots, counts[s]);
        gaps[item] = gap_of_point(point_view(s, models[s], places[s], near), par, SEL_NODES(node), states_t0);
    }
}

#endif

// Continuous detection from the last state that was taken to the trial.
//   item    one entry of `list`
//   reads   as contact_clearance, and base: nodes of the last state taken      writes  free_way [item_count]
SEL_WALK_KERNEL void contact_sweep(const ContactParams par, __global const uint* restrict list,
                                   __global const QuadratureModel* restrict models,
                                   __global const QuadraturePlace* restrict places, __global const uint* restrict near_cells,
                                   __global const uint* restrict counts, SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS(base),
                                   SEL_NODE_ARGUMENTS(node), __global real* restrict free_way)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        const QuadraturePlace place = places[s];
        const NearWallView near = near_wall_view(SEL_WALL, near_cells + (ulong)s * par.slots, counts[s]);
        free_way[item] =
            sweep_point(axis_point(place.edge, place.bary, SEL_NODES(base)), axis_point(place.edge, place.bary, SEL_NODES(node)),
                        models[s].radius - place.radius_reduction, near);
    }
}
