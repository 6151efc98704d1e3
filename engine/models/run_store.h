#pragma once
// Stored results of run_model(), in a folder under the words of scene and model, so that an interrupted study continues and no run
// is done twice.
//
//   runs.csv               one row per finished run, appended as it finishes
//   <scene>/*.trajectory   its observables

#include "models/result_table.h"
#include "models/run_model.h"

#include <filesystem>
#include <optional>
#include <string>

namespace seldinger {

/// A run as the table keeps it.
struct RunRecord {
    Cost cost;
    Outcome outcome = Outcome::Hold;
    bool complete = false, over_limit = false;
    double failed_at = 0, simulated = 0;  // [s]
    double wall_limit = 0;                // under which it was run [s]
    int nodes = 0, contacts = 0;
    double wall_move = 0;  // [m]
    long wall_far_steps = 0;
    FailureReadings readings;          // steps, jitter, overlap, outside, iterations are kept
    std::filesystem::path trajectory;  // where its observables are
};

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
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    /// Runs that get() had to do.
    [[nodiscard]] int fresh() const { return fresh_; }

private:
    std::filesystem::path folder_;
    ResultTable table_;
    int fresh_ = 0;
};

/// 16 hex digits that differ when scene, sampled times or program version do.
[[nodiscard]] std::string scene_key(const Scene& scene, const RunPlan& plan);

}  // namespace seldinger
