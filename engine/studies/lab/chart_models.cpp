// Builds the list of models of a chart: grids of nodes and steps, contact choices, adaptive, explicit, published, baselines.
#include "lab/chart_models.h"

#include "scene/scene_names.h"
#include "lab/published.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

constexpr double ms = 1e-3, frame = 1.0 / 60, half_rate = 1.0 / 30;  // [s]
constexpr int usual_nodes = 101;

std::string step_name(double dt) { return fmt::format("{:.3g} ms", 1e3 * dt); }

/// Collects models under short names; a model that is in the list already is not added again.
class Collection {
public:
    Collection(const Scene& scene, const std::vector<Baseline>& baselines) : scene_(scene), baselines_(baselines) {}

    ChartModel& add(const std::string& family, const std::string& name, Model model)
    {
        const auto same =
            std::find_if(list_.begin(), list_.end(), [&](const ChartModel& other) { return other.model.name == name; });
        if (same != list_.end()) return *same;
        ChartModel entry;
        model.name = name;
        entry.family = family;
        entry.refused = refusal(model);
        entry.model = std::move(model);
        list_.push_back(std::move(entry));
        return list_.back();
    }

    [[nodiscard]] std::vector<ChartModel> take() { return std::move(list_); }

private:
    std::string refusal(const Model& model) const
    {
        if (model.baseline.empty()) return why_not(model, scene_);
        for (const Baseline& baseline : baselines_)
            if (baseline.name == model.baseline) return baseline.why_not(scene_);
        return "not registered";
    }
    const Scene& scene_;
    const std::vector<Baseline>& baselines_;
    std::vector<ChartModel> list_;
};

Model basis(int nodes, double dt, Scheme scheme = Scheme::Newton)
{
    Model model;
    model.nodes = nodes;
    model.dt = dt;
    model.scheme = scheme;
    return model;
}

std::string grid_name(int nodes, double dt, Scheme scheme)
{
    return fmt::format("{} · {}{}", nodes > 0 ? fmt::format("{}", nodes) : "adaptive", step_name(dt),
                       scheme == Scheme::Linearised ? " · lin" : "");
}

void add_grid(Collection& models, const char* family, std::initializer_list<int> nodes, std::initializer_list<double> steps,
              std::initializer_list<Scheme> schemes)
{
    for (const Scheme scheme : schemes)
        for (const double dt : steps)
            for (const int n : nodes) models.add(family, grid_name(n, dt, scheme), basis(n, dt, scheme));
}

void add_published(Collection& models, const Scene& scene, bool quick)
{
    const auto add = [&](int nodes, double dt, Detection detection) {
        Model model = published_method(detection);
        model.nodes = nodes;
        model.dt = dt;
        const bool layer = detection == Detection::Layer;
        models.add("published", fmt::format("published{} {} · {}", layer ? "" : " laws, swept", nodes, step_name(dt)), model)
            .published = layer;
    };
    add(usual_nodes, 1 * ms, Detection::Layer);
    add(usual_nodes, frame, Detection::Layer);
    const std::string benchmark = scene.source.stem().string();
    for (const bool display : {false, true}) {
        const Model best = published_at_best(benchmark, display);
        models.add("published best", fmt::format("{} · {}", best.name, step_name(*best.dt)), best).published = true;
    }
    add(usual_nodes, 1 * ms, Detection::Swept);
    if (quick) return;
    for (const int nodes : {51, 201}) add(nodes, 1 * ms, Detection::Layer);
    for (const int nodes : {51, 201}) add(nodes, frame, Detection::Layer);
}

/// Every other value of one choice, at the usual nodes and step.
template <class Enum, std::size_t N>
void add_choice(Collection& models, const char* family, const Choice<Enum> (&words)[N], std::optional<Enum> Model::*choice,
                Enum own, const char* after = "")
{
    for (const Choice<Enum>& word : words) {
        if (word.value == own || word.word != word_of(words, word.value)) continue;  // the latter: another word for a value
        Model model = basis(usual_nodes, 1 * ms);
        model.*choice = word.value;
        models.add(family, std::string(word.word) + after, model);
    }
}

void add_contact_choices(Collection& models, const Scene& scene, bool quick)
{
    const ContactSpec& own = scene.contact;
    add_choice(models, "detection", detection_words, &Model::detection, own.detection);
    add_choice(models, "friction", friction_words, &Model::friction, own.friction, " friction");
    add_choice(models, "normal law", normal_words, &Model::normal, own.normal);
    Model rolling = basis(usual_nodes, 1 * ms);
    rolling.rolling = !own.rolling;
    models.add("rolling", own.rolling ? "no rolling" : "rolling", rolling);
    if (quick) return;
    for (const auto& word : detection_words) {
        if (word.value == own.detection || word.word != word_of(detection_words, word.value)) continue;
        Model model = basis(usual_nodes, 1 * ms, Scheme::Linearised);
        model.detection = word.value;
        models.add("detection", std::string(word.word) + " · lin", model);
    }
}

/// Beside a rigid wall, what an elastic wall would do; beside an elastic one, rigid and coarser ones.
void add_walls(Collection& models, const Scene& scene, bool quick, const WallEdges& walls)
{
    const auto add = [&](bool elastic, double edge, double dt) {
        Model model = basis(usual_nodes, dt);
        model.elastic_wall = elastic;
        if (edge > 0) model.wall_edge = edge;
        const std::string word = edge > 0  ? fmt::format("wall edge {:.3g} mm", 1e3 * edge)
                                 : elastic ? "elastic wall"
                                           : "rigid wall";
        models.add("wall", dt == 1 * ms ? word : fmt::format("{} · {}", word, step_name(dt)), model);
    };
    add(!scene.vessel.elastic, 0, 1 * ms);
    if (!walls.elastic()) return;
    add(false, 0, frame);
    const std::vector<double> edges = walls.trials();
    for (const double edge : edges) {
        if (edge == walls.own) continue;
        add(true, edge, 1 * ms);
        if (!quick || edge == edges.front()) add(true, edge, frame);
    }
    if (!quick) add(true, walls.of_level(2, 1.5), 1 * ms);
}

/// Instruments inside each other: one centreline for all, or a rod each.
void add_coaxial(Collection& models, const Scene& scene, bool quick)
{
    if (!scene.coaxial) return;
    for (const Choice<CoaxialSpec::Model>& word : coaxial_words)
        for (const double dt : {1 * ms, 5 * ms, frame}) {
            if (word.value == scene.coaxial->model || (quick && dt == 5 * ms)) continue;
            Model model = basis(usual_nodes, dt);
            model.coaxial = word.value;
            models.add("coaxial", fmt::format("{} · {}", word.word, step_name(dt)), model);
            if (word.value != CoaxialSpec::Model::Merged || scene.coaxial->lumen_friction || !(scene.coaxial->mu_static > 0))
                continue;
            model.lumen_friction = true;
            models.add("coaxial", fmt::format("{}, lumen friction · {}", word.word, step_name(dt)), model);
        }
}

void add_adaptive(Collection& models, bool quick)
{
    add_grid(models, "adaptive", {0}, {1 * ms, frame}, {Scheme::Newton});
    if (quick) return;
    add_grid(models, "adaptive", {0}, {5 * ms, half_rate}, {Scheme::Newton});
    add_grid(models, "adaptive", {0}, {1 * ms, 5 * ms, frame}, {Scheme::Linearised});
    const auto bounds = [&](double shortest, double longest, double dt) {
        Model model = basis(0, dt);
        model.min_edge = shortest;
        model.max_edge = longest;
        models.add("adaptive", fmt::format("adaptive {:g}–{:g} mm · {}", 1e3 * shortest, 1e3 * longest, step_name(dt)), model);
    };
    bounds(0.5e-3, 5e-3, 1 * ms);
    bounds(2e-3, 20e-3, 1 * ms);
    bounds(2e-3, 20e-3, frame);
}

void add_swinging(Collection& models, bool quick)
{
    const auto trapezoid = [&](int nodes, double dt, Scheme scheme) {
        Model model = basis(nodes, dt, scheme);
        model.trapezoid = true;
        models.add("trapezoid", grid_name(nodes, dt, scheme) + " · trapezoid", model);
    };
    for (const double dt : {1 * ms, 5 * ms, frame}) trapezoid(usual_nodes, dt, Scheme::Newton);
    for (const double dt : {5 * ms, frame}) trapezoid(25, dt, Scheme::Newton);
    if (quick) return;
    for (const double dt : {0.2 * ms, 0.5 * ms, 2 * ms, 10 * ms, half_rate}) trapezoid(usual_nodes, dt, Scheme::Newton);
    for (const double dt : {1 * ms, 5 * ms, frame}) trapezoid(usual_nodes, dt, Scheme::Linearised);
    for (const double dt : {1 * ms, 5 * ms}) trapezoid(25, dt, Scheme::Linearised);
}

void add_explicit(Collection& models, const WireSpec& wire, std::initializer_list<int> nodes)
{
    for (const int n : nodes)
        models.add("explicit", fmt::format("explicit {}", n), basis(n, explicit_step(wire, n), Scheme::Explicit));
}

void add_baselines(Collection& models, const std::vector<Baseline>& baselines, bool quick)
{
    for (const Baseline& baseline : baselines)
        for (const int nodes : quick ? std::vector{13, 51} : std::vector{13, 25, 51, 101})
            for (const double dt : quick ? std::vector{1 * ms} : std::vector{1 * ms, 5 * ms, frame}) {
                if (baseline.own_step && dt != 1 * ms) continue;
                Model model = basis(nodes, dt);
                model.scheme.reset();
                model.baseline = baseline.name;
                models.add(baseline.name,
                           fmt::format("{} {}{}", baseline.name, nodes, baseline.own_step ? "" : " · " + step_name(dt)), model);
            }
}

}  // namespace

double explicit_step(const WireSpec& wire, int nodes)
{
    const double h = wire.length / (nodes - 1);
    double fastest = 0;  // omega of the shortest wave on the edges [rad/s]
    const auto include = [&](const WireSection& section) {
        const double r2 = section.radius * section.radius, line = section.density * std::numbers::pi * r2;
        fastest = std::max({fastest, 2 / h * std::sqrt(section.stretch_stiffness / line),
                            2 / h * std::sqrt(section.twist_stiffness / (line * r2 / 2)),
                            4 / (h * h) * std::sqrt(section.bend_stiffness / line)});
    };
    include(wire.shaft);
    for (const WireSectionRange& range : wire.sections) include(range.section);
    return 0.25 * 2 / fastest;
}

std::vector<ChartModel> chart_models(const Scene& scene, bool quick, const std::vector<Baseline>& baselines,
                                     const WallEdges& walls)
{
    const bool touches = scene.vessel.shape != VesselShape::None;
    constexpr auto newton = Scheme::Newton, linearised = Scheme::Linearised;
    Collection models(scene, baselines);
    if (quick) {
        add_grid(models, "nodes", {usual_nodes, 25, 51}, {1 * ms}, {newton});
        add_grid(models, "step", {usual_nodes}, {5 * ms, frame}, {newton, linearised});
        add_grid(models, "step", {usual_nodes}, {1 * ms}, {linearised});
        add_grid(models, "cheap", {25}, {frame}, {newton, linearised});
    } else {
        add_grid(models, "nodes", {usual_nodes, 13, 25, 51, 201, 401, 801}, {1 * ms}, {newton});
        add_grid(models, "step", {usual_nodes}, {5 * ms, frame, half_rate, 10 * ms, 2 * ms, 0.5 * ms, 0.2 * ms, 0.1 * ms},
                 {newton});
        add_grid(models, "step", {usual_nodes}, {1 * ms, 2 * ms, 5 * ms, 10 * ms, frame, half_rate, 0.5 * ms, 0.2 * ms, 0.1 * ms},
                 {linearised});
        add_grid(models, "cheap", {13, 25, 51}, {5 * ms, frame, half_rate}, {newton, linearised});
        add_grid(models, "cheap", {201}, {5 * ms, frame}, {newton, linearised});
    }
    add_coaxial(models, scene, quick);
    add_adaptive(models, quick);
    if (touches) {
        add_published(models, scene, quick);
        add_contact_choices(models, scene, quick);
        add_walls(models, scene, quick, walls);
    } else {
        add_swinging(models, quick);
        add_explicit(models, scene.wire, {25});
    }
    if (!quick) {
        if (touches) add_explicit(models, scene.wire, {25});
        else add_explicit(models, scene.wire, {13, 51});
    }
    add_baselines(models, baselines, quick);
    Model single = basis(usual_nodes, 1 * ms), spins = single;
    single.precision = Precision::Float32;
    spins.spin = scene.integrator.spins != Spins::Kept;
    if (touches) models.add("precision", "float32", single);
    models.add("spin", *spins.spin ? "spins kept" : "spins left out", spins);
    return models.take();
}

}  // namespace seldinger
