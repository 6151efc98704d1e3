// The common part of OpenCL C 1.2 and C++20, so that one header serves kernels and their host references.
//
// `real` is the arithmetic of the kernels: double where the device has fp64 (default), float with SEL_FLOAT32.
// Gaps must be right to 0.01 um in vessels of 0.3 m. So wire points come as hi (float) + lo (real), and everything is computed
// relative to a float origin near the segment. A difference of two floats is rounded once, to 6e-8 of its (millimetre) size.
#ifndef SEL_SHARED_PORTABLE_H
#define SEL_SHARED_PORTABLE_H

#ifdef __cplusplus
    #include <cmath>
    #include <cstdint>
    #define SEL_FN inline
    #define SEL_CALL inline
    #define SEL_GLOBAL
    #define SEL_ROLLED
    #define SEL_BEGIN namespace seldinger {
    #define SEL_END }
namespace seldinger {
using uint = std::uint32_t;
using ulong = std::uint64_t;
    #if defined(SEL_REAL)
using real = SEL_REAL;  // a number that counts what is done with it: bench/roofline/kernel_bench_work.cpp
    #elif defined(SEL_FLOAT32)
using real = float;
    #else
using real = double;
    #endif
using std::ceil;
using std::fabs;
using std::floor;
using std::pow;
using std::sqrt;
struct vec3 {
    real x, y, z;
};
inline vec3 make_vec3(real x, real y, real z) { return {x, y, z}; }
inline vec3 operator+(vec3 a, vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline vec3 operator-(vec3 a, vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline vec3 operator-(vec3 a) { return {-a.x, -a.y, -a.z}; }
inline vec3 operator*(real s, vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
}  // namespace seldinger
#else
    #pragma OPENCL FP_CONTRACT OFF                               // default is ON; OFF lets host and device be compared
    #define SEL_FN static inline __attribute__((always_inline))  // calls copy their records: a fifth of an evaluation
    #define SEL_CALL static __attribute__((noinline))  // of what is long, and called from many places: code ten times as long
    #define SEL_GLOBAL __global
    #define SEL_ROLLED \
        _Pragma("unroll 1")  // before a loop of few rounds whose body is long: once in the program, not once a round
    #define SEL_BEGIN
    #define SEL_END
    #ifdef SEL_FLOAT32
typedef float real;
typedef float3 vec3;
        #define make_vec3(x, y, z) ((float3)((x), (y), (z)))
    #else
        #pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double real;
typedef double3 vec3;
        #define make_vec3(x, y, z) ((double3)((x), (y), (z)))
    #endif
#endif

SEL_BEGIN

// Where laws add up their records. On a CPU, where an item is a work-group, a kernel has them in private variables. On a graphics
// card they would take 150 registers, so they are added up in memory. A file of kernels may set it before this header.
#ifndef SEL_SUMS_IN_MEMORY
    #if defined(__cplusplus) || SEL_WORKGROUP == 1
        #define SEL_SUMS_IN_MEMORY 0
    #else
        #define SEL_SUMS_IN_MEMORY 1
    #endif
#endif
#if SEL_SUMS_IN_MEMORY
    #define SEL_OUT __global
    #define SEL_STAGE_CALL SEL_CALL  // what stages call, with values alone: an argument's address would be one in scratch memory
#else
    #define SEL_OUT
    #define SEL_STAGE_CALL SEL_FN
#endif

// own products rather than dot() and cross(): a device may fuse or reorder the built-in ones
SEL_FN real dot3(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SEL_FN vec3 cross3(vec3 a, vec3 b) { return make_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
// ternaries: fmin/fmax cost twice a select on PoCL because of their NaN rules
SEL_FN real min_r(real a, real b) { return a < b ? a : b; }
SEL_FN real max_r(real a, real b) { return a > b ? a : b; }
SEL_FN real clamp_r(real a, real lo, real hi) { return a < lo ? lo : (a > hi ? hi : a); }

// Macros, since `to` may be in any memory: to = v, to += v.
#define store_vec(to, v) set_vec(to, =, v)
#define add_vec(to, v) set_vec(to, +=, v)
#define set_vec(to, sets, v)      \
    do {                          \
        const vec3 vec_set = (v); \
        (to)[0] sets vec_set.x;   \
        (to)[1] sets vec_set.y;   \
        (to)[2] sets vec_set.z;   \
    } while (0)

SEL_END

// A part of what an item does. PoCL compiles a kernel three times (for launches of any size, of a known and of a small one), and
// what it calls once. In contact_evaluate it is the item as a whole: calls within it, which copy records, cost 5 to 9 % of the
// steps.
#if SEL_SUMS_IN_MEMORY
    #define SEL_PART SEL_FN
#else
    #define SEL_PART SEL_CALL
#endif
#endif
