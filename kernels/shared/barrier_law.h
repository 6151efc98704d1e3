// Normal law that acts before contact and permits no overlap.
//
// Barrier [Li20]: E = -kappa (d - dh)^2 ln(d / dh) for gaps d < dh, else 0: C2, infinite at d = 0. f = -dE/dd. Below 1e-12 dh, f
// continues as its tangent: f is 1e12 kappa dh there (millions of times the force of any wire), and dh / d would soon leave the
// range of a float.
#ifndef SEL_SHARED_BARRIER_LAW_H
#define SEL_SHARED_BARRIER_LAW_H
#include "shared/contact_types.h"
#include "shared/elementary.h"

SEL_BEGIN

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

SEL_END
#endif
