// Refines a scene in nodes and steps, judges convergence from how far each level moves, and stops when it is good enough.
#include "models/reference.h"

#include "core/file_io.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// Below this a movement is rounding and the solver's tolerance, not discretisation: 0.1 micrometres. On a wire at rest the hand
// force's 20 ms mean scatters by 0.01 mN.
constexpr PerObservable noise = {1e-8, 1e-8, 1e-6, 1e-6, 1e-6};

constexpr double wall_refinement = 1.5;
constexpr double cost_of_a_level = 4;  // twice the nodes, twice the steps

}  // namespace

Model refined(const Refinement& how, int level)
{
    Model model = how.coarsest;
    const int factor = 1 << level;
    model.nodes = (model.nodes.value_or(101) - 1) * factor + 1;
    model.dt = model.dt.value_or(1e-3) / factor;
    if (model.wall_edge) model.wall_edge = std::max(how.least_wall_edge, *model.wall_edge / std::pow(wall_refinement, level));
    model.name = fmt::format("reference {}", level);
    return model;
}

std::string_view word_of(Convergence convergence)
{
    constexpr std::string_view words[] = {"analytic", "converges", "does not converge", "too few refinements"};
    return words[static_cast<int>(convergence)];
}

Convergence judge_movements(const std::vector<double>& moved, double smallest)
{
    if (moved.empty()) return Convergence::Unknown;
    const double last = moved.back();
    if (last <= smallest) return Convergence::Falling;
    if (moved.size() < 2) return Convergence::Unknown;
    const double before = moved[moved.size() - 2];
    if (last > 0.8 * before) {
        // one unlucky pair does not make a divergence when the trend over two refinements is down
        return moved.size() >= 3 && last <= 0.5 * moved[moved.size() - 3] ? Convergence::Falling : Convergence::NotFalling;
    }
    return Convergence::Falling;
}

Refiner::Refiner(const StudyScene& scene, Refinement how, RunPlan plan, Window window, std::filesystem::path folder,
                 std::vector<Baseline> baselines)
    : scene_(scene),
      how_(std::move(how)),
      plan_(std::move(plan)),
      window_(window),
      folder_(std::move(folder)),
      baselines_(std::move(baselines))
{
    plan_.repeats = 1;
    plan_.wall_limit = std::numeric_limits<double>::infinity();
}

bool Refiner::add_level()
{
    const int level = static_cast<int>(levels_.size());
    const auto file = folder_ / fmt::format("reference-{}.trajectory", level);
    Trajectory found;
    if (!folder_.empty() && load_trajectory(file, found)) {
        levels_.push_back(std::move(found));
        return true;
    }
    if (level > 0 && spent_ + cost_of_a_level * last_wall_ > how_.wall_limit && level >= how_.least_levels) return false;
    const ModelRun run = run_model(scene_, refined(how_, level), plan_, baselines_);
    last_wall_ = (plan_.processor_time ? run.cost.cpu : run.cost.wall) *
                 std::max(run.simulated, scene_.scene.integrator.scheme == Scheme::Static ? 1.0 : 0.0);
    spent_ += last_wall_;
    stopped_ = run.stopped;
    if (!run.complete) {
        if (!stopped_)
            reference_.note = failure_ =
                fmt::format("refinement {} failed at {:.3g} s: {}", level, run.failed_at, name(run.verdict.outcome));
        return false;
    }
    if (!folder_.empty()) save_trajectory(file, run.trajectory);
    levels_.push_back(run.trajectory);
    return true;
}

void Refiner::judge()
{
    reference_.levels = static_cast<int>(levels_.size());
    if (levels_.empty()) return;
    reference_.values = levels_.back();
    reference_.known.fill(true);
    while (reference_.moved.size() + 1 < levels_.size()) {
        const std::size_t k = reference_.moved.size();
        const Errors between = trajectory_errors(levels_[k], levels_[k + 1], window_);
        reference_.moved.push_back(between.rms);
        reference_.moved_median.push_back(between.median);
    }
    for (int k = 0; k < observable_count; ++k) {
        const auto judged = [k](const std::vector<PerObservable>& rows) {
            std::vector<double> moved;
            for (const PerObservable& values : rows) moved.push_back(values[k]);
            return judge_movements(moved, noise[k]);
        };
        // Medians do not see a jump that comes a little earlier or later; rms values do not see noise where most samples hardly
        // move. The uncertainty is the rms in either case.
        reference_.convergence[k] = judged(reference_.moved);
        if (reference_.convergence[k] != Convergence::Falling) reference_.convergence[k] = judged(reference_.moved_median);
        reference_.uncertainty[k] =
            reference_.moved.empty() ? std::numeric_limits<double>::quiet_NaN() : reference_.moved.back()[k];
    }
}

bool Refiner::nothing_to_gain(const PerObservable& wanted) const
{
    bool all_met = true, none_falls = true;
    for (int k = 0; k < observable_count; ++k) {
        if (std::isinf(wanted[k])) continue;
        all_met = all_met && reference_.uncertainty[k] <= std::max(noise[k], wanted[k]);
        none_falls = none_falls && reference_.convergence[k] == Convergence::NotFalling;
    }
    return all_met || none_falls;
}

const Reference& Refiner::refine_to(const PerObservable& wanted)
{
    while (!stopped_ && !exhausted_) {
        const int levels = static_cast<int>(levels_.size());
        if (levels >= how_.least_levels && nothing_to_gain(wanted)) break;
        if (levels >= how_.most_levels || !add_level()) exhausted_ = !stopped_;
        judge();
    }
    if (failure_.empty() && reference_.levels > 0) {
        const Model finest = refined(how_, reference_.levels - 1);
        reference_.note =
            fmt::format("{} levels, the finest with {} nodes and {:.3g} ms", reference_.levels, *finest.nodes, 1e3 * *finest.dt);
        if (finest.wall_edge) reference_.note += fmt::format(", control edges of {:.3g} mm", 1e3 * *finest.wall_edge);
    }
    return reference_;
}

}  // namespace seldinger
