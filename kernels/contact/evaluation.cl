// Forces of quadrature points, by any law.
//   launch  engine/contact/evaluation.cpp       test  tests/contact/test_host_reference.cpp
#include "shared/contact_point.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// A hint if one item is a work-group, that is on a CPU. The records of a thousand wires do not fit its caches, and only the list
// knows the next ones. (PoCL's own prefetch() does nothing.) Only where the compiler's target is the processor
// itself: SPIR-V has no such instruction, and LLVM's translator to SPIR-V ends the process at it.
#if SEL_WORKGROUP == 1 && defined(__clang__) && (defined(__x86_64__) || defined(__aarch64__))
    #define SEL_AHEAD 4  // items: a third of a microsecond each
static inline void ahead(const __global void* at, uint bytes)
{
    for (uint k = 0; k < bytes; k += 64) __builtin_prefetch((const __global char*)at + k);
}
#else
    #define SEL_AHEAD 0
static inline void ahead(const __global void* at, uint bytes) {}
#endif

// Forces of active quadrature points.
//   item    one entry of `list` (quadrature points with near nodes, ordered by wire and edge); range rounded up to the work-group
//           size
//   reads   list [item_count]; models, places, counts [points]; near_nodes [points][slots]; wall; nodes, at the trial and at the
//           start of the step; states_t0, multipliers [points][2]; clearances [points]
//   writes  forces, barys [item_count]; states [points][2]; clearances
SEL_KERNEL void contact_evaluate(
    const ContactParams par, __global const uint* restrict list, __global const QuadratureModel* restrict models,
    __global const QuadraturePlace* restrict places, __global const uint* restrict near_nodes,
    __global const uint* restrict counts, SEL_WALL_ARGUMENTS, SEL_NODE_ARGUMENTS(node), SEL_NODE_ARGUMENTS(node_t0),
    __global const ContactState* restrict states_t0, __global ContactState* restrict states,
    __global ContactForce* restrict forces, __global real* restrict barys, __global const MultiplierState* restrict multipliers,
    __global Clearance* restrict clearances)
{
    const uint item = get_global_id(0);
    if (item < par.item_count) {
        const uint s = list[item];
        if (SEL_AHEAD > 0 && item + SEL_AHEAD < par.item_count) {
            const uint then = list[item + SEL_AHEAD];
            ahead(states_t0 + 2 * then, 2 * sizeof(ContactState));
            ahead(states + 2 * then, 2 * sizeof(ContactState));
            ahead(models + then, sizeof(QuadratureModel));
            ahead(forces + item + SEL_AHEAD, sizeof(ContactForce));
        }
        const NearWallView near = near_wall_view(SEL_WALL, near_nodes + (ulong)s * par.slots, counts[s]);
        const PointView point = point_view(s, models[s], places[s], near);
        write_force(contact_force(point, par, SEL_NODES(node), SEL_NODES(node_t0), state_view(states_t0, states, multipliers),
                                  clearances + s),
                    forces + item);
        barys[item] = places[s].bary;
    }
}
