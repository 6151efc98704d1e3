// What a device can do at most: the roofs that the other kernels are measured against.
//   launch  bench/roofline/peaks.cpp       test  tests/bench/test_peaks.cpp
#ifndef SEL_WORKGROUP
#define SEL_WORKGROUP 64  // default, so that the file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// Nothing: what a launch costs.
//   item    none is read      writes  nothing
SEL_KERNEL void peak_nothing(const uint item_count, __global float* restrict out)
{
    if (item_count == 0xffffffffu) out[get_global_id(0)] = 0;
}

// STREAM's triad. Arrays are whole work-groups long: without a bound to check the loop over a group is one vector loop.
//   item    one element      reads  b, c      writes  a
#define SEL_TRIAD(name, type)                                                                                                    \
SEL_KERNEL void name(__global type* restrict a, __global const type* restrict b, __global const type* restrict c, const float s) \
{                                                                                                                                \
    const uint i = get_global_id(0);                                                                                             \
    a[i] = b[i] + s * c[i];                                                                                                      \
}

// Fused multiply-adds in eight chains that do not wait for each other: 128 rounds of 8 a component.
//   item    its own chains      writes  out [items], so that nothing is left out
#define SEL_FMA(name, type)                                          \
SEL_KERNEL void name(__global type* restrict out, const float scale) \
{                                                                    \
    const uint i = get_global_id(0);                                 \
    const type m = (type)(scale), b = (type)(1 - scale);             \
    type x0 = (type)(i & 7u), x1 = x0 + b, x2 = x1 + b, x3 = x2 + b; \
    type x4 = x3 + b, x5 = x4 + b, x6 = x5 + b, x7 = x6 + b;         \
    for (uint k = 0; k < 128; ++k) {                                 \
        x0 = fma(x0, m, b), x1 = fma(x1, m, b), x2 = fma(x2, m, b);  \
        x3 = fma(x3, m, b), x4 = fma(x4, m, b), x5 = fma(x5, m, b);  \
        x6 = fma(x6, m, b), x7 = fma(x7, m, b);                      \
    }                                                                \
    out[i] = ((x0 + x1) + (x2 + x3)) + ((x4 + x5) + (x6 + x7));      \
}

SEL_TRIAD(peak_triad_float, float)
SEL_TRIAD(peak_triad_float4, float4)
SEL_TRIAD(peak_triad_float16, float16)
SEL_FMA(peak_fma_float, float)
SEL_FMA(peak_fma_float4, float4)
SEL_FMA(peak_fma_float8, float8)
SEL_FMA(peak_fma_float16, float16)
#ifndef SEL_FLOAT32
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
SEL_FMA(peak_fma_double, double)
SEL_FMA(peak_fma_double2, double2)
SEL_FMA(peak_fma_double4, double4)
SEL_FMA(peak_fma_double8, double8)
#endif
