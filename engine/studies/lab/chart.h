#pragma once
// Speed against accuracy: the same scenes under every model, with cost and error of each.

#include "lab/benchmarks.h"
#include "lab/chart_models.h"
#include "models/run_store.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace seldinger {

struct ChartOptions {
    std::filesystem::path dir;            // results; a chart that was interrupted there is gone on with
    std::filesystem::path scenes_folder;  // of the built-in scenes
    std::vector<std::string> scenes;      // names or files; empty: all that are built in
    bool quick = false;
    bool processor_time = false;  // cost is processor time of all threads: for a machine that does other things too
    std::filesystem::path
        planned;  // a scene file that `plan` wrote for the one scene charted: its model joins the others. Empty: none
    double run_limit = 0, reference_limit = 0;  // a run, a reference may take so long [s]; 0: as `quick` has it
    int device = -1;
    std::vector<Baseline> baselines;
    std::function<bool()> stop;                        // asked between samples; may be empty
    std::function<void(const std::string&)> progress;  // what is being done; may be empty
};

struct ChartPoint {
    ChartModel model;
    std::string settings;  // texts of --set; of a baseline none
    RunRecord run;
    Errors errors;                                  // against the reference
    std::array<bool, observable_count> resolved{};  // the error is at least ten times the reference's uncertainty
    std::array<bool, observable_count> front{};     // nothing cheaper is as accurate

    /// Complete, and the wire stayed in one piece and inside: the model may stand on the front, unless its error exceeds
    /// SceneChart::scale, that of no answer at all.
    [[nodiscard]] bool sound() const;
    /// Median seconds per simulated second, wall or processor time.
    [[nodiscard]] double cost(bool processor_time) const { return processor_time ? run.cost.cpu : run.cost.wall; }
};

struct SceneChart {
    Benchmark benchmark;
    std::string title;
    Reference reference;
    PerObservable scale{};           // rms of the reference's own forces over the window; of lengths, the wire's length [SI]
    std::vector<ChartPoint> points;  // that were run
    std::vector<ChartModel> refused;
    /// Whether there is something to compare with: a reference that converges, of something that is not zero throughout.
    [[nodiscard]] bool charts(Observable which) const { return reference.usable(which) && at(scale, which) > 0; }
    bool processor_time = false;  // what cost() is
    bool finished = false;        // every model run and the reference as good as it gets
};

struct ChartResult {
    std::vector<SceneChart> scenes;
    bool interrupted = false;
    int runs_done = 0, runs_wanted = 0;  // models, all scenes
};

/// Runs models that are not in options.dir yet and compares. Writes chart.csv and references.csv there after every scene.
/// @throws Error BadScene, BadFile
[[nodiscard]] ChartResult make_chart(const ChartOptions& options);

/// chart.csv: one row per scene and model; references.csv: one per scene and observable.
[[nodiscard]] std::string chart_csv(const ChartResult& result);
[[nodiscard]] std::string references_csv(const ChartResult& result);

/// The fronts and where the published method stands, for people.
[[nodiscard]] std::string chart_summary(const ChartResult& result);

/// How much dearer or less accurate a point is than the front. A ratio is NaN where the front has nothing to compare.
struct Standing {
    double cost_ratio = 0;   // its cost over that of the cheapest front point that is at least as accurate
    double error_ratio = 0;  // its error over that of the most accurate front point that is at least as cheap
};
[[nodiscard]] Standing standing(const SceneChart& chart, const ChartPoint& point, Observable which);

}  // namespace seldinger
