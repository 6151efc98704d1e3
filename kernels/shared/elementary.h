// Elementary functions made of correctly rounded operations only, so that kernels and host agree to the bit: OpenCL's own log and
// cbrt may be off by some ulp, each device in its own way.
#ifndef SEL_SHARED_ELEMENTARY_H
#define SEL_SHARED_ELEMENTARY_H
#include "shared/portable.h"

SEL_BEGIN

// ln x for finite x >= 1, to 2 ulp: factors of two are taken out exactly, then 2 atanh((x - 1)/(x + 1)) of x in (0.707, 1.415].
SEL_FN real log_r(real x)
{
    real twos = 0;
    for (int k = 0; k < 1100 && x > (real)1.4142135623730951; ++k) {
        x *= (real)0.5;
        twos += 1;
    }
    const real z = (x - 1) / (x + 1), z2 = z * z;  // |z| <= 0.172: the term after the last is below 1e-17
    real sum = (real)1 / 21;
    for (int k = 19; k > 0; k -= 2) sum = sum * z2 + (real)1 / (real)k;
    return twos * (real)0.69314718055994531 + 2 * z * sum;
}

// x^(1/3) for x >= 0: y = (x y)^(1/4) quarters the error of ln y, Newton's method finishes.
SEL_FN real cube_root(real x)
{
    if (!(x > 0)) return 0;
    real y = 1;
    for (int k = 0; k < 12; ++k) y = sqrt(sqrt(x * y));
    for (int k = 0; k < 2; ++k) y -= (y - x / (y * y)) / 3;
    return y;
}

SEL_END
#endif
