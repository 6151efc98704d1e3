// Forces of quadrature points, by any law: in one kernel where an item is a work-group, that is on a CPU, else in stages.
//   launch  engine/physics/contact/force_kernels.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/barrier_path.h"
#include "shared/kernel.h"

// Forces of active quadrature points.
//   item    one entry of `list` (quadrature points with near nodes, ordered by wire and edge); range rounded up to the work-group
//           size
//   reads   list [item_count]; models, places, counts [points]; near_cells [points][slots]; wall; nodes, at the trial and at the
//           start of the step; states_t0, multipliers [points][2]; clearances, memories [points] (stages have no memories)
//   writes  forces, barys [item_count]; states [points][2]; clearances, memories
#define SEL_FORCE_ARGUMENTS                                                                                              \
    __global const uint *restrict list, __global const QuadratureModel *restrict models,                                 \
        __global const QuadraturePlace *restrict places, __global const uint *restrict near_cells,                       \
        __global const uint *restrict counts, SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS(node), SEL_NODE_ARGUMENTS(node_t0), \
        __global const ContactState *restrict states_t0, __global ContactState *restrict states,                         \
        __global ContactForce *restrict forces, __global real *restrict barys,                                           \
        __global const MultiplierState *restrict multipliers, __global Clearance *restrict clearances,                   \
        __global WallMemory *restrict memories

#if !SEL_SUMS_IN_MEMORY

    // A hint. The records of a thousand wires do not fit its caches, and only the list
    // knows the next ones. (PoCL's own prefetch() does nothing.) Only where the compiler's target is the processor
    // itself: SPIR-V has no such instruction, and LLVM's translator to SPIR-V ends the process at it.
    #if defined(__clang__) && (defined(__x86_64__) || defined(__aarch64__))
        #define SEL_AHEAD 4  // items: a third of a microsecond each
static inline void ahead(const __global void* at, uint bytes)
{
    for (uint k = 0; k < bytes; k += 64) __builtin_prefetch((const __global char*)at + k);
}
    #else
        #define SEL_AHEAD 0
static inline void ahead(const __global void* at, uint bytes) {}
    #endif

// An item, whole: a part, so that it is compiled once.
SEL_PART void evaluate_item(const uint item, const ContactParams* params, SEL_FORCE_ARGUMENTS)
{
    const ContactParams par = *params;
    if (item >= par.item_count) return;
    const uint s = list[item];
    if (SEL_AHEAD > 0 && item + SEL_AHEAD < par.item_count) {
        const uint then = list[item + SEL_AHEAD];
        ahead(states_t0 + 2 * then, 2 * sizeof(ContactState));
        ahead(states + 2 * then, 2 * sizeof(ContactState));
        ahead(models + then, sizeof(QuadratureModel));
        ahead(memories + then, sizeof(WallMemory) - (par.returns ? 0u : (uint)sizeof(TouchMemory)));
        ahead(forces + item + SEL_AHEAD, sizeof(ContactForce));
    }
    const NearWallView near = near_wall_view(SEL_WALL, near_cells + (ulong)s * par.slots, counts[s]);
    const PointView point = point_view(s, models[s], places[s], near);
    write_force(contact_force(point, par, SEL_NODES(node), SEL_NODES(node_t0), state_view(states_t0, states, multipliers),
                              clearances + s, memories + s),
                forces + item);
    barys[item] = places[s].bary;
}

SEL_WALK_KERNEL void contact_evaluate(const ContactParams par, SEL_FORCE_ARGUMENTS)
{
    evaluate_item(get_global_id(0), &par, list, models, places, near_cells, counts, wall_nodes, wall_vertices, wall_boundary,
                  node_hi, node_lo, node_theta, node_t0_hi, node_t0_lo, node_t0_theta, states_t0, states, forces, barys,
                  multipliers, clearances, memories);
}

#else

// Stages of the same (shared/contact_stages.h).
//   item    of contact_clear: one entry of `list`; of the others: one of the todo[0] that follow it in `todo`
//   reads   side: 0, the nearer side of the lumen; 1, the opposite one
//   writes  todo: places in `list` of the quadrature points that have to be evaluated, in any order; todo[0] is 0 before.
//           stages [points]
    #define SEL_STAGE(name)                                                                                             \
        SEL_WALK_KERNEL void name(const ContactParams par, SEL_FORCE_ARGUMENTS, __global ContactStage* restrict stages, \
                                  __global uint* restrict todo, const uint side)
    #define SEL_POINT_OF(item)                                             \
        const uint s = list[item];                                         \
        const StateView view = state_view(states_t0, states, multipliers); \
        const PointView point =                                            \
            point_view(s, models[s], places[s], near_wall_view(SEL_WALL, near_cells + (ulong)s * par.slots, counts[s]))
    #define SEL_NEXT_POINT                                                      \
        if (get_global_id(0) >= todo[0]) return;                                \
        const uint item = todo[1 + get_global_id(0)];                           \
        SEL_POINT_OF(item);                                                     \
        const StagedPoint of = staged_point(point, par, SEL_NODES(node), view); \
        __global ContactStage* stage = stages + item

SEL_STAGE(contact_clear)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count) return;
    SEL_POINT_OF(item);
    barys[item] = point.place.bary;
    if (is_clear(point, SEL_NODES(node), view, clearances + s)) write_force(no_force(point.model), forces + item);
    else todo[1 + atomic_inc(todo)] = item;
}

    #define SEL_POINT_STAGE(name, call) \
        SEL_STAGE(name)                 \
        {                               \
            SEL_NEXT_POINT;             \
            call;                       \
        }
    #define SEL_MOVES SEL_NODES(node), SEL_NODES(node_t0)

SEL_POINT_STAGE(contact_nearest, stage_nearest(of, stage))
SEL_POINT_STAGE(contact_behind, stage_behind(of, SEL_MOVES, stage))
SEL_POINT_STAGE(contact_join, stage_join(of, side, stage))
SEL_POINT_STAGE(contact_share, stage_share(of, side, stage))
SEL_POINT_STAGE(contact_oppose, stage_oppose(of, stage))
SEL_STAGE(contact_press)
{
    SEL_NEXT_POINT;
    if (side == 0) start_force(of, stage, states + 2 * s, forces + item);
    stage_press(of, side, SEL_MOVES, stage, states + 2 * s, forces + item);
}
SEL_POINT_STAGE(contact_rub, stage_rub(of, side, SEL_MOVES, stage, states + 2 * s, forces + item))
SEL_POINT_STAGE(contact_tangent, stage_tangent(of, side, SEL_MOVES, stage, states + 2 * s, forces + item))
SEL_POINT_STAGE(contact_roll, stage_roll(of, side, SEL_MOVES, stage, states + 2 * s, forces + item))

// Gaps at the start of a step with the barrier law (barrier_path.cl): contact_all; nearest, behind, join, share and oppose;
// contact_gap.
//   writes  todo: all; in place of barys: gaps [item_count] [m]
SEL_STAGE(contact_all)
{
    const uint item = get_global_id(0);
    if (item == 0) todo[0] = par.item_count;
    if (item < par.item_count) todo[1 + item] = item;
}

SEL_STAGE(contact_gap)
{
    const uint item = get_global_id(0);
    if (item < par.item_count)
        barys[item] = nearer_gap(&stages[item].side[0], &stages[item].side[1], models[list[item]].reach);
}

#endif
