// Contact of a rod with itself: one cell of its material and a stretch of others (D13).
//
// In a tight knot a strand is bent about as sharply as it is thick. The other strand then has no single nearest place on it. At
// kappa D = 1 (D: distance of the axes) the nearest place splits into two, and a force that acts there doubles.
// So here every point of the cell pushes every point of the stretch that is nearer than both radii,
//
//     E = int int psi(delta) ds dt,     delta = r_a + r_b - |x(s) - x(t)|,     q = psi' = C delta^(n - 1/2) h(delta),
//
// which is smooth however the strands are bent. Between straight strands side by side delta is d - t^2/(2 D) across from a point,
// and
//
//     int q dt = C sqrt(2 D) B(1/2, n + 1/2) d^n = k d^n,     C = k / (sqrt(2 (r_a + r_b)) B(1/2, n + 1/2)),
//
// the line law of instrument_law.h; strands that cross at an angle a have its force there, which grows as 1/sin a. The hardening
// h acts on delta as it does on the depth. The pole lies at the same depth, and the force short of it is less by up to the loss
// of a lens at its rims.
//
// s and t are material coordinates; t > s + pi r. Over s the force is integrated between the zeros of the least gap, a quarter of
// a cell at a time, over t between those of the distance, whose square is a quartic on each piece of the curve. Damping goes by
// how fast the least gap at s closes, not by how fast two points of the material come nearer, which they do too when they slide
// past each other.
#ifndef SEL_SHARED_INSTRUMENT_SELF_H
#define SEL_SHARED_INSTRUMENT_SELF_H
#include "shared/instrument_cell.h"

SEL_BEGIN

#define SEL_SELF_APART ((real)3.141592653589793)  // radii along a wire nearer than which it does not touch itself
#define SEL_SELF_PARTS 8                          // of a cell, looked at for whether they touch
#define SEL_SELF_RULES 4                          // of a cell, with a rule of quadrature each; a whole number of parts
#define SEL_SELF_STRETCHES 4                      // of a piece of the curve, looked at for lobes
#define SEL_SELF_LOBES 4                          // stretches of a cell that a point touches, at most
#define SEL_SELF_LEVEL ((real)1e-4)  // slope that counts as none: misses the least gap by 1e-8 of the radii

// ---- what a point of a sees of the stretch -----------------------------------------------------------------------------------

// Stretch of b's curve that the point s may touch. @return whether there is any
SEL_FN int self_range(const InstrumentScene* scene, real s, real* from, real* until)
{
    *from = max_r(scene->from, spline_at(scene->b, s + scene->apart));
    *until = scene->until;
    return *from < *until;
}

// |x - c|^2 and half of its derivative at `at` of a piece.
SEL_FN real square_at(SeenPiece piece, real at)
{
    const real t = at - piece.origin;
    return piece.r_r + (2 * piece.first + (piece.linear + (2 * piece.c1_c2 + piece.c2_c2 * t) * t) * t) * t;
}
SEL_FN real half_slope_at(SeenPiece piece, real at)
{
    const real t = at - piece.origin;
    return piece.first + (piece.linear + (3 * piece.c1_c2 + 2 * piece.c2_c2 * t) * t) * t;
}

// Near where the distance from x is least, of all places between two: where it is looked for from.
SEL_FN real nearest_place(SplineView b, vec3 x, real low, real high)
{
    real best = low, least = SEL_FAR;
    for (real from = low; from < high;) {
        const SeenPiece piece = seen_piece(b, x, from);
        const real until = min_r(piece.high, high);
        for (int k = from > low; k <= SEL_SELF_STRETCHES; ++k) {  // a piece begins where the one before ends
            const real at = from + (real)k / SEL_SELF_STRETCHES * (until - from), square = square_at(piece, at);
            if (square >= least) continue;
            least = square;
            best = at;
        }
        from = until > from ? until : high;
    }
    return best;
}

SEL_FN CellPoint self_point(const InstrumentScene* scene, real s)
{
    CellPoint point;
    point.s = s;
    point.slope = 0;
    point.a = spline_place(spline_at_near(scene->a, s, scene->edge), scene->a.count);
    GapPart part = scene->part;
    part.low_ends = part.high_ends = 1;  // what is beyond is too far
    if (self_range(scene, s, &part.low, &part.high)) {
        const vec3 x = spline_sum(scene->a, point.a.node, point.a.w), along = spline_sum(scene->a, point.a.node, point.a.d);
        point.g = instrument_gap(scene->b, x, nearest_place(scene->b, x, part.low, part.high), part);
        point.slope = dot3(point.g.n, along) / sqrt(dot3(along, along));
    } else {
        point.g = no_gap(scene->until);
    }
    point.gap = point.g.gap;
    return point;
}

#if SEL_SUMS_IN_MEMORY
// See point_of_values().
SEL_CALL CalledPoint self_point_of_values(SEL_GLOBAL const real* position, SEL_GLOBAL const real* material, uint count, uint edge,
                                          real from, real until, real apart, real reach_a, real reach_b, real s)
{
    InstrumentScene scene;
    scene.a.position = position;
    scene.a.material = material;
    scene.a.count = count;
    scene.b = scene.a;
    scene.edge = edge;
    scene.apart = apart;
    scene.part.touch = SEL_TOUCH_SELF;
    scene.part.reach_a = reach_a;
    scene.part.reach_b = reach_b;
    scene.part.rim = 0;
    scene.from = from;
    scene.until = until;
    CellPlace place;
    place.of_a = spline_at_near(scene.a, s, edge);
    place.near.bound = 0;
    const CellPoint point = self_point(&scene, s);
    return called_point(&point, place);
}

SEL_FN CalledPoint called_self(const InstrumentScene* scene, real s)
{
    return self_point_of_values(scene->a.position, scene->a.material, scene->a.count, scene->edge, scene->from, scene->until,
                                scene->apart, scene->part.reach_a, scene->part.reach_b, s);
}

SEL_FN CellMark self_mark(const InstrumentScene* scene, real s) { return called_mark(s, called_self(scene, s)); }
SEL_FN DeepPoint self_bottom(const InstrumentScene* scene, real s) { return called_deep(scene, s, called_self(scene, s)); }
#else
SEL_FN CellMark self_mark(const InstrumentScene* scene, real s)
{
    const CellPoint point = self_point(scene, s);
    return mark_of(&point);
}

SEL_FN DeepPoint self_bottom(const InstrumentScene* scene, real s)
{
    const CellPoint point = self_point(scene, s);
    return deep_point(scene, &point);
}
#endif

// Stretches of b that are nearer to a point than the radii.
typedef struct SelfLobes {
    real from[SEL_SELF_LOBES], until[SEL_SELF_LOBES];
    uint count;
} SelfLobes;

// Where the distance is `reach`, between a place that is nearer and one that is not.
SEL_FN real lobe_end(SeenPiece piece, real in, real out, real reach)
{
    const real enough = (real)1e-12 * reach * reach;
    real at = (real)0.5 * (in + out);
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const real value = square_at(piece, at) - reach * reach, slope = 2 * half_slope_at(piece, at);
        if (fabs(value) <= enough) break;
        if (value < 0) in = at;
        else out = at;
        real next = at - value / slope;
        if (!(next > min_r(in, out) && next < max_r(in, out))) next = (real)0.5 * (in + out);
        at = next;
    }
    return at;
}

// Where the distance is least, between a place from which it falls and one to which it rises.
SEL_FN real lobe_bottom(SeenPiece piece, real falls, real rises)
{
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const real f = half_slope_at(piece, falls), r = half_slope_at(piece, rises);
        const real share = k % 2 == 0 && r > f ? clamp_r(f / (f - r), (real)0.01, (real)0.99) : (real)0.5;
        const real at = falls + share * (rises - falls);
        if (half_slope_at(piece, at) < 0) falls = at;
        else rises = at;
    }
    return (real)0.5 * (falls + rises);
}

// Adds nearer points between two places of a piece; `open`: the last lobe continues at the first of them.
SEL_FN void add_lobes(SeenPiece piece, real left, real right, real reach, int* open, SEL_OUT SelfLobes* lobes)
{
    const real reach2 = reach * reach;
    const int in_left = square_at(piece, left) < reach2, in_right = square_at(piece, right) < reach2;
    real bottom = in_left ? left : right;
    if (!in_left && !in_right) {
        *open = 0;
        if (!(half_slope_at(piece, left) < 0 && half_slope_at(piece, right) > 0)) return;
        bottom = lobe_bottom(piece, left, right);
        if (!(square_at(piece, bottom) < reach2)) return;
    }
    const real from = in_left ? left : lobe_end(piece, bottom, left, reach);
    const real until = in_right ? right : lobe_end(piece, bottom, right, reach);
    if (*open && in_left) {
        lobes->until[lobes->count - 1] = until;
    } else if (lobes->count < SEL_SELF_LOBES) {
        lobes->from[lobes->count] = from;
        lobes->until[lobes->count++] = until;
    }
    *open = in_right;
}

SEL_FN void find_lobes(SplineView b, vec3 x, real low, real high, real reach, SEL_OUT SelfLobes* lobes)
{
    lobes->count = 0;
    int open = 0;
    for (real from = low; from < high;) {
        const SeenPiece piece = seen_piece(b, x, from);
        const real until = min_r(piece.high, high), step = (until - from) / SEL_SELF_STRETCHES;
        SEL_ONCE for (int k = 0; k < SEL_SELF_STRETCHES; ++k)
        {
            const real right = k + 1 == SEL_SELF_STRETCHES ? until : from + (real)(k + 1) * step;
            add_lobes(piece, from + (real)k * step, right, reach, &open, lobes);
        }
        from = until > from ? until : high;
    }
}

// ---- which part of the cell touches ------------------------------------------------------------------------------------------

// The least gap of a part, where both ends are higher.
SEL_FN CellMark self_least(const InstrumentScene* scene, CellMark left, CellMark right)
{
    CellMark best = left.gap < right.gap ? left : right;
    // gaps change by as much as the point moves, at most
    if (!(left.slope < 0 && right.slope > 0) || best.gap > right.s - left.s || max_r(left.gap, right.gap) >= SEL_FAR) return best;
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const real share = k % 3 < 2 ? clamp_r(left.slope / (left.slope - right.slope), (real)0.01, (real)0.99) : (real)0.5;
        const CellMark middle = self_mark(scene, left.s + share * (right.s - left.s));
        if (middle.gap < best.gap) best = middle;
        if (fabs(middle.slope) < SEL_SELF_LEVEL || middle.gap >= SEL_FAR) break;
        if (middle.slope < 0) left = middle;
        else right = middle;
    }
    return best;
}

SEL_FN real self_zero(const InstrumentScene* scene, CellMark in, CellMark out)
{
    const real enough = SEL_ZERO * fabs(in.gap);
    for (int k = 0; k < SEL_CELL_STEPS; ++k) {
        const real share = k % 3 < 2 && out.gap < SEL_FAR ? zero_between(in, out) : (real)0.5;
        const CellMark middle = self_mark(scene, in.s + share * (out.s - in.s));
        if (fabs(middle.gap) <= enough) return middle.s;
        if (middle.gap < 0) in = middle;
        else out = middle;
    }
    return in.s;
}

// Ends of the stretches of a cell that touch, and the deepest place.
//
// Two stretches may grow together within a step, or come apart. One rule over both gives another force than a rule over each: by
// 2 % if a deep place and a shallow one share a cell. Newton's method cannot solve across such a jump, however short the step. So
// no rule takes more than a quarter of a cell: what grows together within one is shallow, and the jump is below 1e-3 of the
// force, which Newton's method lets pass where positions are known to 1e-6 radii (newton/kinks.cpp).
typedef struct SelfTouch {
    real from[SEL_SELF_PARTS + 1], until[SEL_SELF_PARTS + 1];
    uint count;
    CellMark deepest;
    real clear;  // no point of the cell has a smaller gap; 0: not known [m]
} SelfTouch;

// @param joined  0: another rule begins at `left`
SEL_FN void add_touch(const InstrumentScene* scene, CellMark left, CellMark right, int joined, SEL_OUT SelfTouch* touch)
{
    const CellMark least = self_least(scene, left, right);
    if (least.gap < touch->deepest.gap) touch->deepest = least;
    if (least.gap >= 0) return;
    const real from = left.gap < 0 ? left.s : self_zero(scene, least, left);
    const real until = right.gap < 0 ? right.s : self_zero(scene, least, right);
    if (left.gap < 0 && touch->count > 0 && joined) {
        touch->until[touch->count - 1] = until;  // goes on from the part before
        return;
    }
    touch->from[touch->count] = from;
    touch->until[touch->count++] = until;
}

#define SEL_LONGER ((real)1.5)  // of an edge that is stretched: longer ones are torn (engine/bodies/rod/no_state.h)

// How far the gap may lie below both of two marks between them, `apart` along the material. The gap is the least of smooth
// functions of s, one for each near place of the stretch. None curves by more than 1/D + kappa_a + kappa_b, which is 2/r with
// axes 1.5 radii apart and strands bent about as sharply as they are thick. Such a function dips by h^2/(4 r) at most below its
// values at the ends of a length h.
SEL_FN real dip_between(const InstrumentScene* scene, real apart)
{
    const real h = SEL_LONGER * apart;
    return h * h / (4 * min_r(scene->part.reach_a, scene->part.reach_b));
}

// Marks of a cell, SEL_SELF_PARTS apart; the odd ones are found where the even ones leave it open whether anything touches.
typedef struct SelfMarks {
    CellMark at[SEL_SELF_PARTS + 1];
    CellMark least;
} SelfMarks;

SEL_FN void mark_cell(const InstrumentScene* scene, int first, SEL_OUT SelfMarks* marks)
{
    const real length = scene->s1 - scene->s0;
    SEL_ONCE for (int k = first; k <= SEL_SELF_PARTS; k += 2)
    {
        marks->at[k] = self_mark(scene, scene->s0 + (real)k / SEL_SELF_PARTS * length);
        if (k == 0 || marks->at[k].gap < marks->least.gap) marks->least = marks->at[k];
    }
}

// @param follows  gap up to which it counts how a cell that touches nothing closes [m]     @return 0: it is clear
SEL_FN int mark_self(const InstrumentScene* scene, real follows, SEL_OUT SelfMarks* marks, SEL_OUT SelfTouch* touch)
{
    touch->count = 0;
    const real length = scene->s1 - scene->s0;
    SEL_ONCE for (int first = 0; first < 2; ++first)
    {
        mark_cell(scene, first, marks);
        touch->deepest = marks->least;
        touch->clear = marks->least.gap < SEL_FAR
                           ? marks->least.gap - dip_between(scene, (real)(2 - first) * length / SEL_SELF_PARTS)
                           : (real)0;
        if (touch->clear > follows) return 0;
    }
    return 1;
}

SEL_FN void touch_self(const InstrumentScene* scene, SEL_OUT const SelfMarks* marks, SEL_OUT SelfTouch* touch)
{
    SEL_ONCE for (int k = 0; k < SEL_SELF_PARTS; ++k)
        add_touch(scene, marks->at[k], marks->at[k + 1], k % (SEL_SELF_PARTS / SEL_SELF_RULES) != 0, touch);
}

// ---- forces ---------------------------------------------------------------------------------------------------------------------

// The line law's force between two points, per metre of both: q above.
SEL_FN LawContext pair_law(const LawContext* c, real reach, real spread)
{
    LawContext pair = *c;
    pair.m.stiffness = c->m.stiffness * spread / sqrt(2 * reach);
    pair.m.exponent = c->m.exponent - (real)0.5;
    return pair;
}

// Sums over all pairs of points, weighted with their forces.
typedef struct SelfSums {
    real along_a, along_b;  // material coordinates [N m]
    real n[3];              // [N]; not a vec3, whose size is not the same on a card
    real metres;            // that touch, as a strand beside a straight one would
} SelfSums;

// The factor that damping puts on the elastic force at one point of a, and how it grows with the depth: damped_force() of
// contact_law.h.
typedef struct SelfDamping {
    real factor, growth;  // [-], [1/m]
} SelfDamping;

SEL_FN SelfDamping damping_at(real rate, Closing closing, const LawContext* c)
{
    SelfDamping damping;
    damping.factor = 1;
    damping.growth = 0;
    if (c->par.inv_dt == 0 || c->m.damping == 0) return damping;
    const real per_speed = c->m.damping / closing.approach;
    const int own_speed = closing.fresh && closing.rate > c->m.speed_floor;  // v- is this step's rate: the factor is 1 + beta
    damping.factor = max_r(1 + per_speed * rate, 0);
    if (!own_speed && damping.factor > 0) damping.growth = per_speed * c->par.inv_dt;
    return damping;
}

// The speed v- at which the damping of a strand of mass m per metre is critical at a depth: f beta/v- = 2 sqrt(m df/d(depth)).
// With f = k depth^n, v- = (beta/2) sqrt(k depth^(n + 1)/(n m)). An impact never comes to it: at its deepest it is 0.46 beta of
// the speed of the impact (n = 3/2). At the depth under the own weight it is the floor of instrument_law.h; a knot's contacts
// carry a hundred thousand times that, and with that floor they would be damped over many steps.
SEL_FN real critical_speed(real depth, real line_mass, QuadratureModel m)
{
    if (depth <= 0) return 0;
    return m.damping / 2 * sqrt(m.stiffness * depth_power(depth, m.exponent) * depth / (m.exponent * line_mass));
}

// One pair of points: `weight` metres of a times metres of b.
SEL_FN void push_pair(const InstrumentScene* scene, CellPoint point, vec3 x, real at, real weight, SelfDamping damping,
                      const LawContext* law, SEL_OUT SelfSums* sums, SEL_OUT InstrumentForce* out,
                      SEL_GLOBAL InstrumentPoint* points)
{
    point.g = no_gap(at);
    point.g.b = spline_place(at, scene->b.count);
    const vec3 away = x - spline_sum(scene->b, point.g.b.node, point.g.b.w);
    const real distance = sqrt(dot3(away, away)), depth = scene->part.reach_a + scene->part.reach_b - distance;
    if (depth <= 0 || distance <= 0 || out->count == SEL_INSTRUMENT_POINTS) return;
    point.g.n = (1 / distance) * away;
    point.g.m[0] = point.g.m[3] = point.g.m[5] = 1 / distance;
    add_square(point.g.m, -1 / distance, point.g.n);
    real slope;
    const real elastic = weight * elastic_normal(depth, law->m, &slope), force = damping.factor * elastic;
    put_point(&point, force, damping.factor * weight * slope + damping.growth * elastic, out, points);
    out->stored += elastic * depth / (law->m.exponent + 1);
    sums->along_a += force * point.s;
    sums->along_b += force * spline_material(scene->b, at);
    add_vec(sums->n, force * point.g.n);
}

// ---- quadrature ------------------------------------------------------------------------------------------------------------------
//
// A quarter of a cell that touches all along has three points of Gauss-Legendre, fixed in the material: their forces are smooth
// in the nodes, with an exact tangent. Where the gap is none at an end of it they take depth^(3/2) to 5e-4 of the little that
// such a quarter bears.
//
// Elsewhere the slope of the force grows from where the gap is none as the power n - 1 of the way over s, n - 3/2 over t. If that
// is whole, four points of Gauss-Legendre take it exactly. A half power is smoothed by u = (3 v - v^3)/2: over v six points take
// its second moment to 6e-5, four over u to 3 %. All that keeps two strands from sliding along each other is about 1 % of the
// slope. The tangent misses the rule's error there, so Newton's method would take tens of iterations.

typedef struct RulePoint {
    real u, weight;  // in [-1, 1]
} RulePoint;

SEL_FN int is_half(real power) { return fabs(power - floor(power) - (real)0.5) < (real)0.25; }
SEL_FN uint rule_points(real power) { return is_half(power) ? 6 : 4; }

// @param power  of the slope
SEL_FN RulePoint rule_point(uint k, real power)
{
    RulePoint point;
    if (!is_half(power)) {
        point.u = gauss_place(k);
        point.weight = gauss_weight(k);
        return point;
    }
    const uint from_middle = k < 3 ? 2 - k : k - 3;
    const real u = from_middle == 0   ? (real)0.35113539637062335
                   : from_middle == 1 ? (real)0.8472744177084373
                                      : (real)0.9933134321150445;
    point.u = k < 3 ? -u : u;
    point.weight = from_middle == 0   ? (real)0.6619069931842173
                   : from_middle == 1 ? (real)0.30455608193457856
                                      : (real)0.033536924881204806;
    return point;
}

SEL_FN RulePoint inner_point(uint k)
{
    const RulePoint point = {k == 1   ? (real)0
                             : k == 0 ? (real)-0.7745966692414834
                                      : (real)0.7745966692414834,
                             k == 1 ? (real)8 / 9 : (real)5 / 9};
    return point;
}
#define SEL_INNER_POINTS 3u

// ---- all of a cell ----------------------------------------------------------------------------------------------------------------

// All that one point of a pushes; `weight` metres of it.
SEL_FN void push_lobes(const InstrumentScene* scene, real s, real weight, Closing closing, const LawContext* law,
                       SEL_OUT SelfLobes* lobes, SEL_OUT SelfSums* sums, SEL_OUT InstrumentForce* out,
                       SEL_GLOBAL InstrumentPoint* points)
{
    const CellMark mark = self_mark(scene, s);
    real from, until, touching = 0;
    if (mark.gap >= 0 || !self_range(scene, s, &from, &until)) return;
    const SelfDamping damping = damping_at(closing_rate(scene, mark, law->par.inv_dt), closing, law);
    if (damping.factor <= 0) return;
    CellPoint point;
    point.s = s;
    point.gap = mark.gap;
    point.slope = mark.slope;
    point.a = spline_place(spline_at_near(scene->a, s, scene->edge), scene->a.count);
    const vec3 x = spline_sum(scene->a, point.a.node, point.a.w);
    const real reach = scene->part.reach_a + scene->part.reach_b;
    find_lobes(scene->b, x, from, until, reach, lobes);
    SEL_ONCE for (uint k = 0; k < lobes->count; ++k)
    {
        const real middle = (real)0.5 * (lobes->from[k] + lobes->until[k]),
                   half_length = (real)0.5 * (lobes->until[k] - lobes->from[k]);
        SEL_ONCE for (uint q = 0; q < rule_points(law->m.exponent - 1); ++q)
        {
            const RulePoint rule = rule_point(q, law->m.exponent - 1);
            const real at = middle + half_length * rule.u;
            const SplinePlace place = spline_place(at, scene->b.count);
            real metres = 0;  // of material for a step along the curve
            for (uint i = 0; i < 3; ++i)
                if (place.d[i] != 0) metres += place.d[i] * scene->b.material[place.node + i];
            metres *= half_length * rule.weight;
            touching += metres;
            push_pair(scene, point, x, at, weight * metres, damping, law, sums, out, points);
        }
    }
    sums->metres += weight * min_r(touching / (2 * sqrt(-2 * reach * mark.gap)), 1);
}

// Where the force of all pairs acts: what friction goes by.
SEL_FN CellPoint self_middle(const InstrumentScene* scene, SelfSums sums, real force, real gap)
{
    const vec3 n = make_vec3(sums.n[0], sums.n[1], sums.n[2]);
    CellPoint middle;
    middle.s = sums.along_a / force;
    middle.gap = gap;
    middle.slope = 0;
    middle.a = spline_place(spline_at_near(scene->a, middle.s, scene->edge), scene->a.count);
    middle.g = no_gap(spline_at(scene->b, sums.along_b / force));
    middle.g.gap = gap;
    middle.g.b = spline_place(middle.g.at, scene->b.count);
    middle.g.centre = spline_sum(scene->b, middle.g.b.node, middle.g.b.w);
    middle.g.n = (1 / sqrt(dot3(n, n))) * n;
    return middle;
}

// A cell and a stretch of the same rod while they are evaluated: on a card in memory, from one stage to the next.
typedef struct SelfWork {
    SelfMarks marks;
    SelfTouch touch;
    SelfLobes lobes;
    SelfSums sums;
    Closing closing;
} SelfWork;

// How a cell that touches closes where it is deepest.
// @param line_mass  of the lighter strand [kg/m]
SEL_FN void close_self(const InstrumentScene* scene, const SlotLaw* slot, real line_mass, SEL_OUT SelfWork* work,
                       SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out)
{
    const LawContext* c = &slot->law;
    const DeepPoint bottom = self_bottom(scene, work->touch.deepest.s);
    Closing closing = cell_closing(scene, cell_mark(scene, bottom.mark.s, bottom.mark.at), slot);
    write_deepest(scene, bottom, closing, c->mv.epoch, now);
    if (blocked(closing, c)) out->flags |= SEL_FORCE_BLOCKED;
    closing.approach = max_r(closing.approach, critical_speed(closing.depth_t0, line_mass, c->m));
    work->closing = closing;
}

// What such a cell exerts.
SEL_FN void push_self(const InstrumentScene* scene, const LawContext* c, real spread, SEL_OUT SelfWork* work,
                      SEL_OUT InstrumentForce* out, SEL_GLOBAL InstrumentPoint* points)
{
    const LawContext law = pair_law(c, scene->part.reach_a + scene->part.reach_b, spread);
    const real whole = (real)0.5 * (1 - (real)1e-9) * (scene->s1 - scene->s0) / SEL_SELF_RULES;
    const Closing closing = work->closing;
    SEL_OUT const SelfTouch* touch = &work->touch;
    SEL_OUT SelfSums* sums = &work->sums;
    sums->along_a = sums->along_b = sums->metres = sums->n[0] = sums->n[1] = sums->n[2] = 0;
    SEL_ONCE for (uint k = 0; k < touch->count; ++k)
    {
        const real middle = (real)0.5 * (touch->from[k] + touch->until[k]),
                   half_length = (real)0.5 * (touch->until[k] - touch->from[k]);
        const int inner = half_length >= whole;
        SEL_ONCE for (uint q = 0; q < (inner ? SEL_INNER_POINTS : rule_points(c->m.exponent - 1)); ++q)
        {
            const RulePoint rule = inner ? inner_point(q) : rule_point(q, c->m.exponent - 1);
            push_lobes(scene, middle + half_length * rule.u, half_length * rule.weight, closing, &law, &work->lobes, sums, out,
                       points);
        }
    }
}

// Its state, and friction, once it has pushed.
SEL_FN void finish_self(const InstrumentScene* scene, const SlotLaw* slot, SEL_OUT const SelfWork* work,
                        SEL_OUT InstrumentState* now, SEL_OUT InstrumentForce* out)
{
    const SelfSums sums = work->sums;
    if (out->count == 0 || !write_touch(sums.metres, slot, now, out)) return;
    if (sums.n[0] * sums.n[0] + sums.n[1] * sums.n[1] + sums.n[2] * sums.n[2] > 0)
        rub_at(scene, self_middle(scene, sums, out->normal_sum, now->contact.gap), slot, now, out);
}

SEL_END
#endif
