// What only the wide tree needs beside kernels/shared/lanes.h: eight floats, whole numbers and flags, and orders of eight. Not for
// SEL_LANES 1.
#ifndef SEL_WIDE_LANES_H
#define SEL_WIDE_LANES_H
#include "shared/lanes.h"

#ifdef __cplusplus
namespace seldinger {
using uchar = unsigned char;
typedef float float8 __attribute__((vector_size(32)));
typedef std::int32_t int8 __attribute__((vector_size(32)));  // of a comparison of float8 and uint8, too
typedef uint uint8 __attribute__((vector_size(32)));
template <class Vector, class Item>
SEL_LANES_FN Vector load_lanes(const Item* from)
{
    Vector v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
SEL_LANES_FN float8 load8(const float* from) { return load_lanes<float8>(from); }
SEL_LANES_FN uint8 load8(const uint* from) { return load_lanes<uint8>(from); }
SEL_LANES_FN float8 float8_of_bytes(const uchar* from)
{
    typedef uchar uchar8 __attribute__((vector_size(8)));
    return __builtin_convertvector(load_lanes<uchar8>(from), float8);
}
SEL_LANES_FN void store8(uint8 v, uint* to) { std::memcpy(to, &v, sizeof v); }
SEL_LANES_FN real8 widen8(float8 v) { return __builtin_convertvector(v, real8); }
SEL_LANES_FN int8 narrow_mask8(mask8 v) { return __builtin_convertvector(v, int8); }
SEL_LANES_FN mask8 wide_mask8(int8 v) { return __builtin_convertvector(v, mask8); }
SEL_LANES_FN float8 float8_of(float x) { return float8{} + x; }
SEL_LANES_FN uint8 uint8_of(uint x) { return uint8{} + x; }
SEL_LANES_FN uint8 bits8(float8 v) { return (uint8)v; }
SEL_LANES_FN uint8 mask_bits8(int8 v) { return (uint8)v; }
SEL_LANES_FN uint bits_of(float x)
{
    uint bits;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
}
SEL_LANES_FN float8 fabs8(float8 v)
{
    for (int k = 0; k < 8; ++k) v[k] = std::fabs(v[k]);
    return v;
}
    #define SEL_MASK8(a, b, c, d, e, f, g, h) (int8{-(a), -(b), -(c), -(d), -(e), -(f), -(g), -(h)})
    #define SEL_SHUFFLE8(v, a, b, c, d, e, f, g, h) __builtin_shufflevector(v, v, a, b, c, d, e, f, g, h)
    #define SEL_LANE0(v) ((v)[0])
}  // namespace seldinger
#else
    #ifdef SEL_FLOAT32
        #define widen8(v) (v)
        #define narrow_mask8(v) (v)
        #define wide_mask8(v) (v)
    #else
        #define widen8(v) convert_double8(v)
        #define narrow_mask8(v) convert_int8(v)
        #define wide_mask8(v) convert_long8(v)
    #endif
    #define load8(from) vload8(0, from)
    // as two words: PoCL loads bytes in four pieces
    #define float8_of_bytes(from) convert_float8(as_uchar8(vload2(0, (__global const uint*)(from))))
    #define store8(v, to) vstore8(v, 0, to)
    #define float8_of(x) ((float8)(x))
    #define uint8_of(x) ((uint8)(x))
    #define bits8(v) as_uint8(v)
    #define mask_bits8(v) as_uint8(v)
    #define bits_of(x) as_uint(x)
    #define fabs8(v) fabs(v)
    #define SEL_MASK8(a, b, c, d, e, f, g, h) ((int8)(-(a), -(b), -(c), -(d), -(e), -(f), -(g), -(h)))
    #define SEL_SHUFFLE8(v, a, b, c, d, e, f, g, h) ((v).s##a##b##c##d##e##f##g##h)
    #define SEL_LANE0(v) ((v).s0)
#endif

SEL_BEGIN

SEL_LANES_FN Lanes3 choose_lanes(mask8 m, Lanes3 a, Lanes3 b) { return make_lanes3(m ? a.x : b.x, m ? a.y : b.y, m ? a.z : b.z); }
SEL_LANES_FN Lanes3 cross_lanes(Lanes3 a, Lanes3 b)
{
    return make_lanes3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
SEL_LANES_FN real8 clamp01_lanes(real8 a)
{
    const real8 zero = real8_of(0), one = real8_of(1);
    return a < zero ? zero : (a > one ? one : a);
}

// Least of the eight.
SEL_LANES_FN real least_lane(real8 v)
{
    real8 w = SEL_SHUFFLE8(v, 4, 5, 6, 7, 0, 1, 2, 3);
    v = w < v ? w : v;
    w = SEL_SHUFFLE8(v, 2, 3, 0, 1, 6, 7, 4, 5);
    v = w < v ? w : v;
    w = SEL_SHUFFLE8(v, 1, 0, 3, 2, 5, 4, 7, 6);
    v = w < v ? w : v;
    return SEL_LANE0(v);
}

// How many lanes of a mask are set.
SEL_LANES_FN uint count_lanes(int8 mask)
{
    uint8 v = mask_bits8(mask);
    v = v + SEL_SHUFFLE8(v, 4, 5, 6, 7, 0, 1, 2, 3);
    v = v + SEL_SHUFFLE8(v, 2, 3, 0, 1, 6, 7, 4, 5);
    v = v + SEL_SHUFFLE8(v, 1, 0, 3, 2, 5, 4, 7, 6);
    return 0u - SEL_LANE0(v);
}

// The greatest first: Batcher's bitonic network [Batcher68, doi:10.1145/1468075.1468121], six compare-exchanges of all lanes.
#define SEL_EXCHANGE8(v, a, b, c, d, e, f, g, h, keep)           \
    {                                                            \
        const uint8 w = SEL_SHUFFLE8(v, a, b, c, d, e, f, g, h); \
        const uint8 least = v < w ? v : w, most = v < w ? w : v; \
        v = keep ? most : least;                                 \
    }
SEL_LANES_FN uint8 sort_lanes(uint8 v)
{
    const int8 k2 = SEL_MASK8(1, 0, 0, 1, 1, 0, 0, 1), k4a = SEL_MASK8(1, 1, 0, 0, 0, 0, 1, 1),
               k4b = SEL_MASK8(1, 0, 1, 0, 0, 1, 0, 1), k8a = SEL_MASK8(1, 1, 1, 1, 0, 0, 0, 0),
               k8b = SEL_MASK8(1, 1, 0, 0, 1, 1, 0, 0), k8c = SEL_MASK8(1, 0, 1, 0, 1, 0, 1, 0);
    SEL_EXCHANGE8(v, 1, 0, 3, 2, 5, 4, 7, 6, k2)
    SEL_EXCHANGE8(v, 2, 3, 0, 1, 6, 7, 4, 5, k4a)
    SEL_EXCHANGE8(v, 1, 0, 3, 2, 5, 4, 7, 6, k4b)
    SEL_EXCHANGE8(v, 4, 5, 6, 7, 0, 1, 2, 3, k8a)
    SEL_EXCHANGE8(v, 2, 3, 0, 1, 6, 7, 4, 5, k8b)
    SEL_EXCHANGE8(v, 1, 0, 3, 2, 5, 4, 7, 6, k8c)
    return v;
}

SEL_END
#endif
