#pragma once
// The scenes of the chart: length of each run, the part that counts, and its reference.

#include "models/refinement.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger {

struct Benchmark {
    std::string name;  // as in --scenes
    std::filesystem::path file;
    double until = 0, interval = 0;  // see RunPlan [s]
    Window window;                   // samples that count
    std::vector<Observable> charted;
    Refinement refinement;
    /// Exact shape at every time that counts; empty when there is none.
    std::function<std::vector<Vec3>(const Scene&)> analytic;
};

/// Names of the built-in benchmarks, in the order in which they are charted.
[[nodiscard]] std::vector<std::string> benchmark_names();

/// @param name_or_file  a built-in name, or the path of a scene file (*.toml), whose benchmark follows from the scene alone
/// @param scenes  folder of the built-in scenes, assets/scenes
/// @param quick  shorter, and with a smaller budget for the reference
/// @throws Error BadScene: unknown name (the nearest is named)
[[nodiscard]] Benchmark find_benchmark(const std::string& name_or_file, const std::filesystem::path& scenes, bool quick);

/// Completes what a scene file of the user's leaves open, from the scene: duration, samples, observables, reference.
void complete(Benchmark& benchmark, const Scene& scene);

/// The reference that the benchmark's analytic solution makes, at the times of the plan.
[[nodiscard]] Reference analytic_reference(const Benchmark& benchmark, const Scene& scene);

}  // namespace seldinger
