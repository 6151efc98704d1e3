// The stability maps' methods and steps, the scene of a cell, and who cannot run it; stability_maps.cpp has the maps.
#include "lab/stability.h"

#include "core/error.h"
#include "core/file_io.h"
#include "lab/published.h"
#include "models/run_model.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double slow_pace = 4;     // by which prescribed motion is slowed down where static indentation is looked for
constexpr double slow_step = 1e-3;  // [s]

Model method(std::string name, Scheme scheme, Detection detection, NormalLaw normal, FrictionLaw friction)
{
    Model model;
    model.name = std::move(name);
    model.scheme = scheme;
    model.detection = detection;
    model.normal = normal;
    model.friction = friction;
    return model;
}

/// What a map leaves open: it sweeps step and stiffness itself.
Model at_its_best()
{
    Model model = published_at_best({}, false);
    model.name = "published, at its best";
    model.dt.reset();
    model.nodes.reset();
    return model;
}

std::vector<Model> all_methods()
{
    using S = Scheme;
    using D = Detection;
    using N = NormalLaw;
    using F = FrictionLaw;
    std::vector<Model> methods = {
        published_method(),
        at_its_best(),
        method("published, nodes", S::Linearised, D::Nodes, N::LankaraniNikravesh, F::Sign),
        method("published, newton", S::Newton, D::Layer, N::LankaraniNikravesh, F::Sign),
        method("linearised, layer", S::Linearised, D::Layer, N::HuntCrossley, F::StickSlip),
        method("linearised, nodes", S::Linearised, D::Nodes, N::HuntCrossley, F::StickSlip),
        method("linearised, swept, sign", S::Linearised, D::Swept, N::LankaraniNikravesh, F::Sign),
        method("linearised, swept", S::Linearised, D::Swept, N::HuntCrossley, F::StickSlip),
        method("explicit", S::Explicit, D::Swept, N::HuntCrossley, F::Smooth),
        method("trapezoid, swept", S::Newton, D::Swept, N::HuntCrossley, F::StickSlip),
        method("augmented", S::Newton, D::Swept, N::Augmented, F::StickSlip),
        method("constraint", S::Newton, D::Swept, N::Constraint, F::StickSlip),
        method("impulse", S::Newton, D::Swept, N::Impulse, F::StickSlip),
        method("barrier", S::Newton, D::Swept, N::Barrier, F::StickSlip),
        method("default", S::Newton, D::Swept, N::HuntCrossley, F::StickSlip),
    };
    for (Model& model : methods)
        if (model.name.starts_with("trapezoid")) model.trapezoid = true;
    return methods;
}

/// What of a method makes sense in a map: a free rod has no contact to choose.
Model in_map(const StabilityMap& map, Model model)
{
    if (map.touches) return model;
    model.detection.reset();
    model.normal.reset();
    model.friction.reset();
    return model;
}

ModelRun run_cell(const Scene& scene, const Model& method, FailureLimits limits, double wall_limit,
                  const std::function<bool()>& stop)
{
    RunPlan plan;
    plan.limits = limits;
    plan.wall_limit = wall_limit;
    plan.stop_now = stop;
    plan.interval = scene.duration;  // one sample: steps are not shortened to fit others in
    return run_model(load_study_scene(scene), method, plan);
}

}  // namespace

std::vector<double> stability_steps(bool quick)
{
    if (quick) return {1e-3, 1.0 / 60, 1.0 / 30};
    return {1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 1.0 / 60, 1.0 / 30};
}

const std::vector<Model>& stability_methods()
{
    static const std::vector<Model> methods = all_methods();
    return methods;
}

bool is_shown(const Model& method, bool quick)
{
    constexpr std::string_view shown[] = {
        "published", "published, at its best", "published, nodes", "linearised, swept", "default", "constraint", "barrier"};
    constexpr std::ptrdiff_t quick_count = 5;
    const auto end = quick ? std::begin(shown) + quick_count : std::end(shown);
    return std::find(std::begin(shown), end, method.name) != end;
}

const Model& default_method() { return stability_methods().back(); }

StabilityMap map_of_scene(const std::filesystem::path& file, const std::string& key, const std::vector<double>& values)
{
    StabilityMap map;
    map.source = std::filesystem::absolute(file);
    map.scene = read_file(file);
    map.name = file.stem().string();
    map.rows = "";
    map.title = file.filename().string();
    map.axis = key;
    map.values = map.quick_values = values;
    map.logarithmic = values.front() > 0;
    map.static_load = false;
    map.set = [key](double value, double, double, const std::filesystem::path&) {
        return std::vector<std::string>{fmt::format("{}={}", key, value)};
    };
    for (const double value : values) {
        const Scene scene = stability_scene(map, value, slow_step, 1, {});
        map.touches = scene.vessel.shape != VesselShape::None;
        if (scene.integrator.scheme == Scheme::Static || !(scene.duration > 0))
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: a static scene has no steps to sweep; give scene.duration_s and another "
                                    "integrator.scheme",
                                    file.string()));
        const double longest = stability_steps(false).back();
        if (scene.duration < longest)
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: scene.duration_s: got {} s; expected at least the longest step of the sweep, {:.4f} s",
                                    file.string(), scene.duration, longest));
    }
    return map;
}

Scene stability_scene(const StabilityMap& map, double value, double dt, double pace, const std::filesystem::path& folder)
{
    std::vector<std::string> texts = map.set(value, dt, pace, folder);
    texts.push_back(fmt::format("scene.dt_s={}", dt));
    return read_scene_text(map.scene, map.source.empty() ? folder / (map.name + ".toml") : map.source, texts);
}

double CellReference::honest_jitter(double dt) const
{
    if (dt < 2 * slow_step) return 0;
    std::vector<double> looked_at;
    for (double t = dt;; t += dt) {
        const auto at = static_cast<std::size_t>(std::lround(t / slow_step));
        if (at > hand_force.size()) break;
        looked_at.push_back(hand_force[at - 1]);
    }
    return std::max(0.0, jitter_of(looked_at, {}));
}

CellReference cell_reference(const StabilityMap& map, double value, const std::filesystem::path& folder,
                             const std::function<bool()>& stop)
{
    CellReference reference;
    const double forever = std::numeric_limits<double>::infinity();
    if (map.touches && map.static_load) {
        const ModelRun slow =
            run_cell(stability_scene(map, value, slow_step, slow_pace, folder), default_method(), {}, forever, stop);
        if (slow.complete) reference.indentation = slow.verdict.readings.overlap;
    }
    if (map.touches && map.hand_is_steady) {
        RunPlan plan;
        plan.stop_now = stop;
        plan.interval = slow_step;
        plan.average = 0;  // the force of one step
        const ModelRun run =
            run_model(load_study_scene(stability_scene(map, value, slow_step, 1, folder)), default_method(), plan);
        if (run.complete)
            for (const Sample& sample : run.trajectory.samples) reference.hand_force.push_back(sample.hand_force);
    }
    return reference;
}

CellResult run_stability_cell(const StabilityCell& cell, const CellReference& reference, double wall_limit,
                              const std::function<bool()>& stop)
{
    const auto& [map, method, dt, value, folder] = cell;
    const Scene scene = stability_scene(map, value, dt, 1, folder);
    FailureLimits limits;
    limits.static_indentation = reference.indentation;
    limits.jitter = map.hand_is_steady ? limits.jitter + reference.honest_jitter(dt) : std::numeric_limits<double>::infinity();
    const ModelRun run = run_cell(scene, in_map(map, method), limits, wall_limit, stop);
    return {run.verdict,       std::min(2 * reference.indentation, scene.wire.shaft.radius),
            limits.jitter,     run.simulated,
            run.over_limit,    run.stopped,
            run.wall_far_steps};
}

std::string why_not_in(const StabilityMap& map, const Model& method, const std::filesystem::path& folder)
{
    // methods that differ by contact alone are one method where nothing is touched
    constexpr std::string_view integrators[] = {"published", "explicit", "trapezoid, swept", "default"};
    if (!map.touches && std::find(std::begin(integrators), std::end(integrators), method.name) == std::end(integrators))
        return "another method with the same integrator is shown: the rod touches nothing";
    return why_not(in_map(map, method), stability_scene(map, map.values.front(), slow_step, 1, folder));
}

}  // namespace seldinger
