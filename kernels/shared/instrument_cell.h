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
#include "shared/instrument_lanes.h"

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

#define SEL_PIECE_POINTS 4  // Gauss points of a piece

// Gauss points of a stretch of the cell: where, where on b to look, and metres.
typedef struct GaussPoints {
    real s[SEL_PIECE_POINTS], start[SEL_PIECE_POINTS], weight[SEL_PIECE_POINTS];
} GaussPoints;

// A stretch's points while it is integrated.
typedef struct CellRule {
    GaussPoints along;
    LanePlaces lanes;
    real gap[SEL_PIECE_POINTS];
} CellRule;

// @param deepest  of the points, is written, and so is rule->gap; 0: nobody asks     @return sum of force times s
SEL_FN real push_points(const InstrumentScene* scene, SEL_OUT CellRule* rule, SEL_OUT DeepPoint* deepest, int fresh,
                        real approach, const LawContext* c, SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    SEL_OUT const GaussPoints* along = &rule->along;
    SEL_OUT const LanePlaces* lanes = &rule->lanes;
    real moment = 0;
    SEL_ONCE for (uint k = 0; k < SEL_PIECE_POINTS; ++k)
    {
        const real before = out->normal_sum;
        CellPlace place;
        place.of_a = lanes->of_a[k];
        place.near.at = lanes->at[k];
        place.near.bound = 0;  // what lanes find is short of b's ends and its mouth
        if (!lanes->known) find_place(scene, along->s[k], along->start[k], &place);
        CellPoint point;
        set_point_at(scene, scene->part, along->s[k], place, &point);
        if (deepest) rule->gap[k] = point.gap;
        if (deepest && (k == 0 || point.gap < deepest->mark.gap)) *deepest = deep_point(scene, &point);
        if (point.gap >= 0) continue;
        Closing here;
        here.fresh = fresh;
        here.approach = approach;
        here.depth = here.depth_t0 = -point.gap;
        here.rate = here.rate_t0 = 0;
        here.deepens = 0;
        if (c->par.inv_dt > 0 && c->m.damping > 0) {
            const real gap_t0 = lanes->known_t0 ? lanes->gap[SEL_PIECE_POINTS + k] : gap_at_start(scene, along->s[k], point.g.at);
            here.depth_t0 = gap_t0 < SEL_FAR ? -gap_t0 : here.depth;
            here.rate = (here.depth - here.depth_t0) * c->par.inv_dt;
        }
        push_at(&point, along->weight[k], here, c, out, points);
        moment += (out->normal_sum - before) * along->s[k];
    }
    return moment;
}

// The normal force between two ends of the touching part of a piece. @return its moment: sum of force times s
SEL_FN real push_along(const InstrumentScene* scene, CellMark left, CellMark right, int fresh, real approach, const LawContext* c,
                       SEL_OUT CellRule* rule, SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const real half_length = (real)0.5 * (right.s - left.s), middle = (real)0.5 * (left.s + right.s);
    SEL_OUT GaussPoints* along = &rule->along;
    for (uint k = 0; k < SEL_PIECE_POINTS; ++k) {
        along->s[k] = middle + half_length * gauss_place(k);
        along->start[k] = (real)0.5 * (left.at + right.at + gauss_place(k) * (right.at - left.at));
        along->weight[k] = half_length * gauss_weight(k);
    }
    places_in_lanes(scene, along->s, along->start, spline_at_near(scene->a, middle, scene->edge), &rule->lanes);
    return push_points(scene, rule, 0, fresh, approach, c, out, points);
}

SEL_FN InstrumentState no_instrument_state(void)
{
    InstrumentState none;
    none.contact = no_contact_state();
    none.along_a = none.along_b = none.length = 0;
    none.pair = none.touch = 0;
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
SEL_FN Closing cell_closing(const InstrumentScene* scene, CellMark deepest, ContactState old, int fresh, const LawContext* c)
{
    Closing closing;
    const real gap_t0 = gap_at_start(scene, deepest.s, deepest.at);
    closing.fresh = fresh;
    closing.depth = -deepest.gap;
    closing.depth_t0 = gap_t0 < SEL_FAR ? -gap_t0 : closing.depth;
    closing.deepens = closing.depth > closing.depth_t0;
    closing.rate = (closing.depth - closing.depth_t0) * c->par.inv_dt;
    closing.rate_t0 = old.rate;
    const int was_active = !fresh && (old.flags & SEL_CONTACT_ACTIVE);
    closing.approach = max_r(was_active ? old.approach : fresh ? closing.rate : old.rate, c->m.speed_floor);
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

// What of a cell that touches nothing is known to the next step: how it closes. (Its approach speed is taken when it touches.)
SEL_FN Closing following(real gap, real gap_t0, real inv_dt)
{
    Closing closing;
    closing.rate = gap_t0 < SEL_FAR ? (gap_t0 - gap) * inv_dt : (real)0;
    closing.approach = closing.rate;
    return closing;
}

SEL_STAGE_FN void follow_cell(const InstrumentScene* scene, SEL_OUT const CellPieces* cell, real inv_dt, uint epoch,
                              SEL_OUT InstrumentState* now)
{
    const CellMark least = cell->least[cell->deepest];
    const DeepPoint bottom = cell_bottom(scene, least);
    write_deepest(scene, bottom, following(bottom.mark.gap, gap_at_start(scene, bottom.mark.s, bottom.mark.at), inv_dt), epoch,
                  now);
}

// A cell's contact: sum of force times s, metres that touch, middle of the contact on b.
typedef struct CellTouch {
    real moment, length, at;
    DeepPoint deepest;  // of a cell that is taken as a whole
} CellTouch;

#define SEL_WHOLE ((real)0.25)  // of the deepest: a cell that is as deep all along is taken as a whole

// Whether an evaluated cell is to be integrated as a cell in full contact in the next step. Not at a mouth, whose rim is sharply
// curved.
SEL_FN int touches_whole(const InstrumentScene* scene, SEL_OUT const CellPieces* cell)
{
    const real deepest = -cell->least[cell->deepest].gap,
               low = scene->part.touch == SEL_TOUCH_INSIDE ? scene->part.low : (real)-1;
    for (uint k = 0; k <= cell->cuts.pieces; ++k)
        if (!(-cell->cuts.at[k].gap >= SEL_WHOLE * deepest && cell->cuts.at[k].at > low)) return 0;
    return 1;
}

// What a cell that touches exerts, piece by piece.
SEL_STAGE_FN void push_pieces(const InstrumentScene* scene, SEL_OUT const CellPieces* cell, ContactState old, int fresh,
                              const LawContext* c, SEL_OUT CellRule* rule, SEL_OUT CellTouch* touch, SEL_OUT InstrumentState* now,
                              SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const CellMark least = cell->least[cell->deepest];
    const DeepPoint bottom = cell_bottom(scene, least);
    const Closing closing = cell_closing(scene, bottom.mark, old, fresh, c);
    write_deepest(scene, bottom, closing, c->mv.epoch, now);
    if (blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    if (touches_whole(scene, cell)) now->contact.flags |= SEL_CONTACT_WHOLE;
    touch->moment = touch->length = 0;
    touch->at = least.at;
    SEL_ONCE for (uint k = 0; k < cell->cuts.pieces; ++k)
    {
        if (cell->least[k].gap >= 0) continue;
        const CellMark left = cell->cuts.at[k], right = cell->cuts.at[k + 1];
        const CellMark from = left.gap < 0 ? left : gap_zero(scene, cell->least[k], left);
        const CellMark until = right.gap < 0 ? right : gap_zero(scene, cell->least[k], right);
        touch->length += until.s - from.s;
        touch->moment += push_along(scene, from, until, fresh, closing.approach, c, rule, out, points);
    }
}

// What the cubic through the values at four Gauss points is at an end of the cell. @param k0, k1, k2, k3  the points, from that
// end on
SEL_FN real at_end(SEL_OUT const real* of, uint k0, uint k1, uint k2, uint k3)
{
    return (real)1.5267881254572662 * of[k0] - (real)0.813632449486927 * of[k1] + (real)0.40076152031165035 * of[k2] -
           (real)0.11391719628198993 * of[k3];
}

// Approximate place on b of a cell in full contact.
typedef struct CellBeside {
    real at;       // of its middle
    real onwards;  // of `at`, with s [1/m]
} CellBeside;

// In a lumen b goes along with a: from where the cell was deepest at the start of the step.
// @param onwards  of `at` over the cell
SEL_FN CellBeside beside_lumen(const InstrumentScene* scene, SEL_GLOBAL const InstrumentState* old, real middle, real onwards)
{
    CellBeside beside;
    beside.onwards = onwards;
    beside.at = spline_at_near(scene->b, old->along_b, old->contact.triangle) + onwards * (middle - old->along_a);
    return beside;
}

// Elsewhere it has any direction.
// @param start  where on b to look     @return 0: there is nothing beside it
SEL_FN int beside_other(const InstrumentScene* scene, real middle, real start, CellBeside* beside)
{
    const CellPoint point = cell_point(scene, middle, start);
    if (point.gap >= SEL_FAR) return 0;
    const vec3 along_a = spline_sum(scene->a, point.a.node, point.a.d),
               along_b = spline_sum(scene->b, point.g.b.node, point.g.b.d);
    beside->at = point.g.at;
    beside->onwards = dot3(along_a, along_b) / (sqrt(dot3(along_a, along_a)) * dot3(along_b, along_b));
    return 1;
}

// What a cell that touched all along at the start of the step exerts.
// @param middle  of the cell [m]
SEL_FN void push_whole(const InstrumentScene* scene, real middle, real half_length, CellBeside beside, ContactState old,
                       const LawContext* c, SEL_OUT CellRule* rule, SEL_OUT CellTouch* touch, SEL_OUT InstrumentState* now,
                       SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    SEL_OUT GaussPoints* along = &rule->along;
    for (uint k = 0; k < SEL_PIECE_POINTS; ++k) {
        const real way = gauss_place(k) * half_length;
        along->s[k] = middle + way;
        along->start[k] = beside.at + beside.onwards * way;
        along->weight[k] = half_length * gauss_weight(k);
    }
    own_places_in_lanes(scene, along->s, along->start, &rule->lanes);
    touch->length = 2 * half_length;
    touch->at = beside.at;
    Closing closing;
    closing.fresh = 0;
    closing.approach = max_r(old.approach, c->m.speed_floor);
    closing.rate_t0 = old.rate;
    touch->moment = push_points(scene, rule, &touch->deepest, closing.fresh, closing.approach, c, out, points);
    const DeepPoint deepest = touch->deepest;
    real least = deepest.mark.gap, most = max_r(max_r(rule->gap[0], rule->gap[1]), max_r(rule->gap[2], rule->gap[3]));
    if (most < SEL_FAR) {
        const real first = at_end(rule->gap, 0, 1, 2, 3), last = at_end(rule->gap, 3, 2, 1, 0);
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
    const real low = scene->part.touch == SEL_TOUCH_INSIDE ? scene->part.low : (real)-1;
    if (most <= SEL_WHOLE * least && min_r(along->start[0], along->start[3]) > low) now->contact.flags |= SEL_CONTACT_WHOLE;
}

// The state of a cell that has pushed, and its friction.
SEL_FN void finish_cell(const InstrumentScene* scene, CellTouch touch, ContactState old, int fresh, LawContext* c,
                        SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out)
{
    now->length = out->length = touch.length;
    now->contact.flags |= SEL_CONTACT_ACTIVE;
    now->contact.normal_force = out->normal_sum;
    if (c->par.friction == SEL_FRICTION_NONE) return;
    const CellPoint middle = cell_point(scene, touch.moment / out->normal_sum, touch.at);
    if (middle.gap >= SEL_FAR) return;
    CarriedState carried;
    carried.old = old;
    carried.was_active = !fresh && (old.flags & SEL_CONTACT_ACTIVE);
    c->m.weight = touch.length;
    rub_at(scene, middle, carried, c, now, out);
}

SEL_END
#endif
