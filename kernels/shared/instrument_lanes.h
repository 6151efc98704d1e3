// The nearest places of eight points side by side: four of a cell, at the trial and at the start of the step; or both ends of
// four cells (instrument_block.h). What most of an evaluation is.
//
// Between knots a curve is c_0 + c_1 t + c_2 t^2, and the nearest place on b is a root of a cubic (spline.h, SeenPiece). Newton's
// method runs for all eight at once, each on its piece of a's curve and beside one of b's. If a lane leaves its piece, comes to
// the mouth or to an end, or does not converge, its result is unknown, and the caller searches for it alone.
#ifndef SEL_SHARED_INSTRUMENT_LANES_H
#define SEL_SHARED_INSTRUMENT_LANES_H
#include "shared/instrument_pieces.h"
#include "shared/lanes.h"

SEL_BEGIN

#define SEL_LANE_STEPS 6  // of Newton's method; two or three are taken

// A rod's curve between two knots.
typedef struct CurvePiece {
    vec3 c0, c1, c2;
    real s0, s1, s2;        // the same of the material coordinate
    real low, high, origin;  // holds for low <= at <= high, t = at - origin
} CurvePiece;

SEL_FN CurvePiece curve_piece(SplineView rod, real at)
{
    CurvePiece p;
    const real end = (real)rod.count - (real)1.5;
    if (rod.count < 3 || at <= (real)0.5 || at >= end) {
        const uint node = rod.count < 3 || at <= (real)0.5 ? 0 : rod.count - 2;
        p.origin = (real)node;
        p.low = node == 0 ? (real)0 : end;
        p.high = node == 0 && rod.count > 2 ? (real)0.5 : (real)(rod.count - 1);
        p.c0 = node_at(rod, node);
        p.c1 = node_at(rod, node + 1) - p.c0;
        p.c2 = make_vec3(0, 0, 0);
        p.s0 = rod.material[node];
        p.s1 = rod.material[node + 1] - p.s0;
        p.s2 = 0;
        return p;
    }
    const uint node = (uint)(at + (real)0.5);
    const vec3 before = node_at(rod, node - 1), x = node_at(rod, node), after = node_at(rod, node + 1);
    const real s_before = rod.material[node - 1], s = rod.material[node], s_after = rod.material[node + 1];
    p.origin = p.low = (real)node - (real)0.5;
    p.high = p.low + 1;
    p.c0 = (real)0.5 * (before + x);
    p.c1 = x - before;
    p.c2 = (real)0.5 * (after - x - p.c1);
    p.s0 = (real)0.5 * (s_before + s);
    p.s1 = s - s_before;
    p.s2 = (real)0.5 * (s_after - s - p.s1);
    return p;
}

// Whether four places, in order, are on one piece: there is no knot between the first and the last.
SEL_FN int on_same_piece(SplineView rod, const real* at)
{
    const real from = min_r(at[0], at[3]), until = max_r(at[0], at[3]), end = (real)rod.count - (real)1.5;
    if (rod.count < 3 || until <= (real)0.5 || from >= end) return 1;
    return from > (real)0.5 && until < end && floor(from + (real)0.5) == floor(until + (real)0.5);
}

// The pieces that eight points lie on.
typedef struct LanePieces {
    Lanes3 c0, c1, c2;
    real8 s0, s1, s2, low, high, origin;
} LanePieces;

#if SEL_LANES == 8
SEL_LANES_FN Lanes3 halves3(vec3 a, vec3 b) { return make_lanes3(halves8(a.x, b.x), halves8(a.y, b.y), halves8(a.z, b.z)); }

// Four on one piece, four on another.
SEL_LANES_FN LanePieces on_two_pieces(CurvePiece now, CurvePiece then)
{
    LanePieces p;
    p.c0 = halves3(now.c0, then.c0);
    p.c1 = halves3(now.c1, then.c1);
    p.c2 = halves3(now.c2, then.c2);
    p.s0 = halves8(now.s0, then.s0);
    p.s1 = halves8(now.s1, then.s1);
    p.s2 = halves8(now.s2, then.s2);
    p.low = halves8(now.low, then.low);
    p.high = halves8(now.high, then.high);
    p.origin = halves8(now.origin, then.origin);
    return p;
}

// Each on its own. @param of  [8]
SEL_LANES_FN LanePieces on_own_pieces(const CurvePiece* of)
{
    LanePieces p;
#define SEL_EACH(m) of8(of[0].m, of[1].m, of[2].m, of[3].m, of[4].m, of[5].m, of[6].m, of[7].m)
#define SEL_EACH3(m) make_lanes3(SEL_EACH(m.x), SEL_EACH(m.y), SEL_EACH(m.z))
    p.c0 = SEL_EACH3(c0);
    p.c1 = SEL_EACH3(c1);
    p.c2 = SEL_EACH3(c2);
    p.s0 = SEL_EACH(s0);
    p.s1 = SEL_EACH(s1);
    p.s2 = SEL_EACH(s2);
    p.low = SEL_EACH(low);
    p.high = SEL_EACH(high);
    p.origin = SEL_EACH(origin);
#undef SEL_EACH3
#undef SEL_EACH
    return p;
}

// Pieces of four points now and at the start of the step. @param at_now, at_then  [4] about where on the curves
SEL_LANES_FN LanePieces on_pieces_at(SplineView rod_now, SplineView rod_then, const real* at_now, const real* at_then)
{
    if (on_same_piece(rod_now, at_now) && on_same_piece(rod_then, at_then))
        return on_two_pieces(curve_piece(rod_now, at_now[0]), curve_piece(rod_then, at_then[0]));
    CurvePiece of[8];
    for (uint k = 0; k < 4; ++k) {
        of[k] = curve_piece(rod_now, at_now[k]);
        of[4 + k] = curve_piece(rod_then, at_then[k]);
    }
    return on_own_pieces(of);
}

#else
SEL_LANES_FN LanePieces on_own_pieces(const CurvePiece* of)
{
    LanePieces p;
    p.c0 = lanes3_of(of->c0);
    p.c1 = lanes3_of(of->c1);
    p.c2 = lanes3_of(of->c2);
    p.s0 = of->s0;
    p.s1 = of->s1;
    p.s2 = of->s2;
    p.low = of->low;
    p.high = of->high;
    p.origin = of->origin;
    return p;
}
#endif

// Points of the pieces.
SEL_LANES_FN Lanes3 at_pieces(const LanePieces* p, real8 t)
{
    return add_lanes(p->c0, scale_lanes(t, add_lanes(p->c1, scale_lanes(t, p->c2))));
}

// Whether t is beyond its piece. @param margin  tolerance
SEL_LANES_FN mask8 off_pieces(const LanePieces* p, real8 t, real margin)
{
    return (t < p->low - p->origin - margin) | (t > p->high - p->origin + margin);
}

// Nearest points of eight points of a at once.
typedef struct LaneNearest {
    real8 u, t;      // where on their pieces of a, of b
    Lanes3 x, away;  // the points; from the nearest on b
    real8 distance;  // [m]
    mask8 missed;    // nothing is known
} LaneNearest;

// @param s, start  material coordinates on a, where on b to look     low, high  of what of b is allowed
SEL_LANES_FN LaneNearest nearest_in_lanes(real8 s, real8 start, const LanePieces* on_a, const LanePieces* on_b, real8 low,
                                          real8 high)
{
    LaneNearest out;
    // s = s_0 + s_1 u + s_2 u^2
    const real8 ahead = s - on_a->s0, s1 = on_a->s1, s2 = on_a->s2;
    const real8 zero = real8_of(0), square = s1 * s1 + 4 * s2 * ahead;
    out.u = 2 * ahead / (s1 + sqrt8(square < zero ? zero : square));
    out.x = at_pieces(on_a, out.u);
    const Lanes3 r = sub_lanes(out.x, on_b->c0), c1 = on_b->c1, c2 = on_b->c2;
    const real8 c1_c1 = dot_lanes(c1, c1), c1_c2 = dot_lanes(c1, c2), c2_c2 = dot_lanes(c2, c2);
    const real8 first = -dot_lanes(r, c1), linear = c1_c1 - 2 * dot_lanes(r, c2);
    real8 t = start - on_b->origin, moved = real8_of(1), curved = c1_c1;
    for (int k = 0; k < SEL_LANE_STEPS; ++k) {
        const mask8 moves = size8(moved) > real8_of(SEL_CLOSEST_NEAR);  // the others wait: no lane's bits depend on another one's
        if (!any8(moves)) break;
        const real8 bulge = c1_c2 + c2_c2 * t;
        const real8 slope = first + (linear + (bulge + 2 * c1_c2 + c2_c2 * t) * t) * t;
        const real8 here = linear + 6 * bulge * t, step = -slope / here;
        curved = moves ? here : curved;
        moved = moves ? step : moved;
        t = moves ? t + step : t;
    }
    const mask8 found = (size8(moved) <= real8_of(SEL_CLOSEST_NEAR)) & (curved > (real)0.05 * c1_c1) & (t > low - on_b->origin) &
                        (t < high - on_b->origin);
    out.missed = not8(found) | off_pieces(on_b, t, 0) | off_pieces(on_a, out.u, (real)1e-9);
    out.t = t;
    out.away = sub_lanes(r, scale_lanes(t, add_lanes(c1, scale_lanes(t, c2))));
    out.distance = sqrt8(dot_lanes(out.away, out.away));
    return out;
}

// Four points at two times. of_a, at: where on the curves; gap: with b's surface or lumen [m]. known: of all four at that time.
typedef struct LanePlaces {
    real of_a[8], at[8], gap[8];
    int known, known_t0;
} LanePlaces;

// Nothing is known of one rod with itself: where b begins depends on s there.
SEL_FN void no_places(SEL_OUT LanePlaces* out) { out->known = out->known_t0 = 0; }

#if SEL_LANES == 8
SEL_FN int all_known(const real* missed) { return missed[0] == 0 && missed[1] == 0 && missed[2] == 0 && missed[3] == 0; }

// @param s, start  [4]     on_a, on_b  the pieces that these are on
SEL_LANES_FN void places_on(const InstrumentScene* scene, const real* s, const real* start, const LanePieces* on_a,
                            const LanePieces* on_b, SEL_OUT LanePlaces* out)
{
    const GapPart part = scene->part;
    const LaneNearest near = nearest_in_lanes(numbers8(s, s), numbers8(start, start), on_a, on_b, real8_of(part.low),
                                              halves8(part.high, min_r(part.high, (real)(scene->b_t0.count - 1))));
    const real8 reach = real8_of(part.reach_a), other = real8_of(part.reach_b);
    real flags[8];
    put8(near.missed ? real8_of(1) : real8_of(0), flags);
    put8(near.u + on_a->origin, out->of_a);
    put8(near.t + on_b->origin, out->at);
    put8(part.touch == SEL_TOUCH_INSIDE ? other - reach - near.distance : near.distance - reach - other, out->gap);
    out->known = all_known(flags);
    out->known_t0 = all_known(flags + 4);
}

// Positions of four points on one piece of a, beside one of b.
// @param s, start  [4] material coordinates on a, where on b to look     of_a  where on a, near
SEL_FN void places_in_lanes(const InstrumentScene* scene, SEL_OUT const real* s, SEL_OUT const real* start, real of_a,
                            SEL_OUT LanePlaces* out)
{
    if (scene->part.touch == SEL_TOUCH_SELF) {
        no_places(out);
        return;
    }
    const real middle = (real)0.5 * (start[0] + start[3]);
    const real then = spline_at_near(scene->a_t0, (real)0.5 * (s[0] + s[3]), scene->edge);
    const LanePieces on_a = on_two_pieces(curve_piece(scene->a, of_a), curve_piece(scene->a_t0, then));
    const LanePieces on_b = on_two_pieces(curve_piece(scene->b, middle), curve_piece(scene->b_t0, middle));
    places_on(scene, s, start, &on_a, &on_b, out);
}

// Positions of four points, each on its own pieces. @param of_a, of_a_t0, beside  [4] where on the curves of a and of b, near
SEL_FN void places_of(const InstrumentScene* scene, const real* s, const real* start, const real* of_a, const real* of_a_t0,
                      const real* beside, SEL_OUT LanePlaces* out)
{
    const LanePieces on_a = on_pieces_at(scene->a, scene->a_t0, of_a, of_a_t0),
                     on_b = on_pieces_at(scene->b, scene->b_t0, beside, beside);
    places_on(scene, s, start, &on_a, &on_b, out);
}

// Positions of four points anywhere.
SEL_FN void own_places_in_lanes(const InstrumentScene* scene, const real* s, const real* start, LanePlaces* out)
{
    if (scene->part.touch == SEL_TOUCH_SELF) {
        no_places(out);
        return;
    }
    real now[4], then[4];
    for (uint k = 0; k < 4; ++k) {
        now[k] = spline_at_near(scene->a, s[k], scene->edge);
        then[k] = spline_at_near(scene->a_t0, s[k], scene->edge);
    }
    places_of(scene, s, start, now, then, start, out);
}

#else
// One of four points at one of two times. @param k  4 and beyond: at the start of the step     of_a, beside  where on the curves,
// near
SEL_FN void place_of(const InstrumentScene* scene, uint k, real s, real start, real of_a, real beside, SEL_OUT LanePlaces* out)
{
    const int then = k >= 4;
    const GapPart part = scene->part;
    const CurvePiece a = curve_piece(then ? scene->a_t0 : scene->a, of_a), b = curve_piece(then ? scene->b_t0 : scene->b, beside);
    const LanePieces on_a = on_own_pieces(&a), on_b = on_own_pieces(&b);
    const real high = then ? min_r(part.high, (real)(scene->b_t0.count - 1)) : part.high;
    const LaneNearest near = nearest_in_lanes(s, start, &on_a, &on_b, part.low, high);
    out->of_a[k] = near.u + on_a.origin;
    out->at[k] = near.t + on_b.origin;
    out->gap[k] = part.touch == SEL_TOUCH_INSIDE ? part.reach_b - part.reach_a - near.distance
                                                 : near.distance - part.reach_a - part.reach_b;
    if (near.missed && then) out->known_t0 = 0;
    if (near.missed && !then) out->known = 0;
}

// The same, one after another.
SEL_FN void places_in_lanes(const InstrumentScene* scene, SEL_OUT const real* s, SEL_OUT const real* start, real of_a,
                            SEL_OUT LanePlaces* out)
{
    const real middle = (real)0.5 * (start[0] + start[3]);
    const real then = spline_at_near(scene->a_t0, (real)0.5 * (s[0] + s[3]), scene->edge);
    out->known = out->known_t0 = scene->part.touch != SEL_TOUCH_SELF;
    if (!out->known) return;
    SEL_ROLLED for (uint k = 0; k < 8; ++k) place_of(scene, k, s[k % 4], start[k % 4], k < 4 ? of_a : then, middle, out);
}

SEL_FN void own_places_in_lanes(const InstrumentScene* scene, SEL_OUT const real* s, SEL_OUT const real* start,
                                SEL_OUT LanePlaces* out)
{
    out->known = out->known_t0 = scene->part.touch != SEL_TOUCH_SELF;
    if (!out->known) return;
    SEL_ROLLED for (uint k = 0; k < 8; ++k)
    {
        const real of_a = spline_at_near(k < 4 ? scene->a : scene->a_t0, s[k % 4], scene->edge);
        place_of(scene, k, s[k % 4], start[k % 4], of_a, start[k % 4], out);
    }
}
#endif

SEL_END
#endif
