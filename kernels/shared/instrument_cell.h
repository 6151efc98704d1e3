// Contact of one cell of rod a with a stretch of rod b: force along the part that touches (instrument_pieces.h), friction in the middle
// of it.
//
// Over each piece the force per metre is integrated by Gauss between the zeros of the gap. So a line contact has its force per metre, a
// crossing one its lens, wherever they lie on the cells: what one piece loses its neighbour gains, and nothing jumps. The integrand
// vanishes at zeros, whose motion therefore does not count in the tangent; that the Gauss points move with them is left out of it
// (they stay on material where the cell touches as a whole).
//
// Friction is that of the whole force of the cell at its centroid: slip of a's surface past b's there, with both spins and the
// turning of both tangents (friction_law.h). Both surfaces are taken at one point, on a's, so that force, couple and torques on
// the two rods are those of one force and its opposite.
#ifndef SEL_SHARED_INSTRUMENT_CELL_H
#define SEL_SHARED_INSTRUMENT_CELL_H
#include "shared/instrument_lanes.h"
#include "shared/instrument_law.h"

SEL_BEGIN

SEL_FN vec3 point_near(SplineView rod, real s, uint edge)
{
    const SplinePlace p = spline_place(spline_at_near(rod, s, edge), rod.count);
    return spline_sum(rod, p.node, p.w);
}

// The gap of the same material point of a at the start of the step.
SEL_FN real gap_at_start(const InstrumentScene* scene, real s, real start)
{
    return instrument_gap(scene->b_t0, point_near(scene->a_t0, s, scene->edge), start, part_for(scene, scene->b_t0, s)).gap;
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

SEL_FN void store_vec(real* to, vec3 v)
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

// Adds a point whose gap's gradient is that of `point.g`.
// @param force, slope  [N], and its growth with depth [N/m]
SEL_FN void put_point(CellPoint point, real force, real slope, InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    InstrumentPoint p;
    for (int k = 0; k < 3; ++k) {
        p.wa[k] = point.a.w[k];
        p.wb[k] = point.g.b.w[k];
        p.db[k] = point.g.b.d[k];
    }
    store_vec(p.n, point.g.n);
    store_vec(p.turn, point.g.turn);
    store_vec(p.p, point.g.p);
    store_vec(p.q, point.g.q);
    for (int k = 0; k < 6; ++k) p.m[k] = point.g.m[k];
    p.bend = point.g.bend;
    p.force = force;
    p.slope = slope;
    p.node_a = point.a.node;
    p.node_b = point.g.b.node;
    points[out->count++] = p;
    out->normal_sum += force;
    out->slope_sum += slope;
}

// Force and its growth at one Gauss point of `weight` metres.
SEL_FN void push_at(CellPoint point, real weight, Closing closing, const LawContext* c, InstrumentForce* out,
                    SEL_GLOBAL InstrumentPoint* points)
{
    real slope, ignored;
    const real per_metre = damped_force(closing, c, &slope);
    if (per_metre <= 0) return;
    put_point(point, weight * per_metre, weight * slope, out, points);
    out->stored += weight * elastic_normal(closing.depth, c->m, &ignored) * closing.depth / (c->m.exponent + 1);
}

#define SEL_PIECE_POINTS 4  // Gauss points of a piece

// The normal force between two ends of what touches of a piece. @return its moment: sum of force times s
SEL_FN real push_along(const InstrumentScene* scene, CellMark left, CellMark right, Closing closing, const LawContext* c,
                       InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const real half_length = (real)0.5 * (right.s - left.s), middle = (real)0.5 * (left.s + right.s);
    real moment = 0, s[SEL_PIECE_POINTS], start[SEL_PIECE_POINTS];
    for (uint k = 0; k < SEL_PIECE_POINTS; ++k) {
        s[k] = middle + half_length * gauss_place(k);
        start[k] = (real)0.5 * (left.at + right.at + gauss_place(k) * (right.at - left.at));
    }
    const LanePlaces lanes = places_in_lanes(scene, s, start, spline_at_near(scene->a, middle, scene->edge));
    for (uint k = 0; k < SEL_PIECE_POINTS; ++k) {
        const real before = out->normal_sum;
        const CellPoint point = lanes.known ? cell_point_at(scene, s[k], lanes.of_a[k], lanes.at[k]) : cell_point(scene, s[k], start[k]);
        if (point.gap >= 0) continue;
        Closing here = closing;
        here.depth = -point.gap;
        if (c->par.inv_dt > 0 && c->m.damping > 0) {
            const real gap_t0 = lanes.known_t0 ? lanes.gap[SEL_PIECE_POINTS + k] : gap_at_start(scene, s[k], point.g.at);
            here.depth_t0 = gap_t0 < SEL_FAR ? -gap_t0 : here.depth;
            here.rate = (here.depth - here.depth_t0) * c->par.inv_dt;
        }
        push_at(point, half_length * gauss_weight(k), here, c, out, points);
        moment += (out->normal_sum - before) * s[k];
    }
    return moment;
}

// One rod's surface at the contact: what its nodes do to it.
typedef struct SurfaceMotion {
    SplinePlace place;
    vec3 lever;    // from the axis to the contact [m]
    vec3 tangent;  // unit
    real length;   // |c'| [m]
    vec3 move;     // of the contact over the step [m]
} SurfaceMotion;

// @param edge  near the material point
SEL_FN SurfaceMotion surface_motion(SplineView now, SplineView then, real at, real material, uint edge, vec3 lever)
{
    SurfaceMotion m;
    m.place = spline_place(at, now.count);
    m.lever = lever;
    const vec3 along = spline_sum(now, m.place.node, m.place.d);
    m.length = sqrt(dot3(along, along));
    m.tangent = (1 / m.length) * along;
    const SplinePlace old = spline_place(spline_at_near(then, material, edge), then.count);
    const vec3 along_t0 = spline_sum(then, old.node, old.d);
    const vec3 turn = m.tangent - (1 / sqrt(dot3(along_t0, along_t0))) * along_t0;
    const real spin = spline_spin(now, m.place) - spline_spin(then, old);
    m.move = spline_sum(now, m.place.node, m.place.w) - spline_sum(then, old.node, old.w) + spin * cross3(m.tangent, lever) +
             dot3(m.tangent, lever) * turn - dot3(lever, turn) * m.tangent;
    return m;
}

SEL_FN InstrumentRow instrument_row(vec3 v, SurfaceMotion a, SurfaceMotion b)
{
    InstrumentRow row;
    store_vec(row.v, v);
    store_vec(row.turn_a, (1 / a.length) * (dot3(a.tangent, a.lever) * v - dot3(v, a.tangent) * a.lever));
    store_vec(row.turn_b, (1 / b.length) * (dot3(b.tangent, b.lever) * v - dot3(v, b.tangent) * b.lever));
    row.spin_a = dot3(v, cross3(a.tangent, a.lever));
    row.spin_b = dot3(v, cross3(b.tangent, b.lever));
    return row;
}

SEL_FN void place_friction(CellPoint point, SurfaceMotion a, SurfaceMotion b, InstrumentForce* out)
{
    for (int k = 0; k < 3; ++k) {
        out->wa[k] = a.place.w[k];
        out->da[k] = a.place.d[k];
        out->wb[k] = b.place.w[k];
        out->db[k] = b.place.d[k];
    }
    store_vec(out->n, point.g.n);
    store_vec(out->turn, point.g.turn);
    out->node_a = a.place.node;
    out->node_b = b.place.node;
}

// Friction under the cell's normal force at the point `point` of a; c->m.weight: metres that touch.
SEL_FN void rub_at(const InstrumentScene* scene, CellPoint point, CarriedState carried, const LawContext* c, InstrumentState* now,
                   InstrumentForce* out)
{
    const vec3 n = point.g.n, x = spline_sum(scene->a, point.a.node, point.a.w);
    const vec3 lever = -(c->m.radius) * n;
    const real along_b = spline_material(scene->b, point.g.at);
    const SurfaceMotion a = surface_motion(scene->a, scene->a_t0, spline_at_near(scene->a, point.s, scene->edge), point.s, scene->edge, lever);
    const SurfaceMotion b = surface_motion(scene->b, scene->b_t0, point.g.at, along_b, (uint)point.g.at, x + lever - point.g.centre);
    place_friction(point, a, b, out);
    vec3 move = a.move - b.move;
    move = move - dot3(move, n) * n;
    const vec3 slip = total_slip(move, n, carried, c);
    const real size = sqrt(dot3(slip, slip)), load = out->normal_sum;
    const SlipLaw law = slip_law(size, load, carried, c);
    const vec3 d = size > 0 ? (1 / size) * slip : across_of(n), f = -law.force * d;
    out->force = instrument_row(f, a, b);
    out->along = instrument_row(d, a, b);
    out->across = instrument_row(cross3(n, d), a, b);
    out->stiff_along = size > 0 ? law.along : law.across;
    out->stiff_across = law.across;
    out->flags |= SEL_FORCE_COUPLE;
    if (!law.stuck && size > 0) {
        out->skew = out->slope_sum > 0 ? law.force / load * out->slope_sum : 0;
        out->flags |= SEL_FORCE_SLIDING;
        out->sliding_sum = law.force;
    }
    out->friction_sum = law.force;
    out->friction_work = dot3(f, move);
    out->stored += law.force * law.force / (2 * c->m.friction_stiffness * c->m.weight);
    write_friction(slip, size, f, law, c, &now->contact);
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

// What is known of a contact before its force: see closing_of() of contact_law.h.
SEL_FN Closing cell_closing(const InstrumentScene* scene, CellPoint deepest, ContactState old, int fresh, const LawContext* c)
{
    Closing closing;
    const real gap_t0 = gap_at_start(scene, deepest.s, deepest.g.at);
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

// Where the deepest point is and how it closes.
SEL_FN void write_deepest(CellPoint deepest, const InstrumentScene* scene, Closing closing, uint epoch, InstrumentState* now)
{
    const vec3 n = deepest.g.n;
    const vec3 x = spline_sum(scene->a, deepest.a.node, deepest.a.w) - (scene->part.reach_a + deepest.gap) * n;
    now->contact.epoch = epoch;
    now->contact.gap = deepest.gap;
    now->contact.rate = closing.rate;
    now->contact.approach = closing.approach;
    store_vec(now->contact.normal, n);
    store_vec(now->contact.point, x);
    now->along_a = deepest.s;
    now->along_b = spline_material(scene->b, deepest.g.at);
    now->contact.triangle = edge_near(scene->b, now->along_b, (uint)deepest.g.at);
}

// The state of a cell that touches nothing: how it closes. (Its approach speed is taken when it touches.)
SEL_FN void follow_cell(const InstrumentScene* scene, const CellPieces* cell, real inv_dt, uint epoch, InstrumentState* now)
{
    const CellMark least = cell->least[cell->deepest];
    const CellPoint bottom = cell_point(scene, least.s, least.at);
    const real gap_t0 = gap_at_start(scene, bottom.s, bottom.g.at);
    Closing closing;
    closing.rate = gap_t0 < SEL_FAR ? (gap_t0 - bottom.gap) * inv_dt : (real)0;
    closing.approach = closing.rate;
    write_deepest(bottom, scene, closing, epoch, now);
}

// What a cell that touches exerts, and its state.
// @param fresh  `old` is none             c->mv.epoch: of this step     points  [SEL_INSTRUMENT_POINTS] as many as push are written
SEL_FN void cell_force(const InstrumentScene* scene, const CellPieces* cell, ContactState old, int fresh, LawContext* c,
                       InstrumentState* now, InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const CellMark least = cell->least[cell->deepest];
    const CellPoint bottom = cell_point(scene, least.s, least.at);
    const Closing closing = cell_closing(scene, bottom, old, fresh, c);
    write_deepest(bottom, scene, closing, c->mv.epoch, now);
    if (blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    real moment = 0, touching = 0;
    for (uint k = 0; k < cell->cuts.pieces; ++k) {
        if (cell->least[k].gap >= 0) continue;
        const CellMark left = cell->cuts.at[k], right = cell->cuts.at[k + 1];
        const CellMark from = left.gap < 0 ? left : gap_zero(scene, cell->least[k], left);
        const CellMark until = right.gap < 0 ? right : gap_zero(scene, cell->least[k], right);
        moment += push_along(scene, from, until, closing, c, out, points);
        touching += until.s - from.s;
    }
    if (out->count == 0) return;
    now->length = out->length = touching;
    now->contact.flags |= SEL_CONTACT_ACTIVE;
    now->contact.normal_force = out->normal_sum;
    if (c->par.friction == SEL_FRICTION_NONE) return;
    const CellPoint middle = cell_point(scene, moment / out->normal_sum, least.at);
    if (middle.gap >= SEL_FAR) return;
    CarriedState carried;
    carried.old = old;
    carried.was_active = !fresh && (old.flags & SEL_CONTACT_ACTIVE);
    c->m.weight = touching;
    rub_at(scene, middle, carried, c, now, out);
}

SEL_END
#endif
