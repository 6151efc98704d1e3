// Refines a scene in nodes and steps, judges convergence from how far each level moves, and stops when it is good enough.
#include "models/refinement.h"

#include "models/wall_edges.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {
namespace {

constexpr double least_ratio = 0.5, most_ratio = 0.8;
constexpr double coarsest_edge = 0.010;  // [m]
constexpr int fewest_in_reference = 17;
constexpr double coarsest_step = 1.0 / 60;  // [s]
constexpr int least_levels = 3, most_levels = 9;
constexpr std::size_t trapezoid_failures = 3;  // levels that break off before backward Euler is taken instead
// Below this a movement is rounding and the solver's tolerance, not discretisation: 0.1 micrometres. On a wire at rest the hand
// force's 20 ms mean scatters by 0.01 mN.
constexpr PerObservable noise = {1e-8, 1e-8, 1e-6, 1e-6, 1e-6};

Model level_model(const Scene& scene, const WallEdges& wall, const RunPlan& plan, int level, bool trapezoid)
{
    const bool is_static = scene.integrator.scheme == Scheme::Static;
    Model model;
    const double coarsest = std::max<double>(fewest_in_reference - 1, std::ceil(scene.wire.length / coarsest_edge));
    model.nodes = static_cast<int>(std::lround(coarsest * std::pow(edge_refinement, level))) + 1;
    model.scheme = is_static ? Scheme::Static : Scheme::Newton;
    model.tolerance = std::min(scene.integrator.tolerance, IntegratorSpec{}.tolerance);
    if (scene.vessel.shape != VesselShape::None) model.detection = Detection::Swept;
    if (wall.elastic()) model.wall_edge = wall.of_level(level, edge_refinement);
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

std::vector<double> column(const std::vector<PerObservable>& rows, std::size_t k)
{
    std::vector<double> values;
    for (const PerObservable& row : rows) values.push_back(row[k]);
    return values;
}

/// Judges every observable by the rms of its movements.
void judge_levels(Reference& reference)
{
    reference.known.fill(true);
    for (std::size_t k = 0; k < observable_count; ++k)
        reference.convergence[k] = judge_movements(column(reference.moved, k), noise[k]);
}

/// @return whether it is good enough
bool meets(Reference& reference, const ReferenceGoals& goals)
{
    reference.force_scale = std::max(1e-3, rms_hand_force(reference.values));
    if (reference.moved.empty()) return false;
    judge_levels(reference);
    for (std::size_t k = 0; k < observable_count; ++k) reference.uncertainty[k] = error_left(column(reference.moved, k));
    reference.peak_uncertainty = peaks_left(reference.peaks_moved);
    const double force = goals.force * (goals.force_is_relative ? reference.force_scale : 1.0);
    PerObservable wanted;
    wanted.fill(std::numeric_limits<double>::infinity());
    at(wanted, Observable::Shape) = goals.shape, at(wanted, Observable::HandForce) = force;
    reference.converges = true;
    bool is_enough = static_cast<int>(reference.levels.size()) >= least_levels;
    for (std::size_t k = 0; k < observable_count; ++k) {
        if (std::isinf(wanted[k])) continue;
        reference.converges = reference.converges && reference.convergence[k] == Convergence::Falling;
        is_enough = is_enough && reference.uncertainty[k] <= std::max(wanted[k], noise[k]);
    }
    return is_enough && reference.converges && goals.peaks.holds({}, reference.peak_uncertainty, reference.values.peaks);
}

/// Movements do not tell what the control mesh is wrong by once it is refined no further.
void bound_wall(Refiner& refiner)
{
    Reference& reference = refiner.reference();
    if (!reference.model.wall_edge || reference.levels.size() < 2) return;
    Model coarser = reference.model;
    const double edge = *coarser.wall_edge, before = reference.levels[reference.levels.size() - 2].wall_edge.value_or(edge);
    constexpr double rounding = 1e-9;
    if (before >= edge_refinement * edge * (1 - rounding)) return;
    coarser.wall_edge = edge_refinement * edge;
    Trajectory values;
    const std::optional<RunRecord> run = refiner.run(coarser, values);
    if (!run || !sound(*run)) {
        reference.converges = false;
        return;
    }
    const Errors moved = trajectory_errors(values, reference.values);
    for (std::size_t k = 0; k < reference.uncertainty.size(); ++k) reference.uncertainty[k] += moved.rms[k];
    const Peaks peaks = difference(values.peaks, reference.values.peaks);
    for (std::size_t k = 0; k < peaks.size(); ++k) reference.peak_uncertainty[k] += peaks[k];
}

/// Judges the present levels of a chart. @return whether there is nothing to gain
bool judge(Reference& reference, const Refinement& how, const PerObservable& wanted)
{
    judge_levels(reference);
    bool all_met = true, none_falls = true;
    for (std::size_t k = 0; k < observable_count; ++k) {
        // Medians do not see a jump that comes a little earlier or later; rms values do not see noise where most samples hardly
        // move. The uncertainty is the rms in either case.
        if (reference.convergence[k] != Convergence::Falling)
            reference.convergence[k] = judge_movements(column(reference.moved_median, k), noise[k]);
        reference.uncertainty[k] = reference.moved.empty() ? std::numeric_limits<double>::quiet_NaN() : reference.moved.back()[k];
        if (std::isinf(wanted[k])) continue;
        all_met = all_met && reference.uncertainty[k] <= std::max(noise[k], wanted[k]);
        none_falls = none_falls && reference.convergence[k] == Convergence::NotFalling;
    }
    return static_cast<int>(reference.levels.size()) >= how.least_levels && (all_met || none_falls);
}

}  // namespace

std::string_view word_of(Convergence convergence)
{
    constexpr std::string_view words[] = {"analytic", "converges", "does not converge", "too few refinements"};
    return words[static_cast<int>(convergence)];
}

Refiner::Refiner(const StudyScene& scene, Levels levels, RunPlan plan, RunStore& store, std::string name, Window window,
                 std::vector<Baseline> baselines)
    : scene_(scene),
      levels_(std::move(levels)),
      plan_(std::move(plan)),
      store_(store),
      name_(std::move(name)),
      window_(window),
      baselines_(std::move(baselines))
{
}

Reference& Refiner::refine_until(const std::function<bool(Reference&)>& enough)
{
    while (!exhausted_ && !reference_.stopped && (reference_.levels.empty() || !enough(reference_))) exhausted_ = !add_level();
    return reference_;
}

/// @return false when nothing more can be run
bool Refiner::add_level()
{
    if (level_ == levels_.most) return false;
    const double next = levels_.cost_growth * last_seconds_;
    if (level_ > 0 && !levels_.affordable(level_, spent_, next)) {
        reference_.out_of_budget = true;
        return false;
    }
    const Model model = levels_.model(level_++);
    Trajectory values;
    const std::optional<RunRecord> done = run(model, values);
    if (!done) return false;
    if (!sound(*done)) return go_on_after(model, *done);
    take_in(model, *done, std::move(values));
    return true;
}

std::optional<RunRecord> Refiner::run(const Model& model, Trajectory& values)
{
    if (levels_.progress) levels_.progress(fmt::format("reference: {}", label(model)));
    if (levels_.seconds_left) plan_.wall_limit = levels_.seconds_left();
    const std::optional<RunRecord> run = store_.get(name_, scene_, model, plan_, baselines_, &values);
    reference_.stopped = !run;
    if (!run) return {};
    reference_.out_of_budget = run->over_limit;
    if (run->over_limit) return {};
    const bool is_static = scene_.scene.integrator.scheme == Scheme::Static;
    last_seconds_ = (plan_.processor_time ? run->cost.cpu : run->cost.wall) * std::max(run->simulated, is_static ? 1.0 : 0.0);
    spent_ += last_seconds_;
    return run;
}

bool Refiner::go_on_after(const Model& broken, const RunRecord& run)
{
    reference_.failures.push_back(
        fmt::format("{}: {} after {:.3g} s", label(broken),
                    run.outcome == Outcome::Hold ? "did not finish" : std::string(seldinger::name(run.outcome)), run.simulated));
    if (levels_.ends_when_broken) return false;
    reference_.levels.clear();
    reference_.moved.clear();
    reference_.moved_median.clear();
    reference_.peaks_moved.clear();
    if (levels_.over_again && levels_.over_again(reference_.failures.size())) level_ = 0;
    return true;
}

void Refiner::take_in(const Model& model, const RunRecord& run, Trajectory values)
{
    if (!reference_.levels.empty()) {
        const Errors between = trajectory_errors(reference_.values, values, window_);
        reference_.moved.push_back(between.rms);
        reference_.moved_median.push_back(between.median);
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

Reference refine_scene(const StudyScene& scene, const RunPlan& plan, const ReferenceGoals& goals, RunStore& store,
                       const std::string& name, const std::function<void(const std::string&)>& progress)
{
    const bool is_static = scene.scene.integrator.scheme == Scheme::Static;
    const WallEdges wall = wall_edges(scene.setup);
    // without contact the motion is smooth in time: second order, unless that breaks off. With contact the trapezoid rule rings
    bool trapezoid = !is_static && scene.scene.vessel.shape == VesselShape::None && !scene.scene.integrator.conserve;
    Levels levels;
    levels.model = [&](int level) { return level_model(scene.scene, wall, plan, level, trapezoid); };
    levels.most = most_levels;
    levels.cost_growth = edge_refinement * step_refinement;
    levels.over_again = [&](std::size_t broken) { return broken >= trapezoid_failures && std::exchange(trapezoid, false); };
    levels.affordable = [&](int, double, double next) { return goals.affordable(next); };
    levels.seconds_left = goals.seconds_left;
    levels.progress = progress;
    Refiner refiner(scene, std::move(levels), plan, store, name);
    Reference& reference = refiner.refine_until([&](Reference& so_far) { return meets(so_far, goals); });
    if (reference.converges && !reference.stopped) bound_wall(refiner);
    return std::move(reference);
}

Model Refinement::model(int level) const
{
    Model model = coarsest;
    const int factor = 1 << level;
    model.nodes = (model.nodes.value_or(101) - 1) * factor + 1;
    model.dt = model.dt.value_or(1e-3) / factor;
    if (model.wall_edge) model.wall_edge = std::max(least_wall_edge, *model.wall_edge / std::pow(edge_refinement, level));
    model.name = fmt::format("reference {}", level);
    return model;
}

Levels Refinement::levels() const
{
    Levels levels;
    levels.model = [how = *this](int level) { return how.model(level); };
    levels.most = most_levels;
    levels.ends_when_broken = true;
    levels.affordable = [most = wall_limit, least = least_levels](int level, double spent, double next) {
        return level < least || spent + next <= most;
    };
    return levels;
}

const Reference& refine_to(Refiner& refiner, const Refinement& how, const PerObservable& wanted)
{
    Reference& reference = refiner.refine_until([&](Reference& so_far) { return judge(so_far, how, wanted); });
    if (!reference.failures.empty()) {
        reference.note = reference.failures.back();
    } else if (!reference.levels.empty()) {
        const Model& finest = reference.model;
        reference.note = fmt::format("{} levels, the finest with {} nodes and {:.3g} ms", reference.levels.size(), *finest.nodes,
                                     1e3 * *finest.dt);
        if (finest.wall_edge) reference.note += fmt::format(", control edges of {:.3g} mm", 1e3 * *finest.wall_edge);
    }
    return reference;
}

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

Convergence judge_movements(const std::vector<double>& moved, double smallest)
{
    const std::size_t n = moved.size();
    if (n == 0) return Convergence::Unknown;
    if (moved[n - 1] <= smallest) return Convergence::Falling;
    if (n == 1) return Convergence::Unknown;
    if (moved[n - 1] <= most_ratio * moved[n - 2]) return Convergence::Falling;
    // one unlucky pair does not make a divergence when the trend over two refinements is down
    return n >= 3 && moved[n - 1] <= most_ratio * most_ratio * moved[n - 3] ? Convergence::Falling : Convergence::NotFalling;
}

}  // namespace seldinger
