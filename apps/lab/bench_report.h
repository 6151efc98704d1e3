#pragma once
// Results of `seldinger bench` as tables: CSV files, one JSON object, text.

#include "roofline/kernel_bench.h"
#include "roofline/peaks.h"
#include "lab/scene_bench.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

inline constexpr const char* bench_files[] = {"device.csv", "kernels.csv", "scenes.csv"};

struct BenchResults {
    DeviceInfo device;
    std::string chosen;
    std::vector<device::Peaks> peaks;  // one per lane
    std::vector<kernel_bench::KernelTiming> kernels;
    std::vector<SceneTiming> scenes;
    struct Skipped {
        std::string scene, reason;
    };
    std::vector<Skipped> skipped;
};

/// Rate over what the roofline allows at this intensity: min(peak multiply-adds of the precision, cached bandwidth x flop/byte).
[[nodiscard]] double share_of_peak(const kernel_bench::KernelTiming& timing, const std::vector<device::Peaks>& peaks);

/// The three tables. @throws Error BadFile
void write_bench(const BenchResults& results, const std::filesystem::path& dir);
[[nodiscard]] std::string bench_json(const BenchResults& results);
[[nodiscard]] std::string bench_summary(const BenchResults& results);

}  // namespace seldinger::apps
