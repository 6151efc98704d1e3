// Contact of one cell of rod a with a stretch of rod b: force along the part that touches (instrument_pieces.h), friction in the
// middle of it.
//
// Over each piece the force per metre is integrated by Gauss between the zeros of the gap. So a line contact has its force per
// metre, a crossing one its lens, wherever they lie on the cells: one piece gains exactly the force that its neighbour loses, and
// nothing jumps. The integrand vanishes at zeros, so their motion does not count in the tangent. The motion of the Gauss points
// with them is neglected (in full contact they stay on material).
//
// Three cells in four that touch do so all along, and did in the last step: such a cell is not cut, and no zeros are looked for.
// Its force is taken by Gauss at four points fixed in its material, which is smooth in the nodes whatever lies between. The rule
// does not change within a step. This one is used only if the cell was everywhere at least 1/4 as deep as at its deepest point
// (SEL_WHOLE). A force of depth^(3/2) is then right to 5e-7 if the depth is linear in s, and to 2e-4 if it is a parabola of that
// height. If curvatures jump by [kappa] at a knot in it, it is right to a depth of [kappa] l^2/2700 in the mean.
#ifndef SEL_SHARED_INSTRUMENT_CELL_H
#define SEL_SHARED_INSTRUMENT_CELL_H
#include "shared/instrument_friction.h"

SEL_BEGIN

SEL_FN vec3 point_near(SplineView rod, real s, uint edge)
{
    const SplinePlace p = spline_place(spline_at_near(rod, s, edge), rod.count);
    return spline_sum(rod, p.node, p.w);
}

// The gap of the same material point of a at the start of the step.
SEL_STAGE_FN real gap_at_start(const InstrumentScene* scene, real s, real start)
{
#if SEL_SUMS_IN_MEMORY
    return point_between_rods(scene, scene->a_t0, scene->b_t0, s, start).s0;
#else
    return instrument_gap(scene->b_t0, point_near(scene->a_t0, s, scene->edge), start, part_for(scene, scene->b_t0, s)).gap;
#endif
}

// Gauss-Legendre on [-1, 1].
SEL_FN real gauss_place(uint k)
{
    return k == 0   ? (real)-0.86113631159405258
           : k == 1 ? (real)-0.33998104358485626
           : k == 2 ? (real)0.33998104358485626
                    : (real)0.86113631159405258;
}
SEL_FN real gauss_weight(uint k) { return k == 1 || k == 2 ? (real)0.65214515486254614 : (real)0.34785484513745386; }

// Adds a point whose gap's gradient is that of `point->g`.
// @param force, slope  [N], and its growth with depth [N/m]
SEL_FN void put_point(const CellPoint* point, real force, real slope, SEL_OUT InstrumentForce* out,
                      SEL_GLOBAL InstrumentPoint* points)
{
    InstrumentPoint p;
    for (int k = 0; k < 3; ++k) {
        p.wa[k] = point->a.w[k];
        p.wb[k] = point->g.b.w[k];
        p.db[k] = point->g.b.d[k];
    }
    store_vec(p.n, point->g.n);
    store_vec(p.turn, point->g.turn);
    store_vec(p.p, point->g.p);
    store_vec(p.q, point->g.q);
    for (int k = 0; k < 6; ++k) p.m[k] = point->g.m[k];
    p.bend = point->g.bend;
    p.force = force;
    p.slope = slope;
    p.node_a = point->a.node;
    p.node_b = point->g.b.node;
    points[out->count++] = p;
    out->normal_sum += force;
    out->slope_sum += slope;
}

// Force and its growth at one Gauss point of `weight` metres.
SEL_FN void push_at(const CellPoint* point, real weight, Closing closing, const LawContext* c, SEL_OUT InstrumentForce* out,
                    SEL_GLOBAL InstrumentPoint* points)
{
    real slope, ignored;
    const real per_metre = damped_force(closing, c, &slope);
    if (per_metre <= 0) return;
    put_point(point, weight * per_metre, weight * slope, out, points);
    out->stored += weight * elastic_normal(closing.depth, c->m, &ignored) * closing.depth / (c->m.exponent + 1);
}

#define SEL_PIECE_POINTS 4  // Gauss points of a stretch

// A stretch of the cell that is integrated by one rule.
typedef struct CellStretch {
    real middle, half_length;  // [m]
    real at, onwards;          // about where on b its middle is, and how far on its end
} CellStretch;

SEL_FN CellStretch stretch_between(CellMark from, CellMark until)
{
    const CellStretch stretch = {(real)0.5 * (from.s + until.s), (real)0.5 * (until.s - from.s), (real)0.5 * (from.at + until.at),
                                 (real)0.5 * (until.at - from.at)};
    return stretch;
}

// Gaps at a stretch's points, and the deepest of these.
typedef struct StretchGaps {
    real gap[SEL_PIECE_POINTS];
    DeepPoint deepest;
} StretchGaps;

// Forces of a stretch.
// @param closing  of the cell     gaps  are written; 0: nobody asks     @return sum of force times s
SEL_FN real push_stretch(const InstrumentScene* scene, SEL_OUT const CellStretch* stretch, Closing closing, const LawContext* c,
                         SEL_OUT StretchGaps* gaps, SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    real moment = 0;
    SEL_ONCE for (uint k = 0; k < SEL_PIECE_POINTS; ++k)
    {
        const real s = stretch->middle + stretch->half_length * gauss_place(k), before = out->normal_sum;
        const CellPoint point = cell_point(scene, s, stretch->at + stretch->onwards * gauss_place(k));
        if (gaps) {
            gaps->gap[k] = point.gap;
            if (k == 0 || point.gap < gaps->deepest.mark.gap) gaps->deepest = deep_point(scene, &point);
        }
        if (point.gap >= 0) continue;
        closing.depth = -point.gap;
        closing.rate = 0;
        if (c->par.inv_dt > 0 && c->m.damping > 0) {
            const real gap_t0 = gap_at_start(scene, s, point.g.at);
            if (gap_t0 < SEL_FAR) closing.rate = (closing.depth + gap_t0) * c->par.inv_dt;
        }
        push_at(&point, stretch->half_length * gauss_weight(k), closing, c, out, points);
        moment += (out->normal_sum - before) * s;
    }
    return moment;
}

SEL_FN InstrumentState no_instrument_state(void)
{
    const InstrumentState none = {no_contact_state(), 0, 0, 0, 0, 0};
    return none;
}

SEL_FN InstrumentForce no_instrument_force(void)
{
    InstrumentForce none;
    none.normal_sum = none.friction_sum = none.sliding_sum = none.length = none.friction_work = none.stored = 0;
    none.slope_sum = none.clear = 0;
    none.stiff_along = none.stiff_across = none.skew = 0;
    none.node_a = none.node_b = none.count = none.flags = none.pair = none.pad = 0;
    none.depth = -SEL_FAR;
    return none;
}

// Data of a contact before its force: see closing_of() of contact_law.h.
SEL_FN Closing cell_closing(const InstrumentScene* scene, CellMark deepest, const SlotLaw* slot)
{
    Closing closing;
    const LawContext* c = &slot->law;
    const real gap_t0 = gap_at_start(scene, deepest.s, deepest.at);
    closing.fresh = c->mv.fresh;
    closing.depth = -deepest.gap;
    closing.depth_t0 = gap_t0 < SEL_FAR ? -gap_t0 : closing.depth;
    closing.deepens = closing.depth > closing.depth_t0;
    closing.rate = (closing.depth - closing.depth_t0) * c->par.inv_dt;
    closing.rate_t0 = slot->old.rate;
    const real last = carried_of(slot).was_active ? slot->old.approach : closing.fresh ? closing.rate : slot->old.rate;
    closing.approach = max_r(last, c->m.speed_floor);
    return closing;
}

// How it closes where it is deepest.
SEL_FN void write_deepest(const InstrumentScene* scene, DeepPoint at, Closing closing, uint epoch, SEL_OUT InstrumentState* now)
{
    now->contact.epoch = epoch;
    now->contact.gap = at.mark.gap;
    now->contact.rate = closing.rate;
    now->contact.approach = closing.approach;
    for (uint k = 0; k < 3; ++k) {
        now->contact.normal[k] = at.n[k];
        now->contact.point[k] = at.x[k] - (scene->part.reach_a + at.mark.gap) * at.n[k];
    }
    now->along_a = at.mark.s;
    now->along_b = spline_material(scene->b, at.mark.at);
    now->contact.triangle = edge_near(scene->b, now->along_b, (uint)at.mark.at);
}

// How fast the gap at a point closes.
SEL_FN real closing_rate(const InstrumentScene* scene, CellMark point, real inv_dt)
{
    const real gap_t0 = gap_at_start(scene, point.s, point.at);
    return point.gap < SEL_FAR && gap_t0 < SEL_FAR ? (gap_t0 - point.gap) * inv_dt : (real)0;
}

// What of a cell that touches nothing is known to the next step: how it closes. (Its approach speed is taken when it touches.)
SEL_STAGE_FN void follow_at(const InstrumentScene* scene, DeepPoint bottom, real inv_dt, uint epoch, SEL_OUT InstrumentState* now)
{
    Closing closing;
    closing.rate = closing.approach = closing_rate(scene, bottom.mark, inv_dt);
    write_deepest(scene, bottom, closing, epoch, now);
}

#define SEL_WHOLE ((real)0.25)  // of the deepest: a cell that is as deep all along is taken as a whole

// About where a cell in full contact is on b.
typedef struct CellBeside {
    real at;       // of its middle
    real onwards;  // of `at`, with s [1/m]
} CellBeside;

// A cell while it is evaluated: on a card in memory, from one stage to the next.
typedef struct CellWork {
    CellEnds ends;
    CellPieces pieces;
    CellBeside beside;  // of a cell that is taken as a whole
    StretchGaps gaps;   // of such a cell
    CellStretch stretch;
    real moment, length, at;  // what touches: sum of force times s, metres, its middle on b
    int whole, pushes;
} CellWork;

// Where b's mouth is; before all of b where it has none.
SEL_FN real mouth_of(const InstrumentScene* scene)
{
    return scene->part.touch == SEL_TOUCH_INSIDE ? scene->part.low : (real)-1;
}

// Whether an evaluated cell is to be integrated as a cell in full contact in the next step. Not at a mouth, whose rim is sharply
// curved.
SEL_FN int touches_whole(const InstrumentScene* scene, SEL_OUT const CellPieces* cell)
{
    const real deepest = -cell->least[cell->deepest].gap, low = mouth_of(scene);
    for (uint k = 0; k <= cell->cuts.pieces; ++k)
        if (!(-cell->cuts.at[k].gap >= SEL_WHOLE * deepest && cell->cuts.at[k].at > low)) return 0;
    return 1;
}

// What a cell that touches exerts, piece by piece.
SEL_STAGE_FN void push_pieces(const InstrumentScene* scene, const SlotLaw* slot, SEL_OUT CellWork* work,
                              SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    SEL_OUT const CellPieces* cell = &work->pieces;
    const LawContext* c = &slot->law;
    const CellMark least = cell->least[cell->deepest];
    const DeepPoint bottom = cell_bottom(scene, least);
    const Closing closing = cell_closing(scene, bottom.mark, slot);
    write_deepest(scene, bottom, closing, c->mv.epoch, now);
    if (blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    if (touches_whole(scene, cell)) now->contact.flags |= SEL_CONTACT_WHOLE;
    work->moment = work->length = 0;
    work->at = least.at;
    SEL_ONCE for (uint k = 0; k < cell->cuts.pieces; ++k)
    {
        if (cell->least[k].gap >= 0) continue;
        const CellMark left = cell->cuts.at[k], right = cell->cuts.at[k + 1];
        const CellMark from = left.gap < 0 ? left : gap_zero(scene, cell->least[k], left);
        const CellMark until = right.gap < 0 ? right : gap_zero(scene, cell->least[k], right);
        work->length += until.s - from.s;
        work->stretch = stretch_between(from, until);
        work->moment += push_stretch(scene, &work->stretch, closing, c, 0, out, points);
    }
}

// What the cubic through the values at four Gauss points is at an end of the cell. @param k0, k1, k2, k3  the points, from that
// end on
SEL_FN real at_end(SEL_OUT const real* of, uint k0, uint k1, uint k2, uint k3)
{
    return (real)1.5267881254572662 * of[k0] - (real)0.813632449486927 * of[k1] + (real)0.40076152031165035 * of[k2] -
           (real)0.11391719628198993 * of[k3];
}

SEL_FN real cell_middle(const InstrumentScene* scene) { return (real)0.5 * (scene->s0 + scene->s1); }

// In a lumen b goes along with a: from where the cell was deepest at the start of the step.
// @param at  of b, near
SEL_FN CellBeside beside_lumen(const InstrumentScene* scene, SEL_GLOBAL const InstrumentState* old, real at)
{
    CellBeside beside;
    const uint edge = (uint)clamp_r(at, 0, (real)scene->b.count - (real)1.5);
    beside.onwards = 1 / (scene->b.material[edge + 1] - scene->b.material[edge]);
    beside.at = spline_at_near(scene->b, old->along_b, old->contact.triangle) +
                beside.onwards * (cell_middle(scene) - old->along_a);
    return beside;
}

// Elsewhere it has any direction.
// @param start  where on b to look     @return 0: there is nothing beside it
SEL_FN int beside_other(const InstrumentScene* scene, real start, CellBeside* beside)
{
    const CellPoint point = cell_point(scene, cell_middle(scene), start);
    if (point.gap >= SEL_FAR) return 0;
    const vec3 along_a = spline_sum(scene->a, point.a.node, point.a.d),
               along_b = spline_sum(scene->b, point.g.b.node, point.g.b.d);
    beside->at = point.g.at;
    beside->onwards = dot3(along_a, along_b) / (sqrt(dot3(along_a, along_a)) * dot3(along_b, along_b));
    return 1;
}

// What a cell that touched all along at the start of the step exerts.
SEL_FN void push_whole(const InstrumentScene* scene, const SlotLaw* slot, SEL_OUT CellWork* work, SEL_OUT InstrumentState* now,
                       SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const LawContext* c = &slot->law;
    SEL_OUT const real* gap = work->gaps.gap;
    SEL_OUT CellStretch* all = &work->stretch;
    all->middle = cell_middle(scene);
    all->half_length = (real)0.5 * (scene->s1 - scene->s0);
    all->at = work->at = work->beside.at;
    all->onwards = all->half_length * work->beside.onwards;
    work->length = 2 * all->half_length;
    Closing closing;
    closing.fresh = 0;
    closing.approach = max_r(slot->old.approach, c->m.speed_floor);
    closing.rate_t0 = slot->old.rate;
    work->moment = push_stretch(scene, all, closing, c, &work->gaps, out, points);
    const DeepPoint deepest = work->gaps.deepest;
    real least = deepest.mark.gap, most = max_r(max_r(gap[0], gap[1]), max_r(gap[2], gap[3]));
    if (most < SEL_FAR) {
        const real first = at_end(gap, 0, 1, 2, 3), last = at_end(gap, 3, 2, 1, 0);
        least = min_r(least, min_r(first, last));
        most = max_r(most, max_r(first, last));
    }
    const real gap_t0 = gap_at_start(scene, deepest.mark.s, deepest.mark.at);
    closing.depth = -least;
    closing.depth_t0 = gap_t0 < SEL_FAR ? deepest.mark.gap - gap_t0 - least : closing.depth;
    closing.deepens = closing.depth > closing.depth_t0;
    closing.rate = (closing.depth - closing.depth_t0) * c->par.inv_dt;
    write_deepest(scene, deepest, closing, c->mv.epoch, now);
    if (blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    out->depth = -least;
    if (most <= SEL_WHOLE * least && all->at + gauss_place(0) * fabs(all->onwards) > mouth_of(scene))
        now->contact.flags |= SEL_CONTACT_WHOLE;
}

// Marks a slot that has pushed as in contact. @return whether it rubs
SEL_FN int write_touch(real metres, const SlotLaw* slot, SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out)
{
    now->length = out->length = metres;
    now->contact.flags |= SEL_CONTACT_ACTIVE;
    now->contact.normal_force = out->normal_sum;
    return slot->law.par.friction != SEL_FRICTION_NONE;
}

// The state of a cell that has pushed, and its friction.
SEL_FN void finish_cell(const InstrumentScene* scene, const SlotLaw* slot, SEL_OUT const CellWork* work,
                        SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out)
{
    if (out->count == 0 || !write_touch(work->length, slot, now, out)) return;
    const CellPoint middle = cell_point(scene, work->moment / out->normal_sum, work->at);
    if (middle.gap < SEL_FAR) rub_at(scene, middle, slot, now, out);
}

SEL_END
#endif
