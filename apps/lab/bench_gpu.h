#pragma once
// `seldinger bench --gpu`: what the owner of a graphics card sends back, as one file.

#include <functional>
#include <string>
#include <vector>

namespace seldinger::apps {

struct GpuBench {
    int device = -1;
    std::vector<int> wires;  // in one world
    long steps = 0;
};

/// Runs each number of wires on the device in every precision that it has, and on the default CPU device for comparison. @return
/// one JSON object @param show  takes the name of each measurement   @param stop  throws when the user wants it to end
[[nodiscard]] std::string measure_gpu(const GpuBench& how, const std::function<void(const std::string&)>& show,
                                      const std::function<bool()>& stop);
/// The same as a table. @param json  of measure_gpu
[[nodiscard]] std::string gpu_summary(const std::string& json);

}  // namespace seldinger::apps
