// Evaluation of one slot of one cell, with another instrument or with the same one, in kernels and their twin. On a graphics card
// the calls that an item makes one after the other are stages, a kernel each (kernels/contact/instruments.cl).
//
// Most neighbours do not touch, and in a lumen the gaps at both ends of a cell show it (least_room()).
#ifndef SEL_SHARED_INSTRUMENT_SLOT_H
#define SEL_SHARED_INSTRUMENT_SLOT_H
#include "shared/instrument_near.h"

SEL_BEGIN

// The state that a slot had at the start of the step: of the same pair, the nearest along b.
// @return its place among the cell's, or SEL_INSTRUMENT_SLOTS
SEL_FN uint old_slot(SEL_GLOBAL const InstrumentState* states, uint pair, real along_b, real farthest, uint epoch)
{
    uint found = SEL_INSTRUMENT_SLOTS;
    real least = farthest;
    for (uint k = 0; k < SEL_INSTRUMENT_SLOTS; ++k) {
        if (states[k].contact.epoch + 1 != epoch || states[k].pair != pair || states[k].touch == SEL_TOUCH_NONE) continue;
        const real apart = fabs(states[k].along_b - along_b);
        if (apart >= least) continue;
        least = apart;
        found = k;
    }
    return found;
}

// One slot of one cell.
typedef struct SlotCell {
    InstrumentScene scene;
    InstrumentSurface surface_a, surface_b;
    InstrumentPair pair;
    uint pair_index, epoch;
    uint old;    // its state at the start of the step; SEL_INSTRUMENT_SLOTS: none
    real at;     // with another instrument: where along b's curve
    uint whole;  // and it is taken as a whole
} SlotCell;

// @param along_b  material coordinate of what it is near to     states_t0  [SEL_INSTRUMENT_SLOTS] of the cell
SEL_FN SlotCell slot_beside(uint cell, InstrumentSlot slot, real along_b, InstrumentBodies bodies, InstrumentNodes nodes,
                            InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0)
{
    SlotCell its;
    its.pair = bodies.pairs[slot.pair];
    const InstrumentRod a = bodies.rods[its.pair.a], b = bodies.rods[its.pair.b];
    its.surface_a = bodies.surfaces[cell];
    its.surface_b = surface_at(b, along_b, bodies.surfaces);
    its.scene.a = spline_of(nodes, a.node, a.count);
    its.scene.b = spline_of(nodes, b.node, b.count);
    its.scene.a_t0 = spline_of(nodes_t0, a.node, a.count_t0);
    its.scene.b_t0 = spline_of(nodes_t0, b.node, b.count_t0);
    its.scene.part = gap_part(its.pair, its.surface_a, its.surface_b, its.scene.b);
    its.scene.s0 = a.spacing * (real)(cell - a.cell);
    its.scene.s1 = its.scene.s0 + a.spacing;
    its.scene.edge = edge_of_material(its.scene.a, its.scene.s0);
    its.scene.apart = SEL_SELF_APART * its.surface_a.radius;
    its.scene.from = its.scene.until = its.at = 0;
    its.pair_index = slot.pair;
    its.epoch = a.epoch;
    its.old = old_slot(states_t0, slot.pair, along_b, 4 * (a.spacing + b.spacing), a.epoch);
    its.whole = 0;
    return its;
}

// With another instrument.
SEL_FN SlotCell slot_cell(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                          InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, real inv_dt)
{
    const InstrumentRod b = bodies.rods[bodies.pairs[slot.pair].b];
    const real along_b = spline_material(spline_of(nodes, b.node, b.count), slot.at);
    SlotCell its = slot_beside(cell, slot, along_b, bodies, nodes, nodes_t0, states_t0);
    its.at = slot.at;
    // at a static equilibrium, which may be far away, nothing is taken as it was
    const uint whole = SEL_CONTACT_WHOLE | SEL_CONTACT_ACTIVE;
    its.whole = inv_dt > 0 && its.old < SEL_INSTRUMENT_SLOTS && (states_t0[its.old].contact.flags & whole) == whole;
    return its;
}

// With a stretch of the same one.
SEL_FN SlotCell self_cell(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                          InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0)
{
    const InstrumentRod rod = bodies.rods[bodies.pairs[slot.pair].a];
    const real from = rod.spacing * slot.at, until = min_r(from + rod.spacing * (real)slot.cells, rod.inside);
    SlotCell its = slot_beside(cell, slot, (real)0.5 * (from + until), bodies, nodes, nodes_t0, states_t0);
    its.scene.from = spline_at(its.scene.b, from);
    its.scene.until = spline_at(its.scene.b, until);
    return its;
}

SEL_FN LawContext law_between(InstrumentSurface a, InstrumentSurface b, InstrumentPair pair, int fresh, uint epoch,
                              InstrumentParams par)
{
    LawContext c;
    c.m = instrument_model(a, b, pair);
    c.mv.tangent = c.mv.move = c.mv.turn = make_vec3(0, 0, 0);
    c.mv.length = c.mv.spin = c.mv.radius_reduction = 0;
    c.mv.fresh = fresh;
    c.mv.epoch = epoch;
    c.par.item_count = c.par.slots = c.par.known = 0;
    c.par.normal_law = SEL_NORMAL_DAMPED;
    c.par.smoothing = 0;
    c.par.friction = par.friction;
    c.par.settling = par.settling;
    c.par.inv_dt = par.inv_dt;
    c.par.smooth_speed = par.smooth_speed;
    return c;
}

// @param states_t0  [SEL_INSTRUMENT_SLOTS] of the cell
SEL_FN SlotLaw slot_law(const SlotCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par)
{
    SlotLaw slot;
    const int fresh = its->old == SEL_INSTRUMENT_SLOTS;
    slot.old = states_t0[fresh ? 0 : its->old].contact;
    slot.law = law_between(its->surface_a, its->surface_b, its->pair, fresh, its->epoch, par);
    return slot;
}

SEL_FN void start_slot(const SlotCell* its, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    *now = no_instrument_state();
    *force = no_instrument_force();
    now->pair = force->pair = its->pair_index;
    now->touch = its->pair.touch;
}

// Gap up to which it counts how a cell that touches nothing closes [m]; 0: it does not.
SEL_FN real followed_gap(const SlotCell* its, InstrumentParams par)
{
    return par.follow ? SEL_FOLLOWED * its->surface_a.radius : (real)0;
}

SEL_FN int is_followed(const SlotCell* its, InstrumentParams par, real gap)
{
    return par.follow && gap <= followed_gap(its, par);
}

// ---- with another instrument -------------------------------------------------------------------------------------------------

// Gaps at both ends of a cell. @return 0: they show that it is clear, and farther than what is followed
SEL_FN int look_at_ends(const SlotCell* its, InstrumentParams par, SEL_OUT CellWork* work, SEL_OUT InstrumentForce* force)
{
    if (its->whole) return 1;
    const CellEnds ends = cell_ends(&its->scene, its->at);
    const real gap = min_r(ends.first.gap, ends.last.gap);
    work->ends = ends;
    if (ends.room <= 0 || is_followed(its, par, gap)) return 1;
    write_room(&its->scene, ends, gap, ends.room, force);
    return 0;
}

// Whether and where it touches; how it closes where it does not.
SEL_FN void look_at_cell(const SlotCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                         SEL_OUT CellWork* work, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    const InstrumentScene* scene = &its->scene;
    work->whole = its->whole;
    work->pushes = 1;
    if (its->whole) {
        CellBeside beside;
        if (scene->part.touch == SEL_TOUCH_INSIDE) beside = beside_lumen(scene, states_t0 + its->old, its->at);
        else work->whole = beside_other(scene, its->at, &beside);
        work->beside = beside;
        if (work->whole) return;
        work->ends = cell_ends(scene, its->at);
    }
    look_through(scene, work->ends, &work->pieces, force);
    if (force->depth > 0) return;
    work->pushes = 0;
    if (is_followed(its, par, -force->depth))
        follow_at(scene, cell_bottom(scene, work->pieces.least[work->pieces.deepest]), par.inv_dt, its->epoch, now);
}

#if !SEL_SUMS_IN_MEMORY
// @param states_t0  [SEL_INSTRUMENT_SLOTS] of the cell     points  [SEL_INSTRUMENT_POINTS] of the slot: those that push are
// written
SEL_PART void instrument_force(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                               InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                               InstrumentState* now, InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    const SlotCell its = slot_cell(cell, slot, bodies, nodes, nodes_t0, states_t0, par.inv_dt);
    CellWork work;
    start_slot(&its, now, force);
    if (!look_at_ends(&its, par, &work, force)) return;
    look_at_cell(&its, states_t0, par, &work, now, force);
    if (!work.pushes) return;
    const SlotLaw law = slot_law(&its, states_t0, par);
    if (work.whole) push_whole(&its.scene, &law, &work, now, force, points);
    else push_pieces(&its.scene, &law, &work, now, force, points);
    finish_cell(&its.scene, &law, &work, now, force);
}
#endif

// ---- with itself --------------------------------------------------------------------------------------------------------------

// Where it is deepest. @return 0: it touches nothing
SEL_FN int write_self_depth(SEL_OUT const SelfTouch* touch, SEL_OUT InstrumentForce* force)
{
    force->depth = -touch->deepest.gap;
    if (touch->count == 0) force->clear = max_r(touch->clear, 0);
    return touch->count > 0;
}

// @return 0: it is clear, and farther than what is followed
SEL_FN int look_at_self(const SlotCell* its, InstrumentParams par, SEL_OUT SelfWork* work, SEL_OUT InstrumentForce* force)
{
    const int near = mark_self(&its->scene, followed_gap(its, par), &work->marks, &work->touch);
    if (!near) (void)write_self_depth(&work->touch, force);
    return near;
}

// How it closes that touches nothing, if that counts.
SEL_FN void follow_self(const SlotCell* its, InstrumentParams par, SEL_OUT const SelfWork* work, SEL_OUT InstrumentState* now)
{
    const CellMark least = work->touch.deepest;
    if (is_followed(its, par, least.gap)) follow_at(&its->scene, self_bottom(&its->scene, least.s), par.inv_dt, its->epoch, now);
}

// The lighter strand's mass per metre.
SEL_FN real line_mass(const SlotCell* its) { return min_r(its->surface_a.load, its->surface_b.load) / SEL_WEIGHT_GRAVITY; }

#if !SEL_SUMS_IN_MEMORY
SEL_PART void instrument_self_force(uint cell, InstrumentSlot slot, InstrumentBodies bodies, InstrumentNodes nodes,
                                    InstrumentNodes nodes_t0, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                                    InstrumentState* now, InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    const SlotCell its = self_cell(cell, slot, bodies, nodes, nodes_t0, states_t0);
    SelfWork work;
    start_slot(&its, now, force);
    if (!look_at_self(&its, par, &work, force)) return;
    touch_self(&its.scene, &work.marks, &work.touch);
    if (!write_self_depth(&work.touch, force)) {
        follow_self(&its, par, &work, now);
        return;
    }
    const SlotLaw law = slot_law(&its, states_t0, par);
    close_self(&its.scene, &law, line_mass(&its), &work, now, force);
    push_self(&its.scene, &law.law, its.pair.spread, &work, force, points);
    finish_self(&its.scene, &law, &work, now, force);
}
#endif

SEL_END
#endif
