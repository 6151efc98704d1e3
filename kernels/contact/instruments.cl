// Contact between instruments: forces of the neighbours of cells, which the host has found (shared/instrument_near.h).
//   launch  engine/physics/contact/rods/instrument_contact.cpp       test  tests/contact/test_instrument_kernels.cpp
#define SEL_LAW_FN SEL_STAGE_CALL
#define SEL_CALLS_FUNCTIONS  // half of the registers are the caller's: kernel.h asks for fewer groups
#include "shared/instrument_stages.h"
#include "shared/kernel.h"

// Forces of listed slots: with other instruments, SEL_BLOCK of them an item; with the same one, each an item. The other kernel's
// are passed over.
//   item    entries of `list`: slots that something is near in
//   reads   list [item_count]; bodies; slots; nodes at the trial and at the start of the step, as instrument_nodes() has them;
//           states_t0 [cells][slots]
//   writes  forces [item_count]; points [item_count][SEL_INSTRUMENT_POINTS], of each its first `count`; states [cells][slots] of
//           the listed
#define SEL_INSTRUMENT_ARGUMENTS                                                                                             \
    const InstrumentParams par, __global const uint *restrict list, __global const InstrumentRod *restrict rods,             \
        __global const InstrumentPair *restrict pairs, __global const InstrumentSurface *restrict surfaces,                  \
        __global const uint *restrict rod_of, __global const InstrumentSlot *restrict slots,                                 \
        __global const real *restrict nodes, __global const real *restrict nodes_t0,                                         \
        __global const InstrumentState *restrict states_t0, __global InstrumentState *restrict states,                       \
        __global InstrumentForce *restrict forces, __global InstrumentPoint *restrict points
#define SEL_BODIES instrument_bodies(rods, pairs, surfaces, rod_of)
#define SEL_NODES instrument_nodes(nodes, par.node_count), instrument_nodes(nodes_t0, par.node_count)

#if !SEL_SUMS_IN_MEMORY

SEL_KERNEL void instruments_evaluate(SEL_INSTRUMENT_ARGUMENTS)
{
    const uint first = SEL_BLOCK * get_global_id(0);
    if (first >= par.item_count) return;
    const uint left = par.item_count - first;
    instrument_forces(list + first, left < SEL_BLOCK ? left : SEL_BLOCK, slots, SEL_BODIES, SEL_NODES, states_t0, par, states,
                      forces + first, points + SEL_INSTRUMENT_POINTS * first);
}

SEL_KERNEL void instruments_evaluate_self(SEL_INSTRUMENT_ARGUMENTS)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count) return;
    const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;
    if (slots[s].touch != SEL_TOUCH_SELF) return;
    InstrumentState now;
    InstrumentForce force;
    instrument_self_force(cell, slots[s], SEL_BODIES, SEL_NODES, states_t0 + SEL_INSTRUMENT_SLOTS * cell, par, &now, &force,
                          points + SEL_INSTRUMENT_POINTS * item);
    forces[item] = force;
    states[s] = now;
}

#else

// Stages of the same (shared/instrument_stages.h).
//   item    of instruments_ends: an entry of `list`; of the others: one of the todo[0] that follow it in `todo`
//   writes  todo: places in `list` of the slots that may touch, in any order; todo[0] is 0 before. stages [item_count]
    #define SEL_INSTRUMENT_STAGE(name, Stage)                                                                             \
        SEL_WALK_KERNEL void name(SEL_INSTRUMENT_ARGUMENTS, __global Stage* restrict stages, __global uint* restrict todo, \
                                  const uint side)
    #define SEL_CELL_OF(item)                                                                               \
        const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;                                         \
        const InstrumentBodies bodies = SEL_BODIES;                                                         \
        __global const InstrumentState* old = states_t0 + SEL_INSTRUMENT_SLOTS * cell;                      \
        const SlotCell its = slot_cell(cell, slots[s], bodies, SEL_NODES, old, par.inv_dt)
    #define SEL_NEXT(SEL_OF)                          \
        if (get_global_id(0) >= todo[0]) return;      \
        const uint item = todo[1 + get_global_id(0)]; \
        SEL_OF(item)

SEL_INSTRUMENT_STAGE(instruments_ends, InstrumentStage)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count || slots[list[item]].touch == SEL_TOUCH_SELF) return;
    SEL_CELL_OF(item);
    if (stage_ends(&its, par, stages + item, states + s, forces + item)) todo[1 + atomic_inc(todo)] = item;
}

SEL_INSTRUMENT_STAGE(instruments_follow, InstrumentStage)
{
    SEL_NEXT(SEL_CELL_OF);
    stage_follow(&its, par, stages + item, states + s);
}

SEL_INSTRUMENT_STAGE(instruments_look, InstrumentStage)
{
    SEL_NEXT(SEL_CELL_OF);
    stage_look(&its, old, par, stages + item, states + s, forces + item);
}

SEL_INSTRUMENT_STAGE(instruments_push, InstrumentStage)
{
    SEL_NEXT(SEL_CELL_OF);
    stage_push(&its, bodies.pairs[its.pair], old, par, stages + item, states + s, forces + item,
               points + SEL_INSTRUMENT_POINTS * item);
}

SEL_INSTRUMENT_STAGE(instruments_whole, InstrumentStage)
{
    SEL_NEXT(SEL_CELL_OF);
    stage_whole(&its, bodies.pairs[its.pair], old, par, stages + item, states + s, forces + item,
                points + SEL_INSTRUMENT_POINTS * item);
}

SEL_INSTRUMENT_STAGE(instruments_rub, InstrumentStage)
{
    SEL_NEXT(SEL_CELL_OF);
    stage_rub_cell(&its, bodies.pairs[its.pair], old, par, stages + item, states + s, forces + item);
}

    #define SEL_SELF_OF(item)                                                          \
        const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;                    \
        __global const InstrumentState* old = states_t0 + SEL_INSTRUMENT_SLOTS * cell; \
        const SelfCell its = self_cell(cell, slots[s], SEL_BODIES, SEL_NODES, old, par)

SEL_INSTRUMENT_STAGE(instruments_self_mark, SelfStage)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count || slots[list[item]].touch != SEL_TOUCH_SELF) return;
    SEL_SELF_OF(item);
    if (stage_self_mark(&its, stages + item, states + s, forces + item)) todo[1 + atomic_inc(todo)] = item;
}

SEL_INSTRUMENT_STAGE(instruments_self_touch, SelfStage)
{
    SEL_NEXT(SEL_SELF_OF);
    stage_self_touch(&its, stages + item, forces + item);
}

SEL_INSTRUMENT_STAGE(instruments_self_close, SelfStage)
{
    SEL_NEXT(SEL_SELF_OF);
    stage_self_close(&its, old, par, stages + item, states + s, forces + item);
}

SEL_INSTRUMENT_STAGE(instruments_self_push, SelfStage)
{
    SEL_NEXT(SEL_SELF_OF);
    stage_self_push(&its, par, stages + item, forces + item, points + SEL_INSTRUMENT_POINTS * item);
}

SEL_INSTRUMENT_STAGE(instruments_self_rub, SelfStage)
{
    SEL_NEXT(SEL_SELF_OF);
    stage_self_rub(&its, old, par, stages + item, states + s, forces + item);
}

#endif
