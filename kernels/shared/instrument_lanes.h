// The nearest places of four points of a piece of a cell, at the trial and at the start of the step, side by side: what most of a
// cell's evaluation is.
//
// A piece lies on one piece of a's curve and beside one of b's (instrument_pieces.h). Between knots a curve is c_0 + c_1 t + c_2 t^2, the
// place on b that is nearest a root of a cubic (spline.h, SeenPiece), and Newton's method goes for all four points at both times at
// once, in eight lanes. Where a lane leaves its piece, comes to the mouth or to an end, or does not converge, nothing is known of it,
// and the caller looks for it by itself.
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

SEL_LANES_FN Lanes3 halves3(vec3 a, vec3 b) { return make_lanes3(halves8(a.x, b.x), halves8(a.y, b.y), halves8(a.z, b.z)); }

// c_0 + c_1 t + c_2 t^2 of two pieces, each in four lanes.
SEL_LANES_FN Lanes3 on_pieces(const CurvePiece* now, const CurvePiece* then, real8 t)
{
    const Lanes3 bent = add_lanes(halves3(now->c1, then->c1), scale_lanes(t, halves3(now->c2, then->c2)));
    return add_lanes(halves3(now->c0, then->c0), scale_lanes(t, bent));
}

// Whether t is beyond its piece. @param margin  what is allowed
SEL_LANES_FN mask8 off_pieces(const CurvePiece* now, const CurvePiece* then, real8 t, real margin)
{
    const real8 low = halves8(now->low - now->origin - margin, then->low - then->origin - margin);
    const real8 high = halves8(now->high - now->origin + margin, then->high - then->origin + margin);
    return (t < low) | (t > high);
}

// Four points at two times. of_a, at: where on the curves; gap: with b's surface or lumen [m]. known: of all four at that time.
typedef struct LanePlaces {
    real of_a[8], at[8], gap[8];
    int known, known_t0;
} LanePlaces;

SEL_FN int all_known(const real* missed) { return missed[0] == 0 && missed[1] == 0 && missed[2] == 0 && missed[3] == 0; }

// @param s, start  [4] material coordinates on a, where on b to look     of_a  where on a, near
SEL_FN LanePlaces places_in_lanes(const InstrumentScene* scene, const real* s, const real* start, real of_a)
{
    LanePlaces out;
    const GapPart part = scene->part;
    out.known = out.known_t0 = 0;
    if (part.touch == SEL_TOUCH_SELF) return out;  // where b begins depends on s
    const real middle = (real)0.5 * (start[0] + start[3]);
    const CurvePiece a = curve_piece(scene->a, of_a), b = curve_piece(scene->b, middle);
    const CurvePiece a_t0 = curve_piece(scene->a_t0, spline_at_near(scene->a_t0, (real)0.5 * (s[0] + s[3]), scene->edge));
    const CurvePiece b_t0 = curve_piece(scene->b_t0, middle);
    // s = s_0 + s_1 u + s_2 u^2
    const real8 ahead = numbers8(s, s) - halves8(a.s0, a_t0.s0), s1 = halves8(a.s1, a_t0.s1), s2 = halves8(a.s2, a_t0.s2);
    const real8 zero = real8_of(0), square = s1 * s1 + 4 * s2 * ahead;
    const real8 u = 2 * ahead / (s1 + sqrt8(square < zero ? zero : square));
    const Lanes3 x = on_pieces(&a, &a_t0, u), r = sub_lanes(x, halves3(b.c0, b_t0.c0));
    const Lanes3 c1 = halves3(b.c1, b_t0.c1), c2 = halves3(b.c2, b_t0.c2);
    const real8 c1_c1 = dot_lanes(c1, c1), c1_c2 = dot_lanes(c1, c2), c2_c2 = dot_lanes(c2, c2);
    const real8 first = -dot_lanes(r, c1), linear = c1_c1 - 2 * dot_lanes(r, c2);
    real8 t = numbers8(start, start) - halves8(b.origin, b_t0.origin), moved = real8_of(1), curved = c1_c1;
    for (int k = 0; k < SEL_LANE_STEPS && any8(size8(moved) > real8_of(SEL_CLOSEST_NEAR)); ++k) {
        const real8 bulge = c1_c2 + c2_c2 * t;
        const real8 slope = first + (linear + (bulge + 2 * c1_c2 + c2_c2 * t) * t) * t;
        curved = linear + 6 * bulge * t;
        moved = -slope / curved;
        t = t + moved;
    }
    const real8 low = halves8(part.low - b.origin, part.low - b_t0.origin);
    const real8 high = halves8(part.high - b.origin, min_r(part.high, (real)(scene->b_t0.count - 1)) - b_t0.origin);
    const mask8 found = (size8(moved) <= real8_of(SEL_CLOSEST_NEAR)) & (curved > (real)0.05 * c1_c1) & (t > low) & (t < high);
    const mask8 missed = ~found | off_pieces(&b, &b_t0, t, 0) | off_pieces(&a, &a_t0, u, (real)1e-9);
    const Lanes3 away = sub_lanes(r, scale_lanes(t, add_lanes(c1, scale_lanes(t, c2))));
    const real8 distance = sqrt8(dot_lanes(away, away)), reach = real8_of(part.reach_a), other = real8_of(part.reach_b);
    real flags[8];
    put8(missed ? real8_of(1) : zero, flags);
    put8(u + halves8(a.origin, a_t0.origin), out.of_a);
    put8(t + halves8(b.origin, b_t0.origin), out.at);
    put8(part.touch == SEL_TOUCH_INSIDE ? other - reach - distance : distance - reach - other, out.gap);
    out.known = all_known(flags);
    out.known_t0 = all_known(flags + 4);
    return out;
}

SEL_END
#endif
