// Contact between instruments: forces of the neighbours of cells, which the host has found (shared/instrument_near.h).
//   launch  engine/physics/contact/rods/instrument_contact.cpp       test  tests/contact/test_instrument_kernels.cpp
#define SEL_LAW_FN SEL_STAGE_CALL
#define SEL_CALLS_FUNCTIONS  // half of the registers are the caller's: kernel.h asks for fewer groups
#include "shared/instrument_slot.h"
#include "shared/kernel.h"

// Forces of listed slots: with other instruments, or with the same one. The other kernel's are passed over.
//   item    entries of `list`: slots that something is near in
//   reads   list [item_count]; bodies; slots; nodes at the trial and at the start of the step, as instrument_nodes() has them;
//           states_t0 [cells][slots]
//   writes  forces [item_count]; points [item_count][SEL_INSTRUMENT_POINTS], of each its first `count`; states [cells][slots] of
//           the listed
#define SEL_INSTRUMENT_ARGUMENTS                                                                                 \
    const InstrumentParams par, __global const uint *restrict list, __global const InstrumentRod *restrict rods, \
        __global const InstrumentPair *restrict pairs, __global const InstrumentSurface *restrict surfaces,      \
        __global const uint *restrict rod_of, __global const InstrumentSlot *restrict slots,                     \
        __global const real *restrict nodes, __global const real *restrict nodes_t0,                             \
        __global const InstrumentState *restrict states_t0, __global InstrumentState *restrict states,           \
        __global InstrumentForce *restrict forces, __global InstrumentPoint *restrict points
#define SEL_BODIES instrument_bodies(rods, pairs, surfaces, rod_of)
#define SEL_NODES instrument_nodes(nodes, par.node_count), instrument_nodes(nodes_t0, par.node_count)

#if !SEL_SUMS_IN_MEMORY

    #define SEL_INSTRUMENT_KERNEL(name, passes_over, force_of)                                                          \
        SEL_KERNEL void name(SEL_INSTRUMENT_ARGUMENTS)                                                                  \
        {                                                                                                               \
            const uint item = get_global_id(0);                                                                         \
            if (item >= par.item_count) return;                                                                         \
            const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;                                                 \
            if (slots[s].touch passes_over) return;                                                                     \
            InstrumentState now;                                                                                        \
            InstrumentForce force;                                                                                      \
            force_of(cell, slots[s], SEL_BODIES, SEL_NODES, states_t0 + SEL_INSTRUMENT_SLOTS * cell, par, &now, &force, \
                     points + SEL_INSTRUMENT_POINTS * item);                                                            \
            forces[item] = force;                                                                                       \
            states[s] = now;                                                                                            \
        }
SEL_INSTRUMENT_KERNEL(instruments_evaluate, == SEL_TOUCH_SELF, instrument_force)
SEL_INSTRUMENT_KERNEL(instruments_evaluate_self, != SEL_TOUCH_SELF, instrument_self_force)

#else

// Stages of the same: what instrument_force() and instrument_self_force() call one after the other, one kernel each, for devices
// that run many items at once on few registers (see contact_stages.h). The results have the same bits.
//
//   ends      gaps at both ends of a cell, which show of most that they are clear; the others go on a list
//   look      whether and where the cell touches, by pieces; how those that are clear but near close
//   push      normal force of the pieces; whole: of a cell that touched all along
//   rub       friction
//   self_mark, self_touch, self_close, self_push, self_rub   of an instrument with itself: whether it may touch, where it does,
//             how it closes, normal force, friction
//
//   item    of instruments_ends and _self_mark: an entry of `list`; of the others: one of the todo[0] that follow it in `todo`
//   writes  todo: places in `list` of the slots that may touch, in any order; todo[0] is 0 before. stages [item_count]
    #define SEL_INSTRUMENT_STAGE(name, Work)                                                                              \
        SEL_WALK_KERNEL void name(SEL_INSTRUMENT_ARGUMENTS, __global Work *restrict stages, __global uint *restrict todo, \
                                  const uint side)
    #define SEL_SLOT(Work)                                                             \
        const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;                    \
        __global const InstrumentState* old = states_t0 + SEL_INSTRUMENT_SLOTS * cell; \
        __global Work* work = stages + item;                                           \
        __global InstrumentState* now = states + s;                                    \
        __global InstrumentForce* force = forces + item
    #define SEL_FIRST                       \
        const uint item = get_global_id(0); \
        if (item >= par.item_count) return
    #define SEL_NEXT                             \
        if (get_global_id(0) >= todo[0]) return; \
        const uint item = todo[1 + get_global_id(0)]
    #define SEL_CELL        \
        SEL_SLOT(CellWork); \
        const SlotCell its = slot_cell(cell, slots[s], SEL_BODIES, SEL_NODES, old, par.inv_dt)
    #define SEL_ITSELF      \
        SEL_SLOT(SelfWork); \
        const SlotCell its = self_cell(cell, slots[s], SEL_BODIES, SEL_NODES, old)
    #define SEL_POINTS points + SEL_INSTRUMENT_POINTS * item

SEL_INSTRUMENT_STAGE(instruments_ends, CellWork)
{
    SEL_FIRST;
    if (slots[list[item]].touch == SEL_TOUCH_SELF) return;
    SEL_CELL;
    start_slot(&its, now, force);
    if (look_at_ends(&its, par, work, force)) todo[1 + atomic_inc(todo)] = item;
}

SEL_INSTRUMENT_STAGE(instruments_look, CellWork)
{
    SEL_NEXT;
    SEL_CELL;
    look_at_cell(&its, old, par, work, now, force);
}

    // a stage of a slot that pushes, with its law
    #define SEL_LAW_STAGE(name, Work, its_slot, acts, call) \
        SEL_INSTRUMENT_STAGE(name, Work)                    \
        {                                                   \
            SEL_NEXT;                                       \
            if (!(acts)) return;                            \
            its_slot;                                       \
            const SlotLaw law = slot_law(&its, old, par);   \
            call;                                           \
        }

SEL_LAW_STAGE(instruments_push, CellWork, SEL_CELL, stages[item].pushes && !stages[item].whole,
              push_pieces(&its.scene, &law, work, now, force, SEL_POINTS))
SEL_LAW_STAGE(instruments_whole, CellWork, SEL_CELL, (stages[item].pushes && stages[item].whole),
              push_whole(&its.scene, &law, work, now, force, SEL_POINTS))
SEL_LAW_STAGE(instruments_rub, CellWork, SEL_CELL, stages[item].pushes, finish_cell(&its.scene, &law, work, now, force))

SEL_INSTRUMENT_STAGE(instruments_self_mark, SelfWork)
{
    SEL_FIRST;
    if (slots[list[item]].touch != SEL_TOUCH_SELF) return;
    SEL_ITSELF;
    start_slot(&its, now, force);
    if (look_at_self(&its, par, work, force)) todo[1 + atomic_inc(todo)] = item;
}

SEL_INSTRUMENT_STAGE(instruments_self_touch, SelfWork)
{
    SEL_NEXT;
    SEL_ITSELF;
    touch_self(&its.scene, &work->marks, &work->touch);
    (void)write_self_depth(&work->touch, force);
}

SEL_INSTRUMENT_STAGE(instruments_self_close, SelfWork)
{
    SEL_NEXT;
    SEL_ITSELF;
    if (work->touch.count == 0) {
        follow_self(&its, par, work, now);
        return;
    }
    const SlotLaw law = slot_law(&its, old, par);
    close_self(&its.scene, &law, line_mass(&its), work, now, force);
}

SEL_LAW_STAGE(instruments_self_push, SelfWork, SEL_ITSELF, stages[item].touch.count > 0,
              push_self(&its.scene, &law.law, its.pair.spread, work, force, SEL_POINTS))
SEL_LAW_STAGE(instruments_self_rub, SelfWork, SEL_ITSELF, stages[item].touch.count > 0,
              finish_self(&its.scene, &law, work, now, force))

#endif
