#include "study/stability.h"

#include "study/run_model.h"

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

std::vector<Model> all_methods()
{
    using S = Scheme;
    using D = Detection;
    using N = NormalLaw;
    using F = FrictionLaw;
    std::vector<Model> methods = {
        method("published", S::Linearised, D::Layer, N::LankaraniNikravesh, F::Sign),
        method("published, newton", S::Newton, D::Layer, N::LankaraniNikravesh, F::Sign),
        method("linearised, layer", S::Linearised, D::Layer, N::HuntCrossley, F::StickSlip),
        method("linearised, nodes", S::Linearised, D::Nodes, N::HuntCrossley, F::StickSlip),
        method("linearised, swept, sign", S::Linearised, D::Swept, N::LankaraniNikravesh, F::Sign),
        method("linearised, swept", S::Linearised, D::Swept, N::HuntCrossley, F::StickSlip),
        method("explicit", S::Explicit, D::Capsule, N::HuntCrossley, F::Smooth),
        method("newton, capsule", S::Newton, D::Capsule, N::HuntCrossley, F::StickSlip),
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

ModelRun run_cell(const Scene& scene, const Model& method, FailureLimits limits, double wall_limit)
{
    RunPlan plan;
    plan.limits = limits;
    plan.wall_limit = wall_limit;
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

const Model& default_method() { return stability_methods().back(); }

Scene stability_scene(const StabilityMap& map, double value, double dt, double pace, const std::filesystem::path& folder)
{
    std::vector<std::string> texts = map.set(value, dt, pace, folder);
    texts.push_back(fmt::format("scene.dt_s={}", dt));
    return read_scene_text(map.scene, folder / (map.name + ".toml"), texts);
}

double static_indentation(const StabilityMap& map, double value, const std::filesystem::path& folder)
{
    if (!map.touches || !map.static_load) return std::numeric_limits<double>::infinity();
    const ModelRun run = run_cell(stability_scene(map, value, slow_step, slow_pace, folder), default_method(), {},
                                  std::numeric_limits<double>::infinity());
    return run.complete ? run.verdict.readings.overlap : std::numeric_limits<double>::infinity();
}

CellResult run_stability_cell(const StabilityMap& map, const Model& method, double dt, double value, double indentation,
                              const std::filesystem::path& folder, double wall_limit)
{
    const Scene scene = stability_scene(map, value, dt, 1, folder);
    FailureLimits limits;
    limits.static_indentation = indentation;
    const ModelRun run = run_cell(scene, in_map(map, method), limits, wall_limit);
    return {run.verdict, std::min(2 * indentation, scene.wire.shaft.radius), run.simulated, run.over_limit};
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
