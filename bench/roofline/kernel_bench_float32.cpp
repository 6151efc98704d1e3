// The kernels built with SEL_FLOAT32: the shared headers once more, in another namespace.
#include "roofline/kernel_bench.h"
#include "roofline/peaks.h"

#define SEL_FLOAT32
#define seldinger seldinger_float32
#include "roofline/kernel_bench_time.h"

std::vector<KernelTiming> sel_bench::time_kernels_float32(Context& context, const BenchWall& wall,
                                                          const std::vector<KernelWork>& work, const KernelBenchOptions& options)
{
    return time_all(context, wall, work, options);
}
