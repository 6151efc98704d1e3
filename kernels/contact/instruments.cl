// Contact between instruments: forces of the neighbours of cells, which the host has found (shared/instrument_near.h).
//   launch  engine/contact/rods/instrument_contact.cpp       test  tests/contact/test_instrument_kernels.cpp
#include "shared/instrument_block.h"
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_INSTRUMENT_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// Forces of listed slots: with other instruments, SEL_BLOCK of them an item; with the same one, each an item. The other kernel's are
// passed over.
//   item    entries of `list`: slots that something is near in
//   reads   list [item_count]; bodies; slots; nodes at the trial and at the start of the step; states_t0 [cells][slots]
//   writes  forces [item_count]; points [item_count][SEL_INSTRUMENT_POINTS], of each its first `count`; states [cells][slots] of
//           the listed
#define SEL_EVALUATE(name)                                                                                                      \
    SEL_INSTRUMENT_KERNEL void name(const InstrumentParams par, __global const uint* restrict list,                             \
                                    __global const InstrumentRod* restrict rods, __global const InstrumentPair* restrict pairs, \
                                    __global const InstrumentSurface* restrict surfaces, __global const uint* restrict rod_of,  \
                                    __global const InstrumentSlot* restrict slots, __global const real* restrict position,      \
                                    __global const real* restrict material, __global const real* restrict theta,                \
                                    __global const real* restrict position_t0, __global const real* restrict material_t0,       \
                                    __global const real* restrict theta_t0, __global const InstrumentState* restrict states_t0, \
                                    __global InstrumentState* restrict states, __global InstrumentForce* restrict forces,       \
                                    __global InstrumentPoint* restrict points)

SEL_EVALUATE(instruments_evaluate)
{
    const uint first = SEL_BLOCK * get_global_id(0);
    if (first >= par.item_count) return;
    const uint left = par.item_count - first;
    instrument_forces(list + first, left < SEL_BLOCK ? left : SEL_BLOCK, slots, instrument_bodies(rods, pairs, surfaces, rod_of),
                      instrument_nodes(position, material, theta), instrument_nodes(position_t0, material_t0, theta_t0),
                      states_t0, par, states, forces + first, points + SEL_INSTRUMENT_POINTS * first);
}

SEL_EVALUATE(instruments_evaluate_self)
{
    const uint item = get_global_id(0);
    if (item >= par.item_count) return;
    const uint s = list[item], cell = s / SEL_INSTRUMENT_SLOTS;
    if (slots[s].touch != SEL_TOUCH_SELF) return;
#if SEL_SUMS_IN_MEMORY
    SEL_OUT InstrumentState* now = states + s;
    SEL_OUT InstrumentForce* force = forces + item;
#else
    InstrumentState own_state, *now = &own_state;
    InstrumentForce own, *force = &own;
#endif
    *now = no_instrument_state();
    instrument_self_force(cell, slots[s], instrument_bodies(rods, pairs, surfaces, rod_of),
                          instrument_nodes(position, material, theta), instrument_nodes(position_t0, material_t0, theta_t0),
                          states_t0 + SEL_INSTRUMENT_SLOTS * cell, par, now, force, points + SEL_INSTRUMENT_POINTS * item);
#if !SEL_SUMS_IN_MEMORY
    forces[item] = own;
    states[s] = own_state;
#endif
}
