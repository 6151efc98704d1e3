// Eight numbers side by side, for loops that a device does not vectorise: OpenCL's vector types on one side, the compiler's on
// the other. The same operators do the same operations on both, and a comparison gives a mask for `m ? a : b`.
// Eight lanes suit processors of 256 and 512 bits. A graphics card has its lanes in its work-items: there SEL_LANES is 1, and
// what takes eight numbers takes them in a loop, with the same bits.
#ifndef SEL_SHARED_LANES_H
#define SEL_SHARED_LANES_H
#include "shared/portable.h"

#ifndef SEL_LANES
    #if defined(__cplusplus) || SEL_WORKGROUP == 1
        #define SEL_LANES 8
    #else
        #define SEL_LANES 1
    #endif
#endif

#ifdef __cplusplus
    #include <cstring>
    // always inlined: how a vector is handed over depends on the processor that a file is compiled for, which g++ warns of
    #define SEL_LANES_FN inline __attribute__((always_inline))
    #pragma GCC diagnostic ignored "-Wpsabi"
namespace seldinger {
typedef real real8 __attribute__((vector_size(8 * sizeof(real))));
using mask8 = decltype(real8{} < real8{});  // of a comparison
SEL_LANES_FN real8 real8_of(real x) { return real8{} + x; }
SEL_LANES_FN real8 halves8(real a, real b) { return real8{a, a, a, a, b, b, b, b}; }
SEL_LANES_FN real8 of8(real a, real b, real c, real d, real e, real f, real g, real h) { return real8{a, b, c, d, e, f, g, h}; }
SEL_LANES_FN real8 numbers8(const real* a, const real* b)
{
    return real8{a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]};
}
SEL_LANES_FN real8 lanes_at(const real* from)
{
    real8 v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
SEL_LANES_FN void put8(real8 v, real* to) { std::memcpy(to, &v, sizeof v); }
SEL_LANES_FN mask8 not8(mask8 v) { return ~v; }
SEL_LANES_FN real8 sqrt8(real8 v)
{
    for (int k = 0; k < 8; ++k) v[k] = std::sqrt(v[k]);
    return v;
}
SEL_LANES_FN real8 size8(real8 v)
{
    const real8 minus = -v;
    return v < minus ? minus : v;
}
SEL_LANES_FN bool any8(mask8 v)
{
    bool set = false;
    for (int k = 0; k < 8; ++k) set |= v[k] != 0;
    return set;
}
}  // namespace seldinger
#elif SEL_LANES == 1
    #define SEL_LANES_FN static inline
typedef real real8;
typedef int mask8;
    #define real8_of(x) ((real)(x))
    #define lanes_at(from) (*(from))
    #define put8(v, to) (*(to) = (v))
    #define sqrt8(v) sqrt(v)
    #define size8(v) fabs(v)
    #define any8(v) (v)
    #define not8(v) (!(v))
#else
    #define SEL_LANES_FN static inline
    #ifdef SEL_FLOAT32
typedef float8 real8;
typedef int8 mask8;
        #define real8_of(x) ((float8)(x))
    #else
typedef double8 real8;
typedef long8 mask8;
        #define real8_of(x) ((double8)(x))
    #endif
    #define halves8(a, b) ((real8)((a), (a), (a), (a), (b), (b), (b), (b)))
    #define of8(a, b, c, d, e, f, g, h) ((real8)((a), (b), (c), (d), (e), (f), (g), (h)))
    #define numbers8(a, b) ((real8)((a)[0], (a)[1], (a)[2], (a)[3], (b)[0], (b)[1], (b)[2], (b)[3]))
    #define lanes_at(from) vload8(0, from)
    #define put8(v, to) vstore8(v, 0, to)
    #define not8(v) (~(v))
    #define sqrt8(v) sqrt(v)
    #define size8(v) fabs(v)
    #define any8(v) any(v)
#endif

SEL_BEGIN

typedef struct Lanes3 {
    real8 x, y, z;
} Lanes3;

SEL_LANES_FN Lanes3 make_lanes3(real8 x, real8 y, real8 z)
{
    Lanes3 v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}
SEL_LANES_FN Lanes3 lanes3_of(vec3 v) { return make_lanes3(real8_of(v.x), real8_of(v.y), real8_of(v.z)); }
SEL_LANES_FN Lanes3 add_lanes(Lanes3 a, Lanes3 b) { return make_lanes3(a.x + b.x, a.y + b.y, a.z + b.z); }
SEL_LANES_FN Lanes3 sub_lanes(Lanes3 a, Lanes3 b) { return make_lanes3(a.x - b.x, a.y - b.y, a.z - b.z); }
SEL_LANES_FN Lanes3 scale_lanes(real8 s, Lanes3 a) { return make_lanes3(s * a.x, s * a.y, s * a.z); }
SEL_LANES_FN real8 dot_lanes(Lanes3 a, Lanes3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

SEL_END
#endif
