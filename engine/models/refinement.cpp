// Refines a scene level by level until two movements bound the remaining error, or reports that they do not.
#include "models/refinement.h"

#include "models/wall_edges.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double least_ratio = 0.5, most_ratio = 0.8;
constexpr double coarsest_edge = 0.010;  // [m]
constexpr int fewest_in_reference = 17;
constexpr double coarsest_step = 1.0 / 60;  // [s]
constexpr int least_levels = 3, most_levels = 9;
constexpr int trapezoid_failures = 3;  // levels that break off before backward Euler is taken instead
constexpr double cost_growth = edge_refinement * step_refinement;
// what rounding and the solver's tolerance move [m], [N]
constexpr double shape_noise = 1e-8, force_noise = 1e-6;

Model level_model(const Scene& scene, const WallEdges& wall, const RunPlan& plan, int level, bool trapezoid)
{
    const bool is_static = scene.integrator.scheme == Scheme::Static;
    Model model;
    const double coarsest = std::max<double>(fewest_in_reference - 1, std::ceil(scene.wire.length / coarsest_edge));
    model.nodes = static_cast<int>(std::lround(coarsest * std::pow(edge_refinement, level))) + 1;
    model.scheme = is_static ? Scheme::Static : Scheme::Newton;
    model.tolerance = std::min(scene.integrator.tolerance, IntegratorSpec{}.tolerance);
    if (scene.vessel.shape != VesselShape::None) model.detection = Detection::Swept;
    if (wall.yields()) model.wall_edge = wall.of_level(level, edge_refinement);
    if (is_static) return model;
    model.trapezoid = trapezoid;
    // whole parts of the sampled interval, so that the run has the requested steps
    model.dt = plan.interval / std::ceil(plan.interval / coarsest_step * std::pow(step_refinement, level) - 1e-9);
    return model;
}

bool sound(const RunRecord& run)
{
    return run.complete && run.outcome != Outcome::Escape && run.outcome != Outcome::GaveUp && run.outcome != Outcome::BlowUp;
}

double rms_hand_force(const Trajectory& run)
{
    double sum = 0;
    for (const Sample& sample : run.samples) sum += sample.hand_force * sample.hand_force;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(run.samples.size(), 1)));
}

std::vector<double> column(const std::vector<PerObservable>& rows, Observable which)
{
    std::vector<double> values;
    for (const PerObservable& row : rows) values.push_back(at(row, which));
    return values;
}

/// Judges the present levels. @return whether it is good enough
bool judge(PlanReference& reference, const ReferenceGoals& goals)
{
    reference.force_scale = std::max(1e-3, rms_hand_force(reference.values));
    if (reference.moved.empty()) return false;
    const auto shape = column(reference.moved, Observable::Shape), force = column(reference.moved, Observable::HandForce);
    for (int k = 0; k < observable_count; ++k)
        reference.uncertainty[static_cast<std::size_t>(k)] = error_left(column(reference.moved, static_cast<Observable>(k)));
    const double force_goal = goals.force * (goals.force_is_relative ? reference.force_scale : 1.0);
    reference.peak_uncertainty = peaks_left(reference.peaks_moved);
    const bool judges_force = std::isfinite(goals.force);
    reference.converges = falls(shape, shape_noise) && (!judges_force || falls(force, force_noise));
    return static_cast<int>(reference.levels.size()) >= least_levels && reference.converges &&
           at(reference.uncertainty, Observable::Shape) <= std::max(goals.shape, shape_noise) &&
           (!judges_force || at(reference.uncertainty, Observable::HandForce) <= std::max(force_goal, force_noise)) &&
           goals.peaks.holds({}, reference.peak_uncertainty, reference.values.peaks);
}

/// Runs one level after another; what each says goes into the reference.
class Levels {
public:
    Levels(const StudyScene& scene, const RunPlan& plan, const ReferenceGoals& goals, RunStore& store, const std::string& name,
           const std::function<void(const std::string&)>& progress)
        : scene_(scene), plan_(plan), goals_(goals), store_(store), name_(name), progress_(progress), limited_(plan)
    {
    }

    PlanReference refine()
    {
        run_levels();
        if (reference_.converges && !reference_.stopped) bound_wall();
        return std::move(reference_);
    }

private:
    /// Ends when the reference is good enough, or nothing more can be run.
    void run_levels()
    {
        const Scene& scene = scene_.scene;
        // without contact the motion is smooth in time: second order, unless that breaks off. With contact the trapezoid rule rings
        bool trapezoid = !is_static() && scene.vessel.shape == VesselShape::None && !scene.integrator.conserve;
        int broken = 0;
        for (int level = 0; level < most_levels; ++level) {
            const Model model = level_model(scene, wall_, plan_, level, trapezoid);
            if (level > 0 && !goals_.affordable(cost_growth * last_seconds_)) {
                reference_.out_of_budget = true;
                return;
            }
            Trajectory values;
            const std::optional<RunRecord> run = get(model, values);
            if (!run) return;
            if (!sound(*run)) {
                // a coarse one may break where a finer one does not
                reference_.failures.push_back(
                    fmt::format("{}: {} after {:.3g} s", label(model),
                                run->outcome == Outcome::Hold ? "did not finish" : std::string(seldinger::name(run->outcome)),
                                run->simulated));
                reference_.levels.clear();
                reference_.moved.clear();
                reference_.peaks_moved.clear();
                if (trapezoid && ++broken == trapezoid_failures) trapezoid = false, level = -1;
                continue;
            }
            take_in(model, *run, std::move(values));
            if (judge(reference_, goals_)) return;
        }
    }

    /// Nothing when it was stopped, or took longer than there is time.
    std::optional<RunRecord> get(const Model& model, Trajectory& values)
    {
        if (progress_) progress_(fmt::format("reference: {}", label(model)));
        if (goals_.seconds_left) limited_.wall_limit = goals_.seconds_left();
        const std::optional<RunRecord> run = store_.get(name_, scene_, model, limited_, {}, &values);
        reference_.stopped = !run;
        if (!run) return {};
        reference_.out_of_budget = run->over_limit;
        if (run->over_limit) return {};
        last_seconds_ = run->cost.wall * std::max(run->simulated, is_static() ? 1.0 : 0.0);
        return run;
    }

    void take_in(const Model& model, const RunRecord& run, Trajectory values)
    {
        if (!reference_.levels.empty()) {
            reference_.moved.push_back(trajectory_errors(reference_.values, values).rms);
            reference_.peaks_moved.push_back(difference(reference_.values.peaks, values.peaks));
        }
        reference_.values = std::move(values);
        reference_.levels.push_back(model);
        reference_.model = model;
        reference_.jitters = run.outcome == Outcome::Jitter;
        reference_.contacts = std::max(reference_.contacts, run.contacts);
        reference_.wall_move = run.wall_move;
        reference_.wall_far = run.wall_far_steps > 0;
    }

    /// Movements do not tell what the control mesh is wrong by once it is refined no further.
    void bound_wall()
    {
        if (!wall_.yields() || reference_.levels.size() < 2) return;
        Model coarser = reference_.model;
        const double edge = *coarser.wall_edge, before = reference_.levels[reference_.levels.size() - 2].wall_edge.value_or(edge);
        constexpr double rounding = 1e-9;
        if (before >= edge_refinement * edge * (1 - rounding)) return;
        coarser.wall_edge = edge_refinement * edge;
        Trajectory values;
        const std::optional<RunRecord> run = get(coarser, values);
        if (!run || !sound(*run)) {
            reference_.converges = false;
            return;
        }
        const Errors moved = trajectory_errors(values, reference_.values);
        for (std::size_t k = 0; k < reference_.uncertainty.size(); ++k) reference_.uncertainty[k] += moved.rms[k];
        const Peaks peaks = difference(values.peaks, reference_.values.peaks);
        for (std::size_t k = 0; k < peaks.size(); ++k) reference_.peak_uncertainty[k] += peaks[k];
    }

    [[nodiscard]] bool is_static() const { return scene_.scene.integrator.scheme == Scheme::Static; }

    const StudyScene& scene_;
    const RunPlan& plan_;
    const ReferenceGoals& goals_;
    RunStore& store_;
    const std::string& name_;
    const std::function<void(const std::string&)>& progress_;
    RunPlan limited_;
    WallEdges wall_ = wall_edges(scene_.setup);
    double last_seconds_ = 0;
    PlanReference reference_;
};

}  // namespace

double error_left(const std::vector<double>& moved)
{
    if (moved.empty()) return std::numeric_limits<double>::infinity();
    const double last = moved.back();
    if (last == 0) return 0;
    double ratio = most_ratio;
    if (moved.size() > 1 && moved[moved.size() - 2] > 0)
        ratio = std::clamp(last / moved[moved.size() - 2], least_ratio, most_ratio);
    return last * ratio / (1 - ratio);
}

bool falls(const std::vector<double>& moved, double noise)
{
    if (moved.empty()) return false;
    const std::size_t n = moved.size();
    if (moved[n - 1] <= noise) return true;
    if (n < 2) return false;
    if (moved[n - 1] <= most_ratio * moved[n - 2]) return true;
    // one unlucky pair does not make a divergence when the trend over two refinements is down
    return n >= 3 && moved[n - 1] <= most_ratio * most_ratio * moved[n - 3];
}

PlanReference refine_scene(const StudyScene& scene, const RunPlan& plan, const ReferenceGoals& goals, RunStore& store,
                           const std::string& name, const std::function<void(const std::string&)>& progress)
{
    return Levels(scene, plan, goals, store, name, progress).refine();
}

}  // namespace seldinger
