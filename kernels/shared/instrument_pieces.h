// The part of a cell of rod a that touches a stretch of rod b.
//
// The gap is taken as a function of the material coordinate s along the cell. Its second derivative jumps where the cell passes a
// knot of either spline or the plane of the mouth. Between these it may change its sign once, as nodes are not evenly spaced.
// There the cell is cut into pieces, so that a piece has at most one minimum. A search over the whole cell would see an overlap
// between two maxima of the gap only when an end of the cell touches too. Its force would jump, and there would be no
// equilibrium. The search finds the minimum, and the zeros on both sides of it or the ends of the piece.
#ifndef SEL_SHARED_INSTRUMENT_PIECES_H
#define SEL_SHARED_INSTRUMENT_PIECES_H
#include "shared/contact_records.h"
#include "shared/instrument_gap.h"

SEL_BEGIN

// SEL_STAGE_FN: what a processor's one kernel has in a place of its own, and a card's stages (kernels/contact/instruments.cl) in
// line: arguments by address would lie in a card's scratch memory. SEL_ONCE: SEL_ROLLED in stages alone.
#if SEL_SUMS_IN_MEMORY
    #define SEL_STAGE_FN SEL_FN
    #define SEL_ONCE SEL_ROLLED
#else
    #define SEL_STAGE_FN SEL_CALL
    #define SEL_ONCE
#endif

// A cell of rod a, and rod b, at the trial and at the start of the step.
typedef struct InstrumentScene {
    SplineView a, b, a_t0, b_t0;
    GapPart part;
    real s0, s1;  // the cell of a [m]
    uint edge;    // of a that it begins on
    // of a rod with itself
    real apart;        // how far along the wire two points that touch are at least [m]
    real from, until;  // stretch of b, as coordinates of its curve
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

SEL_FN void measure_slope(const InstrumentScene* scene, CellPoint* point)
{
    point->gap = point->g.gap;
    const vec3 along = spline_sum(scene->a, point->a.node, point->a.d);
    point->slope = dot3(point->g.n, along) / sqrt(dot3(along, along));
}

// Where a point of the cell is on a, and the nearest on b.
typedef struct CellPlace {
    real of_a;
    Closest near;
} CellPlace;

// @param start  where on b to look
SEL_FN CellPlace searched_place(const InstrumentScene* scene, GapPart part, real s, real start)
{
    CellPlace place;
    place.of_a = spline_at_near(scene->a, s, scene->edge);
    const SplinePlace a = spline_place(place.of_a, scene->a.count);
    place.near = closest_on(scene->b, spline_sum(scene->a, a.node, a.w), start, part.low, part.high);
    return place;
}

SEL_FN void set_point_at(const InstrumentScene* scene, GapPart part, real s, CellPlace place, CellPoint* point)
{
    point->s = s;
    point->a = spline_place(place.of_a, scene->a.count);
    set_gap(scene->b, spline_sum(scene->a, point->a.node, point->a.w), place.near, part, &point->g);
    measure_slope(scene, point);
}

SEL_FN void find_point(const InstrumentScene* scene, real s, real start, CellPoint* point)
{
    const GapPart part = part_for(scene, scene->b, s);
    set_point_at(scene, part, s, searched_place(scene, part, s, start), point);
}

// Data of a point of the cell during the search of the cell.
typedef struct CellMark {
    real s, gap, slope, at;  // at: of b
} CellMark;

SEL_FN CellMark mark_of(const CellPoint* point)
{
    const CellMark mark = {point->s, point->gap, point->slope, point->g.at};
    return mark;
}

// Where a cell is deepest: on a's axis, and the direction there.
typedef struct DeepPoint {
    CellMark mark;
    real x[3], n[3];  // not vec3, whose size is not the same on a card
} DeepPoint;

SEL_FN DeepPoint deep_point(const InstrumentScene* scene, const CellPoint* point)
{
    DeepPoint deep;
    deep.mark = mark_of(point);
    store_vec(deep.x, spline_sum(scene->a, point->a.node, point->a.w));
    store_vec(deep.n, point->g.n);
    return deep;
}

#if SEL_SUMS_IN_MEMORY
    #ifdef SEL_FLOAT32
typedef float8 CalledPoint;
    #else
typedef double8 CalledPoint;
    #endif

SEL_FN CalledPoint called_point(const CellPoint* point, CellPlace place)
{
    const vec3 n = point->g.n;
    return (CalledPoint)(point->gap, point->slope, point->g.at, n.x, n.y, n.z, place.of_a, (real)place.near.bound);
}

// @param kind  touch, low_ends, high_ends     low  of one rod with itself: InstrumentScene.apart
SEL_CALL CalledPoint point_of_values(SEL_GLOBAL const real* a_position, SEL_GLOBAL const real* a_material, uint a_count,
                                     SEL_GLOBAL const real* b_position, SEL_GLOBAL const real* b_material, uint b_count,
                                     uint edge, uint kind, real low, real high, real reach_a, real reach_b, real rim, real s,
                                     real start)
{
    InstrumentScene scene;
    scene.a.position = a_position;
    scene.a.material = a_material;
    scene.a.count = a_count;
    scene.b.position = b_position;
    scene.b.material = b_material;
    scene.b.count = b_count;
    scene.edge = edge;
    scene.apart = low;
    scene.part.touch = kind & 3u;
    scene.part.low_ends = kind >> 2 & 1u;
    scene.part.high_ends = kind >> 3;
    scene.part.low = low;
    scene.part.high = high;
    scene.part.reach_a = reach_a;
    scene.part.reach_b = reach_b;
    scene.part.rim = rim;
    const GapPart part = part_for(&scene, scene.b, s);
    const CellPlace place = searched_place(&scene, part, s, start);
    CellPoint point;
    set_point_at(&scene, part, s, place, &point);
    return called_point(&point, place);
}

SEL_FN CellMark called_mark(real s, CalledPoint got)
{
    const CellMark mark = {s, got.s0, got.s1, got.s2};
    return mark;
}

SEL_FN CellPlace called_place(CalledPoint got)
{
    CellPlace place;
    place.of_a = got.s6;
    place.near.at = got.s2;
    place.near.bound = (int)got.s7;
    return place;
}

SEL_FN DeepPoint called_deep(const InstrumentScene* scene, real s, CalledPoint got)
{
    DeepPoint deep;
    deep.mark = called_mark(s, got);
    const SplinePlace a = spline_place(got.s6, scene->a.count);
    store_vec(deep.x, spline_sum(scene->a, a.node, a.w));
    store_vec(deep.n, make_vec3(got.s3, got.s4, got.s5));
    return deep;
}

// A point of the rods a and b as they are at one time. On a card it is called with numbers alone: a scene lies in scratch memory
// if its address is handed over, or itself (500 bytes more), vectors of its numbers too on gfx906, and in line it would be 13 kB
// each time.
SEL_FN CalledPoint point_between_rods(const InstrumentScene* scene, SplineView a, SplineView b, real s, real start)
{
    const GapPart part = scene->part;
    const uint kind = part.touch | (uint)(part.low_ends != 0) << 2 | (uint)(part.high_ends != 0) << 3;
    const real low = part.touch == SEL_TOUCH_SELF ? scene->apart : part.low;
    return point_of_values(a.position, a.material, a.count, b.position, b.material, b.count, scene->edge, kind, low, part.high,
                           part.reach_a, part.reach_b, part.rim, s, start);
}

SEL_FN CellMark cell_mark(const InstrumentScene* scene, real s, real start)
{
    return called_mark(s, point_between_rods(scene, scene->a, scene->b, s, start));
}

SEL_FN void find_place(const InstrumentScene* scene, real s, real start, CellPlace* place)
{
    *place = called_place(point_between_rods(scene, scene->a, scene->b, s, start));
}

SEL_FN DeepPoint cell_bottom(const InstrumentScene* scene, CellMark near)
{
    return called_deep(scene, near.s, point_between_rods(scene, scene->a, scene->b, near.s, near.at));
}
#else
// In line, find_point() is left without the gap's Hessian.
SEL_CALL CellMark cell_mark(const InstrumentScene* scene, real s, real start)
{
    CellPoint point;
    find_point(scene, s, start, &point);
    return mark_of(&point);
}

SEL_CALL void find_place(const InstrumentScene* scene, real s, real start, CellPlace* place)
{
    *place = searched_place(scene, part_for(scene, scene->b, s), s, start);
}

// @param near  of the deepest mark
SEL_CALL DeepPoint cell_bottom(const InstrumentScene* scene, CellMark near)
{
    CellPoint point;
    find_point(scene, near.s, near.at, &point);
    return deep_point(scene, &point);
}
#endif

SEL_FN CellPoint cell_point(const InstrumentScene* scene, real s, real start)
{
    CellPlace place;
    CellPoint point;
    find_place(scene, s, start, &place);
    set_point_at(scene, part_for(scene, scene->b, s), s, place, &point);
    return point;
}

// A mark between two others, a share of the path from the first to the second: looked for where these say that it is.
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

// Intersection of a with the plane across b at `knot`, as a fraction of the path between two points of a on one piece of its
// curve. It solves a quadratic equation of the coordinate along the piece. < 0: there is no single place.
SEL_FN real share_at_plane(const InstrumentScene* scene, CellMark left, CellMark right, real knot)
{
    const SplinePlace b = spline_place(knot, scene->b.count);
    const vec3 centre = spline_sum(scene->b, b.node, b.w), normal = spline_sum(scene->b, b.node, b.d);
    const real from = spline_at_near(scene->a, left.s, scene->edge), until = spline_at_near(scene->a, right.s, scene->edge);
    real beyond[3];
    SEL_ONCE for (int k = 0; k < 3; ++k)
    {
        const SplinePlace a = spline_place(from + (real)0.5 * (real)k * (until - from), scene->a.count);
        beyond[k] = dot3(spline_sum(scene->a, a.node, a.w) - centre, normal);
    }
    if (!(beyond[0] * beyond[2] < 0)) return -1;
    const real u =
        root_between(2 * (beyond[0] - 2 * beyond[1] + beyond[2]), 4 * beyond[1] - 3 * beyond[0] - beyond[2], beyond[0]);
    return (spline_material(scene->a, from + u * (until - from)) - left.s) / (right.s - left.s);
}

// Where b's coordinate is `knot`, which it passes between two points.
SEL_FN CellMark cut_at(const InstrumentScene* scene, CellMark left, CellMark right, real knot)
{
    const real onwards = right.at > left.at ? (real)1 : (real)-1, plane = share_at_plane(scene, left, right, knot);
    CellMark best = left;
    SEL_ONCE for (int k = 0; k < SEL_CUT_STEPS; ++k)
    {
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
SEL_FN void add_cut(CellMark cut, real until, SEL_OUT CellCuts* cuts)
{
    const real least = SEL_NO_CUT * (until - cuts->at[0].s);
    if (cuts->pieces + 1 < SEL_CELL_PIECES && cut.s > cuts->at[cuts->pieces].s + least && cut.s < until - least)
        cuts->at[++cuts->pieces] = cut;
}

// Between the last cut and `right` nothing jumps: cut where the second derivative of the cubic that has both ends' gaps and
// slopes is none.
SEL_FN void cut_smooth(const InstrumentScene* scene, CellMark right, real until, SEL_OUT CellCuts* cuts)
{
    const CellMark left = cuts->at[cuts->pieces];
    const real length = right.s - left.s;
    if (!(length > 0) || left.gap >= SEL_FAR || right.gap >= SEL_FAR) return;
    const real bulge = 6 * ((right.gap - left.gap) / length - (real)0.5 * (left.slope + right.slope));
    const real turns = right.slope - left.slope;
    if (fabs(turns) >= fabs(bulge)) return;
    add_cut(mark_between(scene, left, right, (real)0.5 + (real)0.5 * turns / bulge), until, cuts);
}

// Cuts the part between the last cut and `right`, a knot of a or the cell's end: at knots of b and at the plane of its mouth.
SEL_FN void cut_along_b(const InstrumentScene* scene, CellMark right, real until, SEL_OUT CellCuts* cuts)
{
    CellMark left = cuts->at[cuts->pieces];
    if (left.gap >= SEL_FAR || right.gap >= SEL_FAR) return;
    const real onwards = right.at > left.at ? (real)1 : (real)-1;
    const real plane = scene->part.touch == SEL_TOUCH_INSIDE ? scene->part.low + (real)1e-3 : (real)-1;  // at is never less
    SEL_ONCE for (uint k = 0; k + 1 < SEL_CELL_PIECES && left.at != right.at; ++k)
    {
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
SEL_FN void cut_cell(const InstrumentScene* scene, CellMark left, CellMark right, SEL_OUT CellCuts* cuts)
{
    const real last = spline_at_near(scene->a, right.s, scene->edge);
    cuts->at[0] = left;
    cuts->pieces = 0;
    real at = spline_at_near(scene->a, left.s, scene->edge);
    SEL_ONCE for (int more = 1; more;)
    {
        at = next_knot(scene->a, at, last);
        more = at != last;
        const CellMark end = more ? cell_mark(scene, spline_material(scene->a, at), cuts->at[cuts->pieces].at) : right;
        cut_along_b(scene, end, right.s, cuts);
        add_cut(end, right.s, cuts);
    }
    cuts->at[++cuts->pieces] = right;
}

// The largest curvature of a rod's curve between two places [1/m]. c' x c'' of a piece is e x f of its two edges. |c'| is not
// less than cos(30 degrees) of the shorter edge if they turn by 60 degrees at most.
SEL_FN real most_curved(SplineView rod, real from, real until)
{
    real most = 0;
    if (rod.count < 3) return most;
    const real low = max_r(min_r(from, until) + (real)0.5, 1), high = min_r(max_r(from, until) + (real)0.5, (real)rod.count - 2);
    SEL_ONCE for (uint i = (uint)low; i <= (uint)high; ++i)
    {
        const vec3 x = node_at(rod, i), e = x - node_at(rod, i - 1), f = node_at(rod, i + 1) - x, turn = cross3(e, f);
        const real ee = dot3(e, e), ff = dot3(f, f), shorter = min_r(ee, ff), ef = dot3(e, f);
        if (ef <= 0 || 4 * ef * ef < ee * ff) return SEL_FAR;
        most = max_r(most, (real)1.6 * sqrt(dot3(turn, turn) / shorter) / shorter);
    }
    return most;
}

// By how much the gap between two points is positive at least, by what their gaps and curvatures leave room for: with g'' <= k,
// g >= min(g0, g1) - k l^2/8. D'' is at most kappa_a + kappa_b/(1 - kappa_b D) + 1/D of the distance between two curves. Inside a
// lumen, where the gap falls with D, there is no last term. 0: unknown.
// @param from, until  where on a's curve both are
SEL_FN real least_room(const InstrumentScene* scene, CellMark left, CellMark right, real from, real until)
{
    const real gap = min_r(left.gap, right.gap);
    if (gap <= 0 || max_r(left.gap, right.gap) >= SEL_FAR) return 0;
    const int inside = scene->part.touch == SEL_TOUCH_INSIDE;
    if (inside && min_r(left.at, right.at) <= scene->part.low) return 0;  // a mouth
    const real a = most_curved(scene->a, from, until);
    const real b = most_curved(scene->b, left.at, right.at), reach = scene->part.reach_a + scene->part.reach_b;
    const real far = inside ? scene->part.reach_b : max_r(left.gap, right.gap) + reach + (right.s - left.s);
    if (3 * b * far > 1) return 0;
    const real k = a + (real)1.5 * b + (inside ? (real)0 : 1 / reach), length = right.s - left.s;
    return gap - (real)0.125 * (real)1.1 * k * length * length;  // 1.1: of a wire that is stretched
}

// How far both rods together move at least before a cell whose gaps are `room` and more touches: no distance between curves
// changes by more than they move. Known in a lumen only, as far from its mouth and its end as the place along b may have moved.
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

// The cubic that has the gaps and slopes of two points, by its coefficients with the share of the path between them.
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

// The least gap between two points: where its slope changes sign, by that of the cubic between them, and by halving where that
// leads nowhere.
SEL_FN CellMark least_gap(const InstrumentScene* scene, CellMark left, CellMark right)
{
    if (left.slope >= 0 && right.slope <= 0) return left.gap < right.gap ? left : right;
    if (left.slope >= 0) return left;
    if (right.slope <= 0) return right;
    CellMark best = left.gap < right.gap ? left : right;
    SEL_ONCE for (int k = 0; k < SEL_CELL_STEPS; ++k)
    {
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

// Where the cubic between a point that overlaps and one that does not is none: three steps of Newton's method from the chord's
// zero.
SEL_FN real zero_between(CellMark in, CellMark out)
{
    const GapCubic cubic = cubic_between(in, out);
    const real chord = in.gap / (in.gap - out.gap);
    real u = chord;
    SEL_ONCE for (int k = 0; k < 3; ++k)
    {
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
    SEL_ONCE for (int k = 0; k < SEL_CELL_STEPS; ++k)
    {
        const real share = k % 3 < 2 && out.gap < SEL_FAR ? zero_between(in, out) : (real)0.5;
        const CellMark middle = mark_between(scene, in, out, share);
        if (fabs(middle.gap) <= enough) return middle;
        if (middle.gap < 0) in = middle;
        else out = middle;
    }
    return in;
}

// A cell as it lies: its pieces and the least gap of each.
typedef struct CellPieces {
    CellCuts cuts;  // none where the whole cell is known to be clear
    CellMark least[SEL_CELL_PIECES];
    uint deepest;
} CellPieces;

// The ends of a cell.
typedef struct CellEnds {
    CellMark first, last;
    real room;  // see least_room()
} CellEnds;

// @param start  near where along b
SEL_STAGE_FN CellEnds cell_ends(const InstrumentScene* scene, real start)
{
    CellEnds ends;
    ends.first = cell_mark(scene, scene->s0, start);
    ends.last = cell_mark(scene, scene->s1, ends.first.at);
    ends.room = least_room(scene, ends.first, ends.last, spline_at_near(scene->a, scene->s0, scene->edge),
                           spline_at_near(scene->a, scene->s1, scene->edge));
    return ends;
}

// @param gap  least     room  see clear_move()
SEL_FN void write_room(const InstrumentScene* scene, CellEnds ends, real gap, real room, SEL_OUT InstrumentForce* out)
{
    out->depth = -gap;
    out->clear = clear_move(scene, ends.first, ends.last, room);
}

// @param out  depth and `clear` are written
SEL_STAGE_FN void look_through(const InstrumentScene* scene, CellEnds ends, SEL_OUT CellPieces* cell,
                               SEL_OUT InstrumentForce* out)
{
    const CellMark first = ends.first, last = ends.last;
    cell->deepest = cell->cuts.pieces = 0;
    cell->least[0] = first.gap < last.gap ? first : last;
    real room = ends.room;
    if (room <= 0) {
        cut_cell(scene, first, last, &cell->cuts);
        SEL_ONCE for (uint k = 0; k < cell->cuts.pieces; ++k)
        {
            cell->least[k] = least_gap(scene, cell->cuts.at[k], cell->cuts.at[k + 1]);
            if (cell->least[k].gap < cell->least[cell->deepest].gap) cell->deepest = k;
        }
        room = cell->least[cell->deepest].gap;
    }
    write_room(scene, ends, cell->least[cell->deepest].gap, room, out);
}

SEL_END
#endif
