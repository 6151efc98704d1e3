// Normal laws with little or no overlap, unlike the wall's own law. All are per metre of wire, of depth = -gap.
//
// Multipliers (augmented, constraint, impulse):
//     f = max(0, lambda + k depth)                                                                                        (D8)
// with lambda fixed while Newton solves; between two solves lambda <- f, until no lambda changes by more than k times the length
// allowed (method of multipliers [Hestenes69; Powell69; Alart91; Simo92]). Once lambda has settled, either f > 0 and |depth| is
// within that length, or f = 0 and the gap is open: complementarity. k sets the speed of convergence, not the result:
//     k >= the wall's own tangent stiffness at a depth of 0.01 radii,
//     k >= 10 rho A / h^2: in a step h the inertia of a free wire is stiffer than the wall. An overlap that is left to the next
//          step then shrinks by ten; with k h^2 / (rho A) < 1 a lambda carried from step to step would feed the bounce,
//     k >= 2 lambda / reach: the force has faded before the wall is out of sight.
// A contact point whose miss has not shrunk to 1/4 in a round gets four times its k. lambda starts at the force of the last step:
// it lives on the wire's material quadrature point. Neither lambda nor f exceeds f_most, the force of the wall's law at 0.95 of
// its pole, plus the wall's own stiffness times the depth, which keeps a wire in the middle. Without a solution free of overlap
// (a lumen narrower than the wire) the force stays bounded, and the overlap remains. The force of an impact does not start the
// next step. A miss of m leaves a free wire a speed of m / h, so misses are also limited to 1 mm/s times h. Otherwise the wire
// would bounce off a lambda that has outlived its impact.
//
// `constraint` adds the tangential multiplier of sticking friction, -(2/3) k times the slip of this step, returned to the cone:
// stuck is no slip at all, and no elastic slip is carried.
//
// `impulse` [Moreau88]: a contact point that overlaps at the start of the step leaves with -e times the speed at which it came,
//     0 <= f  _|_  v_n + e v_n(last step) >= 0,       v_n h = -(depth - depth_t0):
// the same multiplier law, of depth - goal. Overlap is what the first step in contact runs in; nothing takes it back.
#ifndef SEL_SHARED_MULTIPLIER_LAW_H
#define SEL_SHARED_MULTIPLIER_LAW_H
#include "shared/contact_types.h"
#include "shared/elementary.h"
#include "shared/normal_law.h"

SEL_BEGIN

#define SEL_TANGENTIAL ((real)0.6666666666666666)  // tangential over normal stiffness, as in (D9)

SEL_FN real multiplier_law(real depth, QuadratureModel m, MultiplierState multiplier, real* slope)
{
    const real force = multiplier.force + multiplier.stiffness * depth,
               most = m.multiplier_most + m.penalty_stiffness * max_r(depth, 0);
    if (force > most) {
        *slope = depth > 0 ? m.penalty_stiffness : 0;
        return most;
    }
    *slope = force > 0 ? multiplier.stiffness : 0;
    return force > 0 ? force : 0;
}

// Depth beyond which a contact point that was closed at the start of the step is pushed.
SEL_FN real impulse_goal(real depth_t0, real rate_t0, real inv_dt, QuadratureModel m)
{
    return depth_t0 - m.restitution * max_r(rate_t0, 0) / inv_dt;
}

// Depth at which the wall's own law, unhardened, carries `force` per metre: what the half-width of (D10) is reckoned from where
// the law in use does not sink in.
SEL_LAW_FN real depth_of_values(real force, real stiffness, real exponent)
{
    const real q = force / stiffness;
    if (exponent == (real)1.5) return cube_root(q * q);
    if (exponent == 1) return q;
    if (exponent == 2) return sqrt(q);
    return any_power(q, 1 / exponent);
}

SEL_FN real depth_carrying(real force, QuadratureModel m) { return depth_of_values(force, m.stiffness, m.exponent); }

SEL_END
#endif
