// Runs a plan's trial runs against the reference as they go, stops those that cannot meet the goals, and times the others.
#include "plan/plan_trials.h"

#include "models/frechet.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// A trial stops early if its error so far would make it miss the tolerance by this factor even without further error. Above 1, so
// that the search can tell a near miss from a hopeless one.
constexpr double plainly_wrong = 2;
// Or when it takes this many times as long as the quickest that met the goals, and this long at least [s]. On a busy machine a
// trial looks several times slower than it is.
constexpr double plainly_dear = 8, least_patience = 1;
// The slowest of the sampled intervals over the mean of a run, where it was not timed.
constexpr double unknown_slowest = 3;

double square(double x) { return x * x; }

/// Slowest of the sampled intervals of a running trial, per simulated second.
class Slowest {
public:
    Slowest(const CostRule& cost, double interval, double& worst) : cost_(cost), interval_(interval), worst_(worst) {}
    void add(double wall, double cpu)
    {
        worst_ = std::max(worst_, cost_.seconds(wall - wall_, cpu - cpu_) / interval_);
        wall_ = wall;
        cpu_ = cpu;
    }

private:
    const CostRule& cost_;
    double interval_, wall_ = 0, cpu_ = 0;
    double& worst_;
};

}  // namespace

CostRule::CostRule(int device_index)
{
    const std::vector<DeviceInfo> devices = list_devices();
    if (device_index >= 0 && device_index < static_cast<int>(devices.size()))
        on_processor_ = devices[static_cast<std::size_t>(device_index)].type.find("CPU") != std::string::npos;
    else
        on_processor_ = std::any_of(devices.begin(), devices.end(),
                                    [](const DeviceInfo& d) { return d.type.find("CPU") != std::string::npos; });
}

TrialRuns::TrialRuns(const StudyScene& scene, const RunPlan& plan, const Reference& reference, const PlanGoals& goals,
                     const CostRule& cost, RunStore& store, std::function<double()> seconds_left)
    : scene_(scene),
      plan_(plan),
      reference_(reference),
      cost_(cost),
      store_(store),
      // trials that were broken off say nothing about another tolerance
      name_(fmt::format("pilots-{}-{}{}", goals.tolerance, goals.force_tolerance, goals.force_is_relative ? "" : "n") +
            (goals.peaks.asked() ? fmt::format("-{}{}", goals.peaks.tolerance, goals.peaks.is_relative ? "" : "n") : "")),
      peak_goal_(goals.peaks),
      longest_step_(goals.rate > 0 ? 1 / goals.rate : std::numeric_limits<double>::infinity()),
      seconds_left_(std::move(seconds_left))
{
    shape_limit_ = goals.tolerance - at(reference.uncertainty, Observable::Shape);
    force_limit_ = std::numeric_limits<double>::infinity();
    if (goals.force_tolerance > 0)
        force_limit_ = goals.force_tolerance * (goals.force_is_relative ? reference.force_scale : 1.0) -
                       at(reference.uncertainty, Observable::HandForce);
}

RunPlan TrialRuns::watched(double& shape_sum, double& force_sum, double& slowest) const
{
    RunPlan plan = plan_;
    const double n = static_cast<double>(reference_.values.samples.size());
    plan.after_sample = [this, n, &shape_sum, &force_sum, timer = Slowest(cost_, plan.interval, slowest),
                         k = std::size_t{0}](const Sample& sample, double wall, double cpu) mutable {
        timer.add(wall, cpu);
        if (k >= reference_.values.samples.size()) return true;
        const Sample& right = reference_.values.samples[k++];
        shape_sum += square(frechet_distance(sample.shape, right.shape, 1e-3));
        force_sum += square(sample.hand_force - right.hand_force);
        return shape_sum <= n * square(plainly_wrong * shape_limit_) && force_sum <= n * square(plainly_wrong * force_limit_);
    };
    return plan;
}

TrialRun TrialRuns::judge(const Model& model, const RunRecord& run, const Trajectory& values) const
{
    TrialRun trial{.model = model,
                   .complete = run.complete,
                   .too_dear = run.over_limit,
                   .seconds = cost_.seconds(run.cost.wall, run.cost.cpu),
                   .nodes = run.nodes,
                   .outcome = run.outcome,
                   .jitter = run.readings.jitter};
    const Errors errors = trajectory_errors(values, reference_.values);
    trial.error = at(errors.rms, Observable::Shape);
    trial.tip_error = at(errors.rms, Observable::Tip);
    trial.force_error = at(errors.rms, Observable::HandForce);
    trial.worst = at(errors.worst, Observable::Shape);
    if (!run.complete) {  // as if it were right from there on
        const double share =
            std::sqrt(static_cast<double>(errors.samples) / static_cast<double>(reference_.values.samples.size()));
        trial.error *= share;
        trial.force_error *= share;
        return trial;
    }
    // a hand that is asked to be right may not jitter, unless it does in the reference too
    const bool jitters = run.outcome == Outcome::Jitter && std::isfinite(force_limit_) && !reference_.jitters;
    trial.sound = (run.outcome == Outcome::Hold || run.outcome == Outcome::Jitter) && !jitters;
    trial.peak_error = difference(values.peaks, reference_.values.peaks);
    trial.meets = trial.sound && trial.error <= shape_limit_ && trial.force_error <= force_limit_ &&
                  peak_goal_.holds(trial.peak_error, reference_.peak_uncertainty, reference_.values.peaks);
    return trial;
}

const TrialRun* TrialRuns::look_at(const Model& model)
{
    const std::string key = label(model);
    if (const auto found = known_.find(key); found != known_.end()) return &found->second;
    double shape_sum = 0, force_sum = 0, slowest = 0;
    RunPlan plan = watched(shape_sum, force_sum, slowest);
    plan.wall_limit = std::min(std::max(least_patience, seconds_left_()), std::max(least_patience, plainly_dear * shortest_));
    const TrialRun* trial = run(model, plan, name_);
    if (!trial) return nullptr;
    // of a trial that an earlier call ran, the mean is known alone
    TrialRun& timed = known_.at(key);
    timed.slowest = slowest > 0 ? slowest : unknown_slowest * timed.seconds;
    return &timed;
}

const TrialRun* TrialRuns::measure(const Model& model)
{
    if (const auto found = known_.find(label(model)); found != known_.end() && found->second.complete) return &found->second;
    RunPlan plan = plan_;
    plan.wall_limit = std::max({least_patience, seconds_left_(), plainly_dear * shortest_});
    return run(model, plan, "whole");
}

const TrialRun* TrialRuns::run(const Model& model, const RunPlan& plan, const std::string& name)
{
    Trajectory values;
    const std::optional<RunRecord> run = store_.get(name, scene_, model, plan, {}, &values);
    if (!run) {
        stopped_ = true;
        return nullptr;
    }
    const TrialRun& trial = known_[label(model)] = judge(model, *run, values);
    // a trial whose steps are too long for the rate does not show which cost is too high
    if (trial.meets && model.dt.value_or(0) <= longest_step_ * (1 + 1e-9))
        shortest_ = std::min(shortest_, run->cost.wall * (run->simulated > 0 ? run->simulated : 1));
    return &trial;
}

double TrialRuns::time_again(const Model& model, int repeats)
{
    TrialRun& trial = known_.at(label(model));
    std::vector<double> seconds, slowest;
    for (int k = 0; k < repeats; ++k) {
        double worst = 0;
        RunPlan plan = plan_;
        plan.after_sample = [timer = Slowest(cost_, plan.interval, worst)](const Sample&, double wall, double cpu) mutable {
            timer.add(wall, cpu);
            return true;
        };
        const ModelRun run = run_model(scene_, model, plan);
        if (run.stopped) {
            stopped_ = true;
            return 0;
        }
        seconds.push_back(cost_.seconds(run.cost.wall, run.cost.cpu));
        slowest.push_back(worst);
    }
    std::sort(seconds.begin(), seconds.end());
    std::sort(slowest.begin(), slowest.end());
    trial.seconds = seconds[seconds.size() / 2];
    return slowest[slowest.size() / 2];
}

}  // namespace seldinger
