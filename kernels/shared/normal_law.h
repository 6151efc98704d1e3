// Normal law (D6b, D6c, D7) and its tangent.
//
// Normal: per metre  f = k depth^n (1 + (beta / v-) d(depth)/dt) h(depth), clamped at 0. The rate over the step is
// (depth - depth_t0) / dt, so f is a growing function of depth alone, and a step minimises a convex energy. The hardening
//     h = 1 / (1 - depth/depth_max)                              wall's own law: it stiffens from the surface on
//     h = 1                                                      to depth_exact: a law from the user holds exactly,
//       = 1 + depth_max/(depth_max - depth_exact) x^2/(1 - x),   x = (depth - depth_exact)/(depth_max - depth_exact), beyond
// makes the law a barrier: whatever pushes, there is an equilibrium short of depth_max. Both have the same pole,
// depth_max/(depth_max - depth) to first order; f and its slope are continuous. From 0.999 depth_max f continues as its tangent,
// so that a start in overlap can be solved; `BLOCKED` marks a trial that went beyond that and deeper than before. With moves
// shorter than the lumen's width no wall is ever passed.
#ifndef SEL_SHARED_NORMAL_LAW_H
#define SEL_SHARED_NORMAL_LAW_H
#include "shared/contact_types.h"
#include "shared/elementary.h"

SEL_BEGIN

// Normal law that acts before contact and permits no overlap.
//
// Barrier [Li20]: E = -kappa (d - dh)^2 ln(d / dh) for gaps d < dh, else 0: C2, infinite at d = 0. f = -dE/dd. Below 1e-12 dh, f
// continues as its tangent: f is 1e12 kappa dh there (millions of times the force of any wire), and dh / d would soon leave the
// range of a float.

#define SEL_BARRIER_END \
    ((real)1e-12)  // of dh: from here on the barrier is its own tangent; in float32 (1 / this)^2 kappa is still finite

// @param gap  [m]     dh  activation distance [m]     kappa  [N/m^2]     slope  -df/dgap
// A gap that is not positive has no force: such a trial is refused without evaluation.
SEL_FN real barrier_law(real gap, real dh, real kappa, real* slope)
{
    *slope = 0;
    if (gap >= dh || gap <= 0) return 0;
    const real at = max_r(gap, SEL_BARRIER_END * dh);
    const real rest = dh - at, ln = log_r(dh / at), ratio = rest / at;
    *slope = kappa * (2 * ln + (4 + ratio) * ratio);
    return kappa * rest * (2 * ln + ratio) + *slope * (at - gap);
}

#define SEL_HARDENING_END ((real)0.999)  // fraction of depth_max from which the law continues as its tangent
#define SEL_BLOCKED_AT ((real)0.9995)    // fraction of depth_max beyond which a deepening trial is refused

// How the longer ones of the laws' functions are had: instruments.cl, whose stages have many in line, calls them.
#ifndef SEL_LAW_FN
    #define SEL_LAW_FN SEL_FN
#endif

SEL_LAW_FN real any_power(real x, real exponent) { return pow(x, exponent); }

SEL_FN real depth_power(real depth, real exponent)
{
    if (exponent == (real)1.5) return depth * sqrt(depth);
    if (exponent == 1) return depth;
    if (exponent == (real)0.5) return sqrt(depth);
    if (exponent == 2) return depth * depth;
    return any_power(depth, exponent);
}

// h, and its growth h'/h.
SEL_FN real hardening(real depth, real limit, real exact, real* growth)
{
    *growth = 0;
    if (limit <= 0 || depth <= exact) return 1;
    if (exact <= 0) {
        const real h = 1 / (1 - depth / limit);
        *growth = h / limit;
        return h;
    }
    const real span = limit - exact, strength = limit / span;
    const real x = (depth - exact) / span, rest = 1 - x;
    const real h = 1 + strength * x * x / rest;
    *growth = strength * x * (2 - x) / (rest * rest * span * h);
    return h;
}

// @return the force, its slope, 0
SEL_LAW_FN vec3 elastic_of_values(real depth, real stiffness, real exponent, real limit, real exact)
{
    const real end = limit > 0 ? SEL_HARDENING_END * limit : depth;
    const real inside = depth < end ? depth : end;
    const real power = stiffness * depth_power(inside, exponent);
    real growth;
    const real force = power * hardening(inside, limit, exact, &growth);
    const real slope = force * (exponent / inside + growth);
    return make_vec3(force + slope * (depth - inside), slope, 0);
}

// Static normal law per metre and its derivative; depth > 0.
SEL_FN real elastic_normal(real depth, QuadratureModel m, real* slope)
{
    const vec3 law = elastic_of_values(depth, m.stiffness, m.exponent, m.depth_limit, m.depth_exact);
    *slope = law.y;
    return law.x;
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
