// The gap between a point of the axis of rod a and rod b, with its gradient and Hessian on the nodes of both (D13).
//
//   outside   gap = D - r_a - r_b,     D = min over b of |x_a - c(at)|
//   inside    gap = R - r_a - D,       R: lumen of b
//   mouth     gap = |x_a - y| - rho - r_a: the tip of b's wall is a half torus whose tube's radius rho is half of the wall's
//             thickness; y is the point of its circle (radius R + rho, in the plane rho from the tip) that is nearest. Where that
//             plane begins D = R + rho - |x_a - y|: the gap and its gradient are those of the lumen's cylinder.
//
// Gradient, by the envelope theorem with `at` held: d D = n . (dx_a - dc), n = (x_a - c)/D. With the tangent c' and D_u = -n . c'
// = 0
//
//   d2 D = delta P delta / D - (c' . delta / D + n . dc')^2 / D_uu,     delta = dx_a - dc,  P = 1 - n n^T,  D_uu = |c'|^2/D - n .
//   c''
//
// and without the last term at the ends of b. The plane of the mouth turns with the first edge and its tangent t. This changes
// the gap by -(z r/|x_a - y|) e . dt, with z the distance of x_a beyond the plane, r = R + rho, and e radial. The Hessian leaves
// out the second derivative of this term.
#ifndef SEL_SHARED_INSTRUMENT_GAP_H
#define SEL_SHARED_INSTRUMENT_GAP_H
#include "shared/instrument_types.h"
#include "shared/spline.h"

SEL_BEGIN

// What of b a point is held against.
typedef struct GapPart {
    uint touch;               // SEL_TOUCH_*
    real low, high;           // of b's curve; inside: low is the plane of the mouth
    real reach_a;             // radius of a [m]
    real reach_b;             // of b; inside: of its lumen [m]
    real rim;                 // inside: rho [m]
    int low_ends, high_ends;  // outside: whether b ends there, with a ball; else nothing touches beyond
} GapPart;

typedef struct InstrumentGap {
    real gap;  // [m]; SEL_FAR: nothing there
    real at;   // of b
    SplinePlace b;
    vec3 centre;  // c(at)
    vec3 n;       // d gap / d x_a
    vec3 turn;    // d gap / d c'
    real m[6];
    real bend;
    vec3 p, q;
} InstrumentGap;
#define SEL_FAR ((real)1e9)

// adds s v v^T, xx xy xz yy yz zz
SEL_FN void add_square(real* m, real s, vec3 v)
{
    m[0] += s * v.x * v.x;
    m[1] += s * v.x * v.y;
    m[2] += s * v.x * v.z;
    m[3] += s * v.y * v.y;
    m[4] += s * v.y * v.z;
    m[5] += s * v.z * v.z;
}

SEL_FN InstrumentGap no_gap(real at)
{
    InstrumentGap g;
    g.gap = SEL_FAR;
    g.at = at;
    g.b = straight_place(0, 0, 0);
    g.centre = g.n = g.turn = g.p = g.q = make_vec3(0, 0, 0);
    for (int k = 0; k < 6; ++k) g.m[k] = 0;
    g.bend = 0;
    return g;
}

// Beyond the plane of the mouth.
SEL_FN void set_mouth_gap(SplineView rod, vec3 x, GapPart part, InstrumentGap* g)
{
    const vec3 edge = spline_sum(rod, g->b.node, g->b.d);
    const real length = sqrt(dot3(edge, edge));
    const vec3 t = (1 / length) * edge, away = x - g->centre;
    const real z = -dot3(away, t);
    const vec3 radial = away + z * t;
    const real circle = part.reach_b + part.rim, out = sqrt(dot3(radial, radial));
    const vec3 e = (1 / max_r(out, (real)1e-30)) * radial;
    const real inward = circle - out, distance = sqrt(inward * inward + z * z);
    g->gap = distance - part.rim - part.reach_a;
    if (distance <= 0 || out <= 0) return;
    g->n = (-1 / distance) * (inward * e + z * t);
    g->turn = (-z * circle / (distance * length)) * e;
    add_square(g->m, 1 / distance, (1 / distance) * (z * e - inward * t));
    add_square(g->m, -inward / (distance * out), cross3(t, e));
}

// Gap at the nearest point of b. (Through a pointer: the struct is long, and copies of it took 10 % of an evaluation.)
SEL_FN void set_gap(SplineView rod, vec3 x, Closest near, GapPart part, InstrumentGap* g)
{
    *g = no_gap(near.at);
    const int inside = part.touch == SEL_TOUCH_INSIDE;
    if (inside ? near.bound > 0 : (near.bound < 0 && !part.low_ends) || (near.bound > 0 && !part.high_ends)) return;
    g->b = spline_place(near.at, rod.count);
    g->centre = spline_sum(rod, g->b.node, g->b.w);
    if (inside && near.bound < 0) {
        set_mouth_gap(rod, x, part, g);
        return;
    }
    const vec3 away = x - g->centre;
    const real distance = sqrt(dot3(away, away)), sign = inside ? (real)-1 : (real)1;
    g->gap = inside ? part.reach_b - part.reach_a - distance : distance - part.reach_a - part.reach_b;
    if (distance <= 0) return;
    const vec3 n = (1 / distance) * away;
    g->n = sign * n;
    g->m[0] = g->m[3] = g->m[5] = sign / distance;
    add_square(g->m, -sign / distance, n);
    if (near.bound != 0) return;
    const vec3 along = spline_sum(rod, g->b.node, g->b.d);
    const real curved = dot3(along, along) / distance - dot3(n, spline_sum(rod, g->b.node, g->b.c));
    if (curved <= 0) return;
    g->bend = -sign / curved;
    g->p = (1 / distance) * along;
    g->q = n;
}

SEL_FN InstrumentGap instrument_gap(SplineView rod, vec3 x, real start, GapPart part)
{
    InstrumentGap g;
    set_gap(rod, x, closest_on(rod, x, start, part.low, part.high), part, &g);
    return g;
}

SEL_END
#endif
