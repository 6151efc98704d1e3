// Runs a chart's models and references scene by scene, compares, and writes chart.csv and references.csv.
#include "lab/chart.h"

#include "core/error.h"
#include "lab/pareto.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double resolved_by = 10;  // errors this many times the reference's uncertainty are told from it

struct Budget {
    int repeats;
    double repeat_wall, wall_limit;  // [s]; see RunPlan
};
constexpr Budget quick_budget = {3, 0.5, 10}, full_budget = {3, 4, 60};

RunPlan plan_of(const ChartOptions& options, const Benchmark& benchmark)
{
    const Budget& budget = options.quick ? quick_budget : full_budget;
    RunPlan plan;
    plan.until = benchmark.until;
    plan.interval = benchmark.interval;
    plan.processor_time = options.processor_time;
    plan.repeats = budget.repeats;
    plan.repeat_wall = budget.repeat_wall;
    plan.wall_limit = options.run_limit > 0 ? options.run_limit : budget.wall_limit;
    plan.end_on_blow_up = false;  // a method that makes energy is charted with the error that this leads to
    plan.stop = options.stop;
    return plan;
}

/// The model of options.planned. @throws Error BadScene: that scene is not this one under a model
ChartModel planned_model(const ChartOptions& options, const Scene& scene)
{
    const Scene planned = read_scene(options.planned);
    ChartModel entry;
    entry.family = "planned";
    entry.model = model_of(planned);
    Scene under = apply(entry.model, scene);
    under.planned = planned.planned;
    const auto folder = scene.source.parent_path();
    if (write_scene(under, folder) != write_scene(planned, folder))
        throw Error(ErrorKind::BadScene,
                    fmt::format("--planned {}: is not {} under another model; give what `seldinger plan` wrote for it",
                                options.planned.string(), scene.source.string()));
    entry.model.name = "planned";
    return entry;
}

std::vector<ChartModel> models_for(const ChartOptions& options, const Scene& scene, const WallEdges& walls)
{
    std::vector<ChartModel> models = chart_models(scene, options.quick, options.baselines, walls);
    if (!options.planned.empty()) models.insert(models.begin(), planned_model(options, scene));
    return models;
}

void tell(const ChartOptions& options, const std::string& doing)
{
    if (options.progress) options.progress(doing);
}

double error_of(const ChartPoint& point, Observable which) { return at(point.errors.rms, which); }

/// What the front is made of: an error below the reference's uncertainty is known to be no larger than that, and no better.
CostAndError cost_and_error(const SceneChart& chart, const ChartPoint& point, Observable which)
{
    const double error = std::max(error_of(point, which), at(chart.reference.uncertainty, which));
    const bool says_something = error < at(chart.scale, which);
    return {point.cost(chart.processor_time), point.sound() && says_something ? error : std::numeric_limits<double>::quiet_NaN()};
}

/// How large the observables are, to set errors beside.
PerObservable scale_of(const Trajectory& values, const Window& window)
{
    PerObservable sum{};
    int count = 0;
    for (const Sample& sample : values.samples) {
        if (!window.holds(sample.t)) continue;
        ++count;
        at(sum, Observable::HandForce) += sample.hand_force * sample.hand_force;
        at(sum, Observable::Friction) += sample.friction * sample.friction;
        at(sum, Observable::Contact) += sample.normal * sample.normal;
    }
    for (double& value : sum) value = count > 0 ? std::sqrt(value / count) : 0;
    at(sum, Observable::Tip) = at(sum, Observable::Shape) = values.wire_length;
    return sum;
}

void compare(SceneChart& chart, const std::vector<Trajectory>& trajectories)
{
    chart.scale = scale_of(chart.reference.values, chart.benchmark.window);
    for (std::size_t i = 0; i < chart.points.size(); ++i)
        chart.points[i].errors = trajectory_errors(trajectories[i], chart.reference.values, chart.benchmark.window);
    for (const Observable which : chart.benchmark.charted) {
        if (!chart.charts(which)) continue;
        const auto k = static_cast<std::size_t>(which);
        std::vector<CostAndError> points;
        for (ChartPoint& point : chart.points) {
            points.push_back(cost_and_error(chart, point, which));
            point.resolved[k] = error_of(point, which) >= resolved_by * chart.reference.uncertainty[k];
            point.front[k] = false;
        }
        for (const std::size_t i : pareto_front(points, chart.reference.uncertainty[k])) chart.points[i].front[k] = true;
    }
}

/// 10 % of the smallest error in the chart; infinite if an observable is not in it.
PerObservable wanted_uncertainty(const SceneChart& chart)
{
    PerObservable wanted;
    wanted.fill(std::numeric_limits<double>::infinity());
    for (const Observable which : chart.benchmark.charted) {
        for (const ChartPoint& point : chart.points)
            if (point.sound()) at(wanted, which) = std::min(at(wanted, which), error_of(point, which) / resolved_by);
    }
    return wanted;
}

/// One scene: its models, then its reference, refined to 10 % of the smallest error.
class SceneRun {
public:
    SceneRun(const ChartOptions& options, RunStore& store, SceneChart& chart, const StudyScene& study)
        : options_(options), store_(store), chart_(chart), study_(study), plan_(plan_of(options, chart.benchmark))
    {
    }

    /// @return false when interrupted
    bool run_models(ChartResult& result)
    {
        for (const ChartModel& model : models_) {
            tell(options_, fmt::format("{}: {} ({} of {})", chart_.benchmark.name, model.model.name, result.runs_done + 1,
                                       result.runs_wanted));
            Trajectory trajectory;
            const auto record = store_.get(chart_.benchmark.name, study_, model.model, plan_, options_.baselines, &trajectory);
            if (!record) return false;
            ++result.runs_done;
            ChartPoint point;
            point.model = model;
            if (model.model.baseline.empty())
                point.settings = fmt::format("{}", fmt::join(set_texts(model.model, study_.scene), " "));
            point.run = *record;
            chart_.points.push_back(std::move(point));
            trajectories_.push_back(std::move(trajectory));
        }
        return true;
    }

    bool find_reference()
    {
        if (chart_.benchmark.analytic) {
            chart_.reference = analytic_reference(chart_.benchmark, study_.scene);
            compare(chart_, trajectories_);
        } else {
            Refinement& how = chart_.benchmark.refinement;
            refine_wall(how);
            RunPlan once = plan_;
            once.repeats = 1;
            once.wall_limit = std::numeric_limits<double>::infinity();
            Refiner refiner(study_, how.levels(), once, store_, chart_.benchmark.name, chart_.benchmark.window);
            PerObservable wanted;
            wanted.fill(std::numeric_limits<double>::infinity());
            // a better reference makes small errors smaller, and so asks for a better one: at most as often as there are levels
            for (int k = 0; k <= how.most_levels; ++k) {
                tell(options_,
                     fmt::format("{}: reference, {} levels so far", chart_.benchmark.name, refiner.reference().levels.size()));
                chart_.reference = refine_to(refiner, how, wanted);
                compare(chart_, trajectories_);
                const PerObservable now = wanted_uncertainty(chart_);
                if (chart_.reference.stopped || now == wanted) break;
                wanted = now;
            }
            if (chart_.reference.stopped) return false;
        }

        chart_.finished = true;
        return true;
    }

    /// @return how many models there are to run
    int choose_models()
    {
        for (ChartModel& model : models_for(options_, study_.scene, wall_edges(study_.setup)))
            (model.refused.empty() ? models_ : chart_.refused).push_back(std::move(model));
        return static_cast<int>(models_.size());
    }

private:
    void refine_wall(Refinement& how) const
    {
        const WallEdges walls = wall_edges(study_.setup);
        if (!walls.elastic()) return;
        how.coarsest.wall_edge = walls.of_level(0, 1);
        how.least_wall_edge = walls.least;
    }

    const ChartOptions& options_;
    RunStore& store_;
    SceneChart& chart_;
    const StudyScene& study_;
    RunPlan plan_;
    std::vector<ChartModel> models_;
    std::vector<Trajectory> trajectories_;
};

void write_tables(const ChartOptions& options, const ChartResult& result)
{
    write_file(options.dir / "chart.csv", chart_csv(result));
    write_file(options.dir / "references.csv", references_csv(result));
}

}  // namespace

bool ChartPoint::sound() const
{
    return run.complete && run.outcome != Outcome::Overlap && run.outcome != Outcome::Escape && run.outcome != Outcome::BlowUp;
}

ChartResult make_chart(const ChartOptions& options)
{
    ChartResult result;
    const std::vector<std::string> names = options.scenes.empty() ? benchmark_names() : options.scenes;
    if (!options.planned.empty() && names.size() != 1)
        throw Error(ErrorKind::BadScene, "--planned belongs to one scene; give it with --scenes");
    std::vector<Scene> scenes;
    for (const std::string& name : names) {  // every name and file is checked before the first run
        SceneChart chart;
        chart.benchmark = find_benchmark(name, options.scenes_folder, options.quick);
        scenes.push_back(read_scene(chart.benchmark.file));
        chart.title = scenes.back().name;
        chart.processor_time = options.processor_time;
        complete(chart.benchmark, scenes.back());
        if (options.reference_limit > 0) chart.benchmark.refinement.wall_limit = options.reference_limit;
        // an elastic wall has models that go by its vessel's mesh
        const WallEdges walls =
            scenes.back().vessel.elastic ? wall_edges(load_study_scene(scenes.back(), options.device).setup) : WallEdges{};
        for (const ChartModel& model : models_for(options, scenes.back(), walls)) result.runs_wanted += model.refused.empty();
        result.scenes.push_back(std::move(chart));
    }
    RunStore store(options.dir);
    for (std::size_t i = 0; i < scenes.size() && !result.interrupted; ++i) {
        const StudyScene study = load_study_scene(scenes[i], options.device);
        SceneRun run(options, store, result.scenes[i], study);
        (void)run.choose_models();
        result.interrupted = !run.run_models(result) || !run.find_reference();
        write_tables(options, result);
    }
    return result;
}

Standing standing(const SceneChart& chart, const ChartPoint& point, Observable which)
{
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const double cost = point.cost(chart.processor_time), error = error_of(point, which);
    double cheapest = std::numeric_limits<double>::infinity(), best = cheapest;
    for (const ChartPoint& other : chart.points) {
        if (!other.front[static_cast<std::size_t>(which)]) continue;
        const CostAndError its = cost_and_error(chart, other, which);
        if (its.error <= std::max(error, at(chart.reference.uncertainty, which))) cheapest = std::min(cheapest, its.cost);
        if (its.cost <= cost) best = std::min(best, its.error);
    }
    return {std::isinf(cheapest) ? none : cost / cheapest, std::isinf(best) ? none : error / best};
}

}  // namespace seldinger
