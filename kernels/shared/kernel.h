// How a kernel begins: items share groups of SEL_WORKGROUP.
#ifndef SEL_SHARED_KERNEL_H
#define SEL_SHARED_KERNEL_H
#ifndef SEL_WORKGROUP
    #define SEL_WORKGROUP 64  // default, so that a file compiles alone
#endif
#define SEL_KERNEL __kernel __attribute__((reqd_work_group_size(SEL_WORKGROUP, 1, 1)))

// A kernel that waits for memory more than it computes. On AMD's cards a SIMD is to hold that many groups at once: registers are
// spared for it, and a few bytes of loop invariants go to scratch (tests/device/kernel_shapes.csv).
#if defined(__AMDGCN__) && defined(SEL_FLOAT32)
    #define SEL_WALK_KERNEL __attribute__((amdgpu_waves_per_eu(4))) SEL_KERNEL
#elif defined(__gfx90a__) && \
    !defined(SEL_CALLS_FUNCTIONS)  // it has twice the registers: as many for an item, and twice the groups
    #define SEL_WALK_KERNEL __attribute__((amdgpu_waves_per_eu(4))) SEL_KERNEL
#elif defined(__AMDGCN__)
    #define SEL_WALK_KERNEL __attribute__((amdgpu_waves_per_eu(2))) SEL_KERNEL
#else
    #define SEL_WALK_KERNEL SEL_KERNEL
#endif

#endif
