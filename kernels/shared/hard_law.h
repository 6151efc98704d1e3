// Normal laws that do not let the wire sink in as the wall's own law does. All are per metre of wire, of depth = -gap.
//
// Multipliers (augmented, constraint, impulse):
//     f = max(0, lambda + k depth)                                                                                        (D8)
// with lambda fixed while Newton solves; between two solves lambda <- f, until no lambda changes by more than k times the length
// allowed (method of multipliers [Hestenes69; Powell69; Alart91; Simo92]). Where lambda has settled, either f > 0 and |depth| is
// within that length, or f = 0 and the gap is open: complementarity. k sets how fast that comes about, not where:
//     k >= the wall's own tangent stiffness a hundredth of the radius deep,
//     k >= 10 rho A / h^2: in a step h the inertia of a free wire gives way less than the wall does. An overlap that is left to
//     the next
//          step then shrinks by ten; with k h^2 / (rho A) < 1 a lambda carried from step to step would feed the bounce,
//     k >= 2 lambda / reach: the force has faded before the wall is out of sight,
// and a touch whose miss has not shrunk to a quarter in a round gets four times its k. lambda starts at the force of the last
// step: it lives on the wire's material sample. Neither it nor f exceeds f_most, what the wall's law carries at 0.95 of its pole,
// but for the wall's own stiffness times the depth, which keeps a wire in the middle: where there is no solution without overlap
// (a lumen narrower than the wire) force stays bounded, and the overlap is what it is. The force of an impact is no force to
// start the next step with. A miss of m leaves a free wire a speed of m / h, so that misses are held to 1 mm/s times h as well,
// or the wire would bounce off a lambda that has outlived its impact.
//
// `constraint` adds the tangential multiplier of sticking friction, -(2/3) k times the slip of this step, returned to the cone:
// stuck is no slip at all, and no elastic slip is carried.
//
// `impulse` [Moreau88]: a touch that overlaps at the start of the step leaves with -e times the speed at which it came,
//     0 <= f  _|_  v_n + e v_n(last step) >= 0,       v_n h = -(depth - depth_t0):
// the same multiplier law, of depth - goal. Overlap is what the first step in contact runs in; nothing takes it back.
//
// Barrier [Li20]: E = -kappa (d - dh)^2 ln(d / dh) for gaps d < dh, else 0: C2, infinite at d = 0. f = -dE/dd. Below 1e-12 dh,
// where f is 1e12 kappa dh (millions of times what any wire can push with) and dh / d would soon leave the range of a float, f
// goes on as its tangent.
#ifndef SEL_SHARED_HARD_LAW_H
#define SEL_SHARED_HARD_LAW_H
#include "shared/contact_types.h"
#include "shared/elementary.h"

SEL_BEGIN

#define SEL_BARRIER_END \
    ((real)1e-12)  // of dh: from here on the barrier is its own tangent; in float32 (1 / this)^2 kappa is still finite
#define SEL_TANGENTIAL ((real)0.6666666666666666)  // tangential over normal stiffness, as in (D9)

SEL_FN real multiplier_law(real depth, SampleModel m, HardState hard, real* slope)
{
    const real force = hard.force + hard.stiffness * depth, most = m.hard_most + m.hard_stiffness * max_r(depth, 0);
    if (force > most) {
        *slope = depth > 0 ? m.hard_stiffness : 0;
        return most;
    }
    *slope = force > 0 ? hard.stiffness : 0;
    return force > 0 ? force : 0;
}

// Depth beyond which a touch that was closed at the start of the step is pushed.
SEL_FN real impulse_goal(real depth_t0, real rate_t0, real inv_dt, SampleModel m)
{
    return depth_t0 - m.restitution * max_r(rate_t0, 0) / inv_dt;
}

// @param gap  [m]     dh  activation distance [m]     kappa  [N/m^2]     slope  -df/dgap
// A gap that is not positive has no force: such a trial is refused before it is looked at.
SEL_FN real barrier_law(real gap, real dh, real kappa, real* slope)
{
    *slope = 0;
    if (gap >= dh || gap <= 0) return 0;
    const real at = max_r(gap, SEL_BARRIER_END * dh);
    const real rest = dh - at, ln = log_r(dh / at), ratio = rest / at;
    *slope = kappa * (2 * ln + (4 + ratio) * ratio);
    return kappa * rest * (2 * ln + ratio) + *slope * (at - gap);
}

// Depth at which the wall's own law, unhardened, carries `force` per metre: what the half-width of (D10) is reckoned from where
// the law in use does not sink in.
SEL_FN real depth_carrying(real force, SampleModel m)
{
    const real q = force / m.stiffness;
    if (m.exponent == (real)1.5) return cube_root(q * q);
    if (m.exponent == 1) return q;
    if (m.exponent == 2) return sqrt(q);
    return pow(q, 1 / m.exponent);
}

SEL_END
#endif
