#pragma once
// Trial runs of a plan: one model run over the scene's whole path and compared with the reference as it goes.

#include "models/refinement.h"

#include <functional>
#include <limits>
#include <map>

namespace seldinger {

struct PlanGoals {
    double tolerance = 0;           // of the shape, rms [m]
    double force_tolerance = 0;     // of the hand force, rms; 0: not asked
    bool force_is_relative = true;  // of the rms hand force; else [N]
    PeakGoal peaks;                 // of the largest forces
    double rate = 0;                // steps per second of real time, at least; 0: not asked
};

struct TrialRun {
    Model model;
    bool complete = false;  // false: broke off, or was plainly too wrong
    bool sound = false;     // complete, and the wire stayed in one piece and inside
    bool too_dear = false;  // broken off because it took many times as long as one that meets the goals, or the budget ended
    bool meets = false;     // sound, and within the goals by more than the reference's uncertainty
    double error = 0, worst = 0;  // shape [m]; of a trial that was broken off a lower bound
    double tip_error = 0;         // [m]
    double force_error = 0;       // [N]
    Peaks peak_error{};           // of a complete trial, where peaks were asked for
    double seconds = 0;           // of computation per simulated second (static: per solution)
    double slowest = 0;           // the same over the slowest of the sampled intervals; 0: not timed
    int nodes = 0;
    Outcome outcome = Outcome::Hold;
    double jitter = 0;
};

/// Seconds of a run, with the least influence of other work on the machine. On processor devices it is the smaller of wall and
/// processor time (waiting for others does not count, nor do threads that helped), on others wall time.
class CostRule {
public:
    explicit CostRule(int device_index);
    [[nodiscard]] double seconds(double wall, double cpu) const { return on_processor_ ? std::min(wall, cpu) : wall; }

private:
    bool on_processor_ = true;
};

/// Where a search gets its trials from.
class TrialRunSource {
public:
    virtual ~TrialRunSource() = default;
    /// Runs the model unless it has been run, here or in an earlier call. Null when it was told to stop. Valid as long as the
    /// source.
    [[nodiscard]] virtual const TrialRun* look_at(const Model& model) = 0;
    [[nodiscard]] virtual double limit() const = 0;  // what a trial's error may be [m]
};

class TrialRuns final : public TrialRunSource {
public:
    /// @param plan  samples and stop, as the reference was run
    /// @param seconds_left  of the budget: a trial that takes longer is broken off [s]
    TrialRuns(const StudyScene& scene, const RunPlan& plan, const Reference& reference, const PlanGoals& goals,
              const CostRule& cost, RunStore& store, std::function<double()> seconds_left);

    [[nodiscard]] const TrialRun* look_at(const Model& model) override;
    /// The same, run to its end however wrong it is: what a choice costs can only be told then.
    [[nodiscard]] const TrialRun* measure(const Model& model);
    /// Times a complete trial again, median of so many runs; replaces its `seconds`. @return slowest sampled interval [s/s]; 0
    /// when stopped
    double time_again(const Model& model, int repeats);

    [[nodiscard]] const std::map<std::string, TrialRun>& all() const { return known_; }
    [[nodiscard]] double limit() const override { return shape_limit_; }
    [[nodiscard]] bool stopped() const { return stopped_; }

private:
    [[nodiscard]] RunPlan watched(double& shape_sum, double& force_sum, double& slowest) const;
    [[nodiscard]] const TrialRun* run(const Model& model, const RunPlan& plan, const std::string& name);
    [[nodiscard]] TrialRun judge(const Model& model, const RunRecord& run, const Trajectory& values) const;

    const StudyScene& scene_;
    RunPlan plan_;
    const Reference& reference_;
    const CostRule& cost_;
    RunStore& store_;
    std::string name_;
    double shape_limit_ = 0, force_limit_ = 0;
    PeakGoal peak_goal_;
    double longest_step_;  // that keeps the rate [s]
    std::function<double()> seconds_left_;
    double shortest_ = std::numeric_limits<double>::infinity();  // wall time of the quickest trial that met the goals [s]
    std::map<std::string, TrialRun> known_;
    bool stopped_ = false;
};

}  // namespace seldinger
