// Contact of one cell of rod a with a stretch of rod b: which part of the cell touches, the normal force along it, friction in
// the middle of it.
//
// The gap is taken as a function of the material coordinate s along the cell. Its second derivative jumps where the cell passes a
// knot of either spline or the plane of the mouth, and between these it may change its sign once, as nodes are not evenly spaced:
// there the cell is cut into pieces, so that a piece has one least value, if any. (A search over the whole cell saw an overlap
// between two maxima of the gap when an end of the cell touched, too, and not when it did not: a force that jumps, and no
// equilibrium to be found.) The least value is found, and the zeros on both sides of it, or the ends of the piece; between them the
// force per metre is integrated by Gauss. So a line contact has its force per metre, a crossing one its lens, wherever they lie on
// the cells: what one piece loses its neighbour gains, and nothing jumps. The integrand vanishes at zeros, whose motion therefore
// does not count in the tangent; that the Gauss points move with them is left out of it (they stay on material where the cell
// touches as a whole).
//
// Friction is that of the whole force of the cell at its centroid: slip of a's surface past b's there, with both spins and the
// turning of both tangents (friction_law.h). Both surfaces are taken at one point, on a's, so that force, couple and torques on
// the two rods are those of one force and its opposite.
#ifndef SEL_SHARED_INSTRUMENT_CELL_H
#define SEL_SHARED_INSTRUMENT_CELL_H
#include "shared/contact_records.h"
#include "shared/instrument_gap.h"
#include "shared/instrument_law.h"

SEL_BEGIN

// The two rods at the trial and at the start of the step.
typedef struct InstrumentScene {
    SplineView a, b, a_t0, b_t0;
    GapPart part;
    real apart;  // self: how far along the wire two points that touch are at least [m]
    uint edge;   // of a that the cell begins on
} InstrumentScene;

// A point of the cell.
typedef struct CellPoint {
    real s, gap, slope;  // slope: of the gap with the arc length of a [-]
    SplinePlace a;
    InstrumentGap g;
} CellPoint;

SEL_FN GapPart part_for(const InstrumentScene* scene, SplineView b, real s)
{
    GapPart part = scene->part;
    if (part.touch == SEL_TOUCH_SELF) part.low = spline_at(b, s + scene->apart);
    return part;
}

SEL_FN CellPoint cell_point(const InstrumentScene* scene, real s, real start)
{
    CellPoint point;
    point.s = s;
    point.a = spline_place(spline_at_near(scene->a, s, scene->edge), scene->a.count);
    point.g = instrument_gap(scene->b, spline_sum(scene->a, point.a.node, point.a.w), start, part_for(scene, scene->b, s));
    point.gap = point.g.gap;
    const vec3 along = spline_sum(scene->a, point.a.node, point.a.d);
    point.slope = dot3(point.g.n, along) / sqrt(dot3(along, along));
    return point;
}

// What is kept of a point of the cell while the cell is looked through.
typedef struct CellMark {
    real s, gap, slope, at;  // at: of b
} CellMark;

SEL_FN CellMark cell_mark(const InstrumentScene* scene, real s, real start)
{
    const CellPoint point = cell_point(scene, s, start);
    CellMark mark;
    mark.s = s;
    mark.gap = point.gap;
    mark.slope = point.slope;
    mark.at = point.g.at;
    return mark;
}

// A mark between two others, a share of the way from the first to the second: looked for where these say that it is.
SEL_FN CellMark mark_between(const InstrumentScene* scene, CellMark left, CellMark right, real share)
{
    return cell_mark(scene, left.s + share * (right.s - left.s), left.at + share * (right.at - left.at));
}

// ---- pieces -----------------------------------------------------------------------------------------------------------------

// The root in [0, 1] of c + b u + a u^2, which has one sign at 0 and the other at 1.
SEL_FN real root_between(real a, real b, real c)
{
    const real root = sqrt(max_r(b * b - 4 * a * c, 0));
    const real q = (real)-0.5 * (b < 0 ? b - root : b + root), first = q != 0 ? c / q : (real)0.5;
    return first >= 0 && first <= 1 ? first : clamp_r(a != 0 ? q / a : (real)0.5, 0, 1);
}

// Ends of the pieces.
typedef struct CellCuts {
    CellMark at[SEL_CELL_PIECES + 1];
    uint pieces;
} CellCuts;

#define SEL_CUT_STEPS 12
#define SEL_NO_CUT ((real)1e-6)  // of the cell, of an edge: nearer to an end there is none

// The first knot of a rod's curve beyond `from` and before `until`, in either direction; `until` where there is none.
// Knots lie at 1/2, 3/2, ... count - 3/2.
SEL_FN real next_knot(SplineView rod, real from, real until)
{
    const real onwards = until > from ? (real)1 : (real)-1;
    const real index = onwards > 0 ? floor(from + (real)0.5) + 1 : ceil(from + (real)0.5) - 1;  // of the knot, 1 the first
    const real knot = index - (real)0.5;
    if (rod.count < 3 || (knot - until) * onwards >= 0 || index < 1 || index > (real)rod.count - 1) return until;
    return knot;
}

// Where a goes through the plane across b at `knot`, as a share of the way between two points of a that are on one piece of its
// curve: a quadratic equation of the coordinate along it. < 0: there is no one place.
SEL_FN real share_at_plane(const InstrumentScene* scene, CellMark left, CellMark right, real knot)
{
    const SplinePlace b = spline_place(knot, scene->b.count);
    const vec3 centre = spline_sum(scene->b, b.node, b.w), normal = spline_sum(scene->b, b.node, b.d);
    const real from = spline_at_near(scene->a, left.s, scene->edge), until = spline_at_near(scene->a, right.s, scene->edge);
    real beyond[3];
    for (int k = 0; k < 3; ++k) {
        const SplinePlace a = spline_place(from + (real)0.5 * (real)k * (until - from), scene->a.count);
        beyond[k] = dot3(spline_sum(scene->a, a.node, a.w) - centre, normal);
    }
    if (!(beyond[0] * beyond[2] < 0)) return -1;
    const real u = root_between(2 * (beyond[0] - 2 * beyond[1] + beyond[2]), 4 * beyond[1] - 3 * beyond[0] - beyond[2], beyond[0]);
    return (spline_material(scene->a, from + u * (until - from)) - left.s) / (right.s - left.s);
}

// Where b's coordinate is `knot`, which it passes between two points.
SEL_FN CellMark cut_at(const InstrumentScene* scene, CellMark left, CellMark right, real knot)
{
    const real onwards = right.at > left.at ? (real)1 : (real)-1, plane = share_at_plane(scene, left, right, knot);
    CellMark best = left;
    for (int k = 0; k < SEL_CUT_STEPS; ++k) {
        real share = k % 2 == 0 ? clamp_r((knot - left.at) / (right.at - left.at), (real)0.01, (real)0.99) : (real)0.5;
        if (k == 0 && plane >= 0) share = plane;
        best = cell_mark(scene, left.s + share * (right.s - left.s), k == 0 ? knot : left.at);
        if (fabs(best.at - knot) < SEL_NO_CUT) break;
        if ((best.at - knot) * onwards < 0) left = best;
        else right = best;
        if (left.at == right.at) break;
    }
    return best;
}

// Adds a cut unless there is one, or there are too many.
SEL_FN void add_cut(CellMark cut, real until, CellCuts* cuts)
{
    const real least = SEL_NO_CUT * (until - cuts->at[0].s);
    if (cuts->pieces + 1 < SEL_CELL_PIECES && cut.s > cuts->at[cuts->pieces].s + least && cut.s < until - least)
        cuts->at[++cuts->pieces] = cut;
}

// Between the last cut and `right` nothing jumps: cut where the second derivative of the cubic that has both ends' gaps and slopes
// is none.
SEL_FN void cut_smooth(const InstrumentScene* scene, CellMark right, real until, CellCuts* cuts)
{
    const CellMark left = cuts->at[cuts->pieces];
    const real length = right.s - left.s;
    if (!(length > 0) || left.gap >= SEL_FAR || right.gap >= SEL_FAR) return;
    const real bulge = 6 * ((right.gap - left.gap) / length - (real)0.5 * (left.slope + right.slope));
    const real turns = right.slope - left.slope;
    if (fabs(turns) >= fabs(bulge)) return;
    add_cut(mark_between(scene, left, right, (real)0.5 + (real)0.5 * turns / bulge), until, cuts);
}

// Cuts what lies between the last cut and `right`, a knot of a or the cell's end: at knots of b and at the plane of its mouth.
SEL_FN void cut_along_b(const InstrumentScene* scene, CellMark right, real until, CellCuts* cuts)
{
    CellMark left = cuts->at[cuts->pieces];
    if (left.gap >= SEL_FAR || right.gap >= SEL_FAR) return;
    const real onwards = right.at > left.at ? (real)1 : (real)-1;
    const real plane = scene->part.touch == SEL_TOUCH_INSIDE ? scene->part.low + (real)1e-3 : (real)-1;  // at is never less
    for (uint k = 0; k + 1 < SEL_CELL_PIECES && left.at != right.at; ++k) {
        const real from = left.at + 2 * SEL_NO_CUT * onwards;
        real knot = next_knot(scene->b, from, right.at);
        if ((plane - from) * onwards > 0 && (knot - plane) * onwards > 0) knot = plane;
        if ((right.at - knot) * onwards <= 0) break;
        left = cut_at(scene, left, right, knot);
        cut_smooth(scene, left, until, cuts);
        add_cut(left, until, cuts);
    }
    cut_smooth(scene, right, until, cuts);
}

// @param right  the end of the cell
SEL_FN void cut_cell(const InstrumentScene* scene, CellMark left, CellMark right, CellCuts* cuts)
{
    const real last = spline_at_near(scene->a, right.s, scene->edge);
    cuts->at[0] = left;
    cuts->pieces = 0;
    real at = spline_at_near(scene->a, left.s, scene->edge);
    for (int more = 1; more;) {
        at = next_knot(scene->a, at, last);
        more = at != last;
        const CellMark end = more ? cell_mark(scene, spline_material(scene->a, at), cuts->at[cuts->pieces].at) : right;
        cut_along_b(scene, end, right.s, cuts);
        add_cut(end, right.s, cuts);
    }
    cuts->at[++cuts->pieces] = right;
}

// The largest curvature of a rod's curve between two places [1/m]: c' x c'' of a piece is e x f of its two edges, and |c'| not less
// than cos(30 degrees) of the shorter one where they turn by 60 degrees at most.
SEL_FN real most_curved(SplineView rod, real from, real until)
{
    real most = 0;
    if (rod.count < 3) return most;
    const real low = max_r(min_r(from, until) + (real)0.5, 1), high = min_r(max_r(from, until) + (real)0.5, (real)rod.count - 2);
    for (uint i = (uint)low; i <= (uint)high; ++i) {
        const vec3 x = node_at(rod, i), e = x - node_at(rod, i - 1), f = node_at(rod, i + 1) - x, turn = cross3(e, f);
        const real ee = dot3(e, e), ff = dot3(f, f), shorter = min_r(ee, ff), ef = dot3(e, f);
        if (ef <= 0 || 4 * ef * ef < ee * ff) return SEL_FAR;
        most = max_r(most, (real)1.6 * sqrt(dot3(turn, turn) / shorter) / shorter);
    }
    return most;
}

// By how much the gap between two points is positive at least, by what their gaps and curvatures leave room for: with g'' <= k,
// g >= min(g0, g1) - k l^2/8. D'' is at most kappa_a + kappa_b/(1 - kappa_b D) + 1/D of the distance between two curves, and inside
// a lumen, where the gap falls with D, the last term is none. 0: nothing can be told.
SEL_FN real least_room(const InstrumentScene* scene, CellMark left, CellMark right)
{
    const real gap = min_r(left.gap, right.gap);
    if (gap <= 0 || max_r(left.gap, right.gap) >= SEL_FAR) return 0;
    const int inside = scene->part.touch == SEL_TOUCH_INSIDE;
    if (inside && min_r(left.at, right.at) <= scene->part.low) return 0;  // a mouth
    const real a = most_curved(scene->a, spline_at_near(scene->a, left.s, scene->edge), spline_at_near(scene->a, right.s, scene->edge));
    const real b = most_curved(scene->b, left.at, right.at), reach = scene->part.reach_a + scene->part.reach_b;
    const real far = inside ? scene->part.reach_b : max_r(left.gap, right.gap) + reach + (right.s - left.s);
    if (3 * b * far > 1) return 0;
    const real k = a + (real)1.5 * b + (inside ? (real)0 : 1 / reach), length = right.s - left.s;
    return gap - (real)0.125 * (real)1.1 * k * length * length;  // 1.1: of a wire that is stretched
}

// How far both rods together move at least before a cell whose gaps are `room` and more touches: no distance between curves changes by
// more than they move. Known in a lumen only, as far from its mouth and its end as the place along b may have moved.
SEL_FN real clear_move(const InstrumentScene* scene, CellMark left, CellMark right, real room)
{
    const GapPart part = scene->part;
    if (part.touch != SEL_TOUCH_INSIDE || room <= 0 || max_r(left.gap, right.gap) >= SEL_FAR) return 0;
    const real low = min_r(left.at, right.at), high = max_r(left.at, right.at);
    if (low <= part.low || high >= part.high) return 0;
    const real from_mouth = spline_material(scene->b, low) - spline_material(scene->b, part.low);
    const real from_end = spline_material(scene->b, part.high) - spline_material(scene->b, high);
    return min_r(room, (real)0.5 * min_r(from_mouth, from_end));
}

// ---- of one piece -----------------------------------------------------------------------------------------------------------

#define SEL_CELL_STEPS 24
#define SEL_LEVEL ((real)1e-6)  // slope that counts as none: misses the least gap by 1e-12 of the radii
#define SEL_ZERO ((real)1e-6)   // of the deepest: a gap that counts as none

// The cubic that has the gaps and slopes of two points, by its coefficients with the share of the way between them.
typedef struct GapCubic {
    real c[4];
} GapCubic;

SEL_FN GapCubic cubic_between(CellMark left, CellMark right)
{
    const real length = right.s - left.s, rise = right.gap - left.gap;
    GapCubic cubic;
    cubic.c[0] = left.gap;
    cubic.c[1] = length * left.slope;
    cubic.c[2] = 3 * rise - length * (2 * left.slope + right.slope);
    cubic.c[3] = length * (left.slope + right.slope) - 2 * rise;
    return cubic;
}

// The least gap between two points: where its slope changes sign, by that of the cubic between them, and by halving where that leads
// nowhere.
SEL_FN CellMark least_gap(const InstrumentScene* scene, CellMark left, CellMark right)
{
    if (left.slope >= 0 && right.slope <= 0) return left.gap < right.gap ? left : right;
    if (left.slope >= 0) return left;
    if (right.slope <= 0) return right;
    CellMark best = left.gap < right.gap ? left : right;
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const GapCubic cubic = cubic_between(left, right);
        const int smooth = k % 3 < 2 && left.gap < SEL_FAR && right.gap < SEL_FAR;
        const real share = smooth ? root_between(3 * cubic.c[3], 2 * cubic.c[2], cubic.c[1]) : (real)0.5;
        const CellMark middle = mark_between(scene, left, right, share);
        if (middle.gap < best.gap) best = middle;
        if (fabs(middle.slope) < SEL_LEVEL || middle.gap >= SEL_FAR) break;
        if (middle.slope < 0) left = middle;
        else right = middle;
    }
    return best;
}

// Where the cubic between a point that overlaps and one that does not is none: three steps of Newton's method from the chord's zero.
SEL_FN real zero_between(CellMark in, CellMark out)
{
    const GapCubic cubic = cubic_between(in, out);
    const real chord = in.gap / (in.gap - out.gap);
    real u = chord;
    for (int k = 0; k < 3; ++k) {
        const real value = cubic.c[0] + (cubic.c[1] + (cubic.c[2] + cubic.c[3] * u) * u) * u;
        const real slope = cubic.c[1] + (2 * cubic.c[2] + 3 * cubic.c[3] * u) * u;
        if (!(slope > 0)) return chord;
        u = clamp_r(u - value / slope, 0, 1);
    }
    return u > 0 && u < 1 ? u : chord;
}

// Where the gap closes, between a point that overlaps and one that does not.
SEL_FN CellMark gap_zero(const InstrumentScene* scene, CellMark in, CellMark out)
{
    const real enough = SEL_ZERO * fabs(in.gap);
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const real share = k % 3 < 2 && out.gap < SEL_FAR ? zero_between(in, out) : (real)0.5;
        const CellMark middle = mark_between(scene, in, out, share);
        if (fabs(middle.gap) <= enough) return middle;
        if (middle.gap < 0) in = middle;
        else out = middle;
    }
    return in;
}

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

// Force and its growth at one Gauss point of `weight` metres.
SEL_FN void push_at(CellPoint point, real weight, Closing closing, const LawContext* c, InstrumentForce* out,
                    SEL_GLOBAL InstrumentPoint* points)
{
    real slope;
    const real per_metre = damped_force(closing, c, &slope);
    if (per_metre <= 0) return;
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
    p.force = weight * per_metre;
    p.slope = weight * slope;
    p.node_a = point.a.node;
    p.node_b = point.g.b.node;
    points[out->count++] = p;
    real ignored;
    out->normal_sum += p.force;
    out->slope_sum += p.slope;
    out->stored += weight * elastic_normal(closing.depth, c->m, &ignored) * closing.depth / (c->m.exponent + 1);
}

// The normal force between two ends of what touches of a piece. @return its moment: sum of force times s
SEL_FN real push_along(const InstrumentScene* scene, CellMark left, CellMark right, Closing closing, const LawContext* c,
                       InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const real half_length = (real)0.5 * (right.s - left.s), middle = (real)0.5 * (left.s + right.s);
    real moment = 0;
    for (uint k = 0; k < SEL_INSTRUMENT_POINTS / SEL_CELL_PIECES; ++k) {
        const real s = middle + half_length * gauss_place(k), before = out->normal_sum;
        const CellPoint point = cell_point(scene, s, (real)0.5 * (left.at + right.at + gauss_place(k) * (right.at - left.at)));
        if (point.gap >= 0) continue;
        Closing here = closing;
        here.depth = -point.gap;
        if (c->par.inv_dt > 0 && c->m.damping > 0) {
            const real gap_t0 = gap_at_start(scene, s, point.g.at);
            here.depth_t0 = gap_t0 < SEL_FAR ? -gap_t0 : here.depth;
            here.rate = (here.depth - here.depth_t0) * c->par.inv_dt;
        }
        push_at(point, half_length * gauss_weight(k), here, c, out, points);
        moment += (out->normal_sum - before) * s;
    }
    return moment;
}

// One rod's surface at the contact: what its nodes do to it.
typedef struct SurfaceMotion {
    SplinePlace place;
    vec3 lever;    // from the axis to the contact [m]
    vec3 tangent;  // unit
    real length;   // |c'| [m]
    uint edge;     // that spins
    vec3 move;     // of the contact over the step [m]
} SurfaceMotion;

// @param edge  near the material point
SEL_FN SurfaceMotion surface_motion(SplineView now, SplineView then, real at, real material, uint edge, vec3 lever)
{
    SurfaceMotion m;
    m.place = spline_place(at, now.count);
    m.lever = lever;
    m.edge = edge_near(now, material, edge);
    const uint edge_t0 = edge_near(then, material, edge);
    const vec3 along = spline_sum(now, m.place.node, m.place.d);
    m.length = sqrt(dot3(along, along));
    m.tangent = (1 / m.length) * along;
    const SplinePlace old = spline_place(spline_at_edge(then, material, edge_t0), then.count);
    const vec3 along_t0 = spline_sum(then, old.node, old.d);
    const vec3 turn = m.tangent - (1 / sqrt(dot3(along_t0, along_t0))) * along_t0;
    const real spin = now.theta[m.edge] - then.theta[edge_t0];
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
    out->edge_a = a.edge;
    out->edge_b = b.edge;
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
    none.node_a = none.node_b = none.edge_a = none.edge_b = none.count = none.flags = none.pair = none.pad = 0;
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

// A cell as it lies: its pieces and the least gap of each.
typedef struct CellPieces {
    CellCuts cuts;  // none where the whole cell is known to be clear
    CellMark least[SEL_CELL_PIECES];
    uint deepest;
} CellPieces;

// @param s0, s1  ends of the cell [m]     start  near where along b     out  depth and `clear` are written
SEL_FN void look_through(const InstrumentScene* scene, real s0, real s1, real start, CellPieces* cell, InstrumentForce* out)
{
    const CellMark first = cell_mark(scene, s0, start), last = cell_mark(scene, s1, first.at);
    cell->deepest = cell->cuts.pieces = 0;
    cell->least[0] = first.gap < last.gap ? first : last;
    real room = least_room(scene, first, last);
    if (room <= 0) {
        cut_cell(scene, first, last, &cell->cuts);
        for (uint k = 0; k < cell->cuts.pieces; ++k) {
            cell->least[k] = least_gap(scene, cell->cuts.at[k], cell->cuts.at[k + 1]);
            if (cell->least[k].gap < cell->least[cell->deepest].gap) cell->deepest = k;
        }
        room = cell->least[cell->deepest].gap;
    }
    out->depth = -cell->least[cell->deepest].gap;
    out->clear = clear_move(scene, first, last, room);
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
