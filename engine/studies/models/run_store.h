#pragma once
// Stored results of run_model(), in a folder under the words of scene and model, so that an interrupted study continues and no
// run is done twice.
//
//   runs.csv               one row per finished run, appended as it finishes
//   <scene>/*.trajectory   its observables

#include "models/result_table.h"
#include "models/run_model.h"

#include <filesystem>
#include <optional>
#include <string>

namespace seldinger {

class RunStore {
public:
    /// @throws Error BadFile
    explicit RunStore(std::filesystem::path folder);

    /// The run from the store, or run now and stored. A run that was cut off by a shorter limit than today's is run again.
    /// @param name  of the scene, for the table and the folder of its trajectories
    /// @param trajectory  out, may be null
    /// @return nothing when plan.stop ended it: such a run leaves no trace
    [[nodiscard]] std::optional<RunRecord> get(const std::string& name, const StudyScene& scene, const Model& model,
                                               const RunPlan& plan, const std::vector<Baseline>& baselines,
                                               Trajectory* trajectory = nullptr);

private:
    std::filesystem::path folder_;
    ResultTable table_;
};

/// 16 hex digits that differ when scene, sampled times or program version do.
[[nodiscard]] std::string scene_key(const Scene& scene, const RunPlan& plan);

}  // namespace seldinger
