// Distance of two segments.
#ifndef SEL_SHARED_SEGMENT_H
#define SEL_SHARED_SEGMENT_H
#include "shared/portable.h"

SEL_BEGIN

// Squared distance of two segments p + s u and q + t v, s and t in [0, 1] [Ericson05, sec. 5.1.9].
SEL_FN real segments_distance2(vec3 p, vec3 u, vec3 q, vec3 v)
{
    const vec3 r = p - q;
    const real a = dot3(u, u), e = dot3(v, v), f = dot3(v, r);
    real s = 0, t = 0;
    if (e > 0) {
        const real c = dot3(u, r), b = dot3(u, v), det = a * e - b * b;
        if (a > 0) {
            s = det > 0 ? clamp_r((b * f - c * e) / det, 0, 1) : (real)0;
            t = b * s + f;
            if (t < 0) {
                t = 0;
                s = clamp_r(-c / a, 0, 1);
            } else if (t > e) {
                t = 1;
                s = clamp_r((b - c) / a, 0, 1);
            } else t = t / e;
        } else {
            t = clamp_r(f / e, 0, 1);
        }
    } else if (a > 0) {
        s = clamp_r(-dot3(u, r) / a, 0, 1);
    }
    const vec3 d = r + s * u - t * v;
    return dot3(d, d);
}

SEL_END
#endif
