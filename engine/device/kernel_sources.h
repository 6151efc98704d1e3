#pragma once
// Text of every kernel file, embedded at build time by cmake/EmbedKernels.cmake. Names are relative to kernels/.

#include <string>
#include <vector>

namespace seldinger::device {

struct KernelSource {
    std::string name, text;
};

[[nodiscard]] const std::vector<KernelSource>& embedded_kernels();

}  // namespace seldinger::device
