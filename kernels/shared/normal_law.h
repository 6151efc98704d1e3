// Normal law (D6b, D6c, D7) and its tangent.
//
// Normal: per metre  f = k depth^n (1 + (beta / v-) d(depth)/dt) h(depth), clamped at 0. The rate over the step is
// (depth - depth_t0) / dt, so f is a growing function of depth alone, and a step minimises a convex energy. The hardening
//     h = 1 / (1 - depth/depth_max)                              wall's own law: it stiffens from the surface on
//     h = 1                                                      to depth_exact: a law from the user holds exactly,
//       = 1 + depth_max/(depth_max - depth_exact) x^2/(1 - x),   x = (depth - depth_exact)/(depth_max - depth_exact), beyond
// makes the law a barrier: whatever pushes, there is an equilibrium short of depth_max. Both have the same pole,
// depth_max/(depth_max - depth) to first order; f and its slope are continuous. From 0.999 depth_max f continues as its tangent, so
// that a start in overlap can be solved; `BLOCKED` marks a trial that went beyond that and deeper than before. With moves
// shorter than the lumen's width no wall is ever passed.
#ifndef SEL_SHARED_NORMAL_LAW_H
#define SEL_SHARED_NORMAL_LAW_H
#include "shared/contact_types.h"

SEL_BEGIN

#define SEL_HARDENING_END ((real)0.999)  // fraction of depth_max from which the law continues as its tangent
#define SEL_BLOCKED_AT ((real)0.9995)    // fraction of depth_max beyond which a deepening trial is refused

SEL_FN real depth_power(real depth, real exponent)
{
    if (exponent == (real)1.5) return depth * sqrt(depth);
    if (exponent == 1) return depth;
    if (exponent == (real)0.5) return sqrt(depth);
    if (exponent == 2) return depth * depth;
    return pow(depth, exponent);
}

// h, and its growth h'/h.
SEL_FN real hardening(real depth, QuadratureModel m, real* growth)
{
    *growth = 0;
    if (m.depth_limit <= 0 || depth <= m.depth_exact) return 1;
    if (m.depth_exact <= 0) {
        const real h = 1 / (1 - depth / m.depth_limit);
        *growth = h / m.depth_limit;
        return h;
    }
    const real span = m.depth_limit - m.depth_exact, strength = m.depth_limit / span;
    const real x = (depth - m.depth_exact) / span, rest = 1 - x;
    const real h = 1 + strength * x * x / rest;
    *growth = strength * x * (2 - x) / (rest * rest * span * h);
    return h;
}

// Static normal law per metre and its derivative; depth > 0.
SEL_FN real elastic_normal(real depth, QuadratureModel m, real* slope)
{
    const real end = m.depth_limit > 0 ? SEL_HARDENING_END * m.depth_limit : depth;
    const real inside = depth < end ? depth : end;
    const real power = m.stiffness * depth_power(inside, m.exponent);
    real growth;
    const real force = power * hardening(inside, m, &growth);
    *slope = force * (m.exponent / inside + growth);
    return force + *slope * (depth - inside);
}

// Damped law per metre. rate = (depth - depth_t0) inv_dt.
SEL_FN real normal_law(real depth, real rate, real approach, real inv_dt, QuadratureModel m, real* slope)
{
    real k;
    const real f = elastic_normal(depth, m, &k);
    const real c = m.damping / approach;
    const real damp = 1 + c * rate;
    if (inv_dt == 0 || m.damping == 0) {
        *slope = k;
        return f;
    }
    if (damp <= 0) {
        *slope = 0;
        return 0;
    }
    *slope = k * damp + f * c * inv_dt;
    return f * damp;
}

SEL_END
#endif
