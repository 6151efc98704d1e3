#pragma once
// Text of every kernel file, embedded at build time by cmake/EmbedKernels.cmake.

#include <string_view>
#include <vector>

namespace seldinger::device {

struct KernelSource {
    std::string_view name, text;
};

/// The engine's own. Names are relative to kernels/.
[[nodiscard]] const std::vector<KernelSource>& embedded_kernels();

/// Kernel files of a program that uses the engine's device layer for its own kernels, found after the engine's. They may
/// include the engine's. Call before the first of them is built; calling again with the same list does nothing.
/// @param sources  must outlive every Context
void add_kernel_sources(const std::vector<KernelSource>& sources);

}  // namespace seldinger::device
