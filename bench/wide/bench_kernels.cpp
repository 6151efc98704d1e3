// Hands the embedded kernels of bench/ to the device layer.

#include "wide/bench_kernels.h"

#include "device/kernel_sources.h"

namespace seldinger {

namespace device {
const std::vector<KernelSource>& bench_kernels();  // generated, cmake/EmbedKernels.cmake
}

void add_bench_kernels() { device::add_kernel_sources(device::bench_kernels()); }

}  // namespace seldinger
