// instrument_forces (instrument_block.h) in stages, one kernel each, for devices that run many items at once on few registers:
// see contact_stages.h. The functions are those of instrument_forces, so the results have the same bits.
//
//   ends      gaps at both ends of a cell, which show of most that they are clear; the others go on a list
//   follow    how those that are clear but near close
//   look      whether and where the cell touches, by pieces
//   push      normal force of the pieces; whole: of a cell that touched all along
//   rub       friction
//   self_mark, self_touch, self_close, self_push, self_rub   of an instrument with itself: whether it may touch, where it does, how it
//             closes, normal force, friction
#ifndef SEL_SHARED_INSTRUMENT_STAGES_H
#define SEL_SHARED_INSTRUMENT_STAGES_H
#include "shared/instrument_block.h"

SEL_BEGIN

typedef struct InstrumentStage {
    CellEnds ends;
    CellPieces pieces;
    CellBeside beside;  // of a cell that is taken as a whole
    CellTouch touch;
    CellRule rule;
    int known;  // both ends are
    int due;    // it is clear, and followed
    int whole, pushes;
} InstrumentStage;

// Of a slot of an instrument with itself.
typedef struct SelfStage {
    SelfMarks marks;
    SelfTouch touch;
    SelfLobes lobes;
    SelfSums sums;
    Closing closing;
    int touches;
} SelfStage;

#if SEL_SUMS_IN_MEMORY

// @return it has to be looked at more closely
SEL_FN int stage_ends(const SlotCell* its, InstrumentParams par, SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now,
                      SEL_OUT InstrumentForce* force)
{
    CellEnds ends;
    int known = 0;
    ends.room = 0;
    if (!its->whole) ends_in_lanes(its, &ends, &known);
    *now = no_instrument_state();
    now->pair = its->pair;
    now->touch = its->touch;
    *force = no_instrument_force();
    force->pair = its->pair;
    const real gap = min_r(ends.first.gap, ends.last.gap);
    const int clear = known && ends.room > 0, due = clear && is_followed(its, par, -gap);
    if (clear) write_room(&its->scene, ends, gap, ends.room, force);
    stage->ends = ends;
    stage->known = known;
    stage->due = due;
    return !clear || due;
}

SEL_FN void stage_follow(const SlotCell* its, InstrumentParams par, SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now)
{
    stage->pushes = 0;
    if (!stage->due) return;
    const CellEnds ends = stage->ends;
    int due = 1;
    follow_in_lanes(its, &ends, par.inv_dt, &due, now);
    stage->pushes = due;
}

SEL_FN void stage_look(const SlotCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                       SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    const InstrumentScene* scene = &its->scene;
    const real middle = (real)0.5 * (its->s0 + its->s1), length = its->s1 - its->s0;
    if (stage->due && !stage->pushes) return;
    stage->pushes = 1;
    int whole = its->whole;
    if (whole) {
        CellBeside beside;
        if (its->touch == SEL_TOUCH_INSIDE) beside = beside_lumen(scene, states_t0 + its->old, middle, its->onwards / length);
        else whole = beside_other(scene, middle, its->at, &beside);
        stage->beside = beside;
    }
    stage->whole = whole;
    if (whole) return;
    CellEnds ends = stage->ends;
    if (!stage->known) ends = cell_ends(scene, its->s0, its->s1, its->at);
    look_through(scene, ends, &stage->pieces, force);
    if (force->depth > 0) return;
    stage->pushes = 0;
    if (is_followed(its, par, force->depth)) follow_cell(scene, &stage->pieces, par.inv_dt, its->epoch, now);
}

// The state that a slot had at the start of the step, whether it had none, and its law.
typedef struct StagedLaw {
    ContactState old;
    LawContext c;
    int fresh;
} StagedLaw;

SEL_FN StagedLaw staged_law(uint old, InstrumentSurface a, InstrumentSurface b, InstrumentPair pair, uint epoch,
                            SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par)
{
    StagedLaw law;
    law.fresh = old == SEL_INSTRUMENT_SLOTS;
    law.old = states_t0[law.fresh ? 0 : old].contact;
    law.c = slot_law(a, b, pair, law.fresh, epoch, par);
    return law;
}

SEL_FN StagedLaw cell_law(const SlotCell* its, InstrumentPair pair, SEL_GLOBAL const InstrumentState* states_t0,
                          InstrumentParams par)
{
    return staged_law(its->old, its->surface_a, its->surface_b, pair, its->epoch, states_t0, par);
}

SEL_FN void stage_push(const SlotCell* its, InstrumentPair pair, SEL_GLOBAL const InstrumentState* states_t0,
                       InstrumentParams par, SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now,
                       SEL_OUT InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    if (!stage->pushes || stage->whole) return;
    const StagedLaw law = cell_law(its, pair, states_t0, par);
    push_pieces(&its->scene, &stage->pieces, law.old, law.fresh, &law.c, &stage->rule, &stage->touch, now, force, points);
}

SEL_FN void stage_whole(const SlotCell* its, InstrumentPair pair, SEL_GLOBAL const InstrumentState* states_t0,
                        InstrumentParams par, SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now,
                        SEL_OUT InstrumentForce* force, SEL_GLOBAL InstrumentPoint* points)
{
    if (!stage->pushes || !stage->whole) return;
    const StagedLaw law = cell_law(its, pair, states_t0, par);
    push_whole(&its->scene, (real)0.5 * (its->s0 + its->s1), (real)0.5 * (its->s1 - its->s0), stage->beside, law.old, &law.c,
               &stage->rule, &stage->touch, now, force, points);
}

SEL_FN void stage_rub_cell(const SlotCell* its, InstrumentPair pair, SEL_GLOBAL const InstrumentState* states_t0,
                           InstrumentParams par, SEL_OUT InstrumentStage* stage, SEL_OUT InstrumentState* now,
                           SEL_OUT InstrumentForce* force)
{
    if (!stage->pushes || force->count == 0) return;
    StagedLaw law = cell_law(its, pair, states_t0, par);
    finish_cell(&its->scene, stage->touch, law.old, law.fresh, &law.c, now, force);
}

// ---- of an instrument with itself: instrument_self_force() ---------------------------------------------------------------------

SEL_FN StagedLaw staged_self_law(const SelfCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par)
{
    return staged_law(its->old, its->surface_a, its->surface_b, its->pair, its->epoch, states_t0, par);
}

// @return it has to be looked at more closely
SEL_FN int stage_self_mark(const SelfCell* its, SEL_OUT SelfStage* stage, SEL_OUT InstrumentState* now,
                           SEL_OUT InstrumentForce* force)
{
    start_self(its, now, force);
    if (mark_self(&its->self, its->follows, &stage->marks, &stage->touch)) return 1;
    (void)write_self_depth(&stage->touch, force);  // farther than what is followed
    return 0;
}

SEL_FN void stage_self_touch(const SelfCell* its, SEL_OUT SelfStage* stage, SEL_OUT InstrumentForce* force)
{
    touch_self(&its->self, &stage->marks, &stage->touch);
    stage->touches = write_self_depth(&stage->touch, force);
}

SEL_FN void stage_self_close(const SelfCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                             SEL_OUT SelfStage* stage, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    if (!stage->touches) {
        if (is_self_followed(its, &stage->touch, par)) follow_self(&its->self, &stage->touch, par.inv_dt, its->epoch, now);
        return;
    }
    const StagedLaw law = staged_self_law(its, states_t0, par);
    stage->closing = self_closing(&its->self, &stage->touch, self_line_mass(its), law.old, law.fresh, &law.c, now, force);
}

SEL_FN void stage_self_push(const SelfCell* its, InstrumentParams par, SEL_OUT SelfStage* stage, SEL_OUT InstrumentForce* force,
                            SEL_GLOBAL InstrumentPoint* points)
{
    if (!stage->touches) return;
    const LawContext c = self_law(its, par);
    push_self(&its->self, &stage->touch, its->pair.spread, stage->closing, &c, &stage->lobes, &stage->sums, force, points);
}

SEL_FN void stage_self_rub(const SelfCell* its, SEL_GLOBAL const InstrumentState* states_t0, InstrumentParams par,
                           SEL_OUT const SelfStage* stage, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* force)
{
    if (!stage->touches) return;
    StagedLaw law = staged_self_law(its, states_t0, par);
    rub_self(&its->self, stage->sums, now->contact.gap, law.old, law.fresh, &law.c, now, force);
}

#endif

SEL_END
#endif
