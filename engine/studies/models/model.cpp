// Lays a model over a scene, reads one off a scene, and writes it as words, as --set texts and as reasons why it cannot run.
#include "models/model.h"

#include "core/error.h"
#include "scene/scene_names.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// "file:line:column: key: what" without the place: the text that was read is not the user's.
std::string without_place(const std::string& message, const std::filesystem::path& file)
{
    const std::size_t after_file = message.find(file.string() + ":") == 0 ? file.string().size() + 1 : 0;
    const std::size_t end = message.find(": ", after_file);
    return after_file == 0 || end == std::string::npos ? message : message.substr(end + 2);
}

std::string milliseconds(double seconds) { return fmt::format("{:.4g} ms", 1e3 * seconds); }

/// What a model says of the instruments themselves.
void apply_to_wire(const Model& model, WireSpec& wire, double first_length)
{
    if (model.nodes) {
        const double edges = (*model.nodes - 1) * wire.length / first_length;
        wire.nodes = *model.nodes == 0 ? 0 : std::max(3, static_cast<int>(std::lround(edges)) + 1);
    }
    if (model.min_edge) wire.min_edge = *model.min_edge;
    if (model.max_edge) wire.max_edge = *model.max_edge;
    const auto everywhere = [&](double WireSection::*member, const std::optional<double>& value) {
        if (!value) return;
        wire.shaft.*member = *value;
        for (WireSectionRange& range : wire.sections) range.section.*member = *value;
    };
    everywhere(&WireSection::stretch_stiffness, model.stretch_stiffness);
    everywhere(&WireSection::radius, model.radius);
}

}  // namespace

Scene apply(const Model& model, Scene scene)
{
    for (int k = 0; k < scene.instrument_count(); ++k) apply_to_wire(model, scene.instrument(k).wire, scene.wire.length);
    if (model.coaxial && scene.coaxial) scene.coaxial->model = *model.coaxial;
    if (model.lumen_friction && scene.coaxial) scene.coaxial->lumen_friction = *model.lumen_friction;
    if (model.dt) scene.dt = *model.dt;
    if (model.scheme) scene.integrator.scheme = *model.scheme;
    if (model.trapezoid) scene.integrator.newmark = *model.trapezoid;
    if (model.tolerance) scene.integrator.tolerance = *model.tolerance;
    if (model.spin) scene.integrator.spins = *model.spin ? Spins::Kept : Spins::Auto;
    if (model.detection) scene.contact.detection = *model.detection;
    if (model.normal) scene.contact.normal = *model.normal;
    if (model.friction) scene.contact.friction = *model.friction;
    if (model.rolling) scene.contact.rolling = *model.rolling;
    if (model.elastic_wall) scene.vessel.elastic = *model.elastic_wall;
    choose_wall_youngs(scene);
    if (model.wall_edge) scene.vessel.wall_edge = *model.wall_edge;
    if (model.precision) scene.contact.precision = *model.precision;
    if (model.restitution) scene.contact.restitution = *model.restitution;
    if (model.linear_stiffness) {
        scene.contact.stiffness_from_wall = false;
        scene.contact.stiffness = *model.linear_stiffness;
        scene.contact.exponent = 1;
    }
    if (model.damping_mass) scene.integrator.damping_mass = *model.damping_mass;
    return scene;
}

Model model_of(const Scene& scene)
{
    Model model;
    model.nodes = scene.wire.nodes;
    model.min_edge = scene.wire.min_edge;
    model.max_edge = scene.wire.max_edge;
    model.scheme = scene.integrator.scheme;
    model.tolerance = scene.integrator.tolerance;
    model.spin = scene.integrator.spins == Spins::Kept;
    if (scene.integrator.scheme != Scheme::Static) model.dt = scene.dt, model.trapezoid = scene.integrator.newmark;
    if (scene.coaxial) model.coaxial = scene.coaxial->model, model.lumen_friction = scene.coaxial->lumen_friction;
    if (scene.vessel.shape == VesselShape::None) return model;
    model.detection = scene.contact.detection;
    model.normal = scene.contact.normal;
    model.friction = scene.contact.friction;
    model.rolling = scene.contact.rolling;
    model.elastic_wall = scene.vessel.elastic;
    model.wall_edge = scene.vessel.wall_edge;
    model.precision = scene.contact.precision;
    return model;
}

std::vector<std::string> set_texts(const Model& model, const Scene& scene)
{
    std::vector<std::string> texts;
    const auto set = [&](const std::string& key, auto value) { texts.push_back(fmt::format("{}={}", key, value)); };
    const Scene changed = apply(model, scene);
    for (int k = 0; k < scene.instrument_count(); ++k) {
        const std::string path = scene.label.empty() ? "wire." : fmt::format("instrument.{}.", k);
        const WireSpec& wire = changed.instrument(k).wire;
        if (model.nodes && wire.nodes > 0) set(path + "nodes", wire.nodes);
        if (model.nodes && wire.nodes == 0) set(path + "nodes", "adaptive");
        if (model.min_edge) set(path + "min_edge_m", *model.min_edge);
        if (model.max_edge) set(path + "max_edge_m", *model.max_edge);
        if (model.stretch_stiffness) set(path + "stretch_n", *model.stretch_stiffness);
        if (model.radius) set(path + "radius_m", *model.radius);
    }
    if (model.coaxial && scene.coaxial) set("coaxial.model", word_of(coaxial_words, *model.coaxial));
    if (model.lumen_friction && scene.coaxial) set("coaxial.lumen_friction", *model.lumen_friction);
    if (model.dt) set("scene.dt_s", *model.dt);
    if (model.scheme) set("integrator.scheme", word_of(scheme_words, *model.scheme));
    if (model.trapezoid && *model.trapezoid) set("integrator.beta", 0.25), set("integrator.gamma", 0.5);
    if (model.tolerance) set("integrator.tolerance", *model.tolerance);
    if (model.damping_mass) set("integrator.damping_mass_1_s", *model.damping_mass);
    if (model.spin) set("integrator.spins", word_of(spins_words, *model.spin ? Spins::Kept : Spins::Auto));
    if (scene.vessel.shape == VesselShape::None) return texts;
    if (model.detection) set("contact.detection", word_of(detection_words, *model.detection));
    if (model.normal) set("contact.normal", word_of(normal_words, *model.normal));
    if (model.friction) set("contact.friction", word_of(friction_words, *model.friction));
    if (model.rolling) set("contact.rolling", *model.rolling);
    if (model.elastic_wall) set("vessel.wall", word_of(wall_words, *model.elastic_wall));
    if (model.wall_edge) set("vessel.wall_edge_m", *model.wall_edge);
    if (model.precision) set("contact.precision", word_of(precision_words, *model.precision));
    if (model.restitution) set("contact.restitution", *model.restitution);
    if (model.linear_stiffness) set("contact.stiffness", *model.linear_stiffness), set("contact.exponent", 1);
    return texts;
}

std::string label(const Model& model)
{
    if (!model.name.empty()) return model.name;
    std::string text = model.baseline;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (model.nodes) add(*model.nodes > 0 ? fmt::format("{} nodes", *model.nodes) : "adaptive");
    if (model.min_edge || model.max_edge)
        add(fmt::format("edges {:.3g} to {:.3g} mm", 1e3 * model.min_edge.value_or(WireSpec{}.min_edge),
                        1e3 * model.max_edge.value_or(WireSpec{}.max_edge)));
    if (model.dt) add(milliseconds(*model.dt));
    if (model.scheme) add(std::string(word_of(scheme_words, *model.scheme)));
    if (model.trapezoid) add(*model.trapezoid ? "trapezoid" : "backward Euler");
    if (model.tolerance) add(fmt::format("tolerance {:.0e}", *model.tolerance));
    if (model.detection) add(std::string(word_of(detection_words, *model.detection)));
    if (model.normal) add(std::string(word_of(normal_words, *model.normal)));
    if (model.friction) add(std::string(word_of(friction_words, *model.friction)) + " friction");
    if (model.rolling) add(*model.rolling ? "rolling" : "no rolling");
    if (model.elastic_wall) add(*model.elastic_wall ? "elastic wall" : "rigid wall");
    if (model.wall_edge)
        add(*model.wall_edge > 0 ? fmt::format("wall edge {:.3g} mm", 1e3 * *model.wall_edge) : "wall edge chosen");
    if (model.coaxial) add(std::string(word_of(coaxial_words, *model.coaxial)) + " instruments");
    if (model.coaxial == CoaxialSpec::Model::Merged && model.lumen_friction.value_or(false)) add("lumen friction");
    if (model.precision) add(*model.precision == Precision::Float32 ? "float32" : "float64");
    if (model.restitution) add(fmt::format("restitution {:g}", *model.restitution));
    if (model.linear_stiffness) add(fmt::format("wall {:.3g} N/m^2", *model.linear_stiffness));
    if (model.stretch_stiffness) add(fmt::format("EA {:.3g} N", *model.stretch_stiffness));
    if (model.radius) add(fmt::format("radius {:.3g} mm", 1e3 * *model.radius));
    if (model.damping_mass) add(fmt::format("damping {:.3g} 1/s", *model.damping_mass));
    if (model.spin) add(*model.spin ? "spins kept" : "spins left out");
    return text.empty() ? "as the scene" : text;
}

namespace {

/// What a world of several instruments refuses, which the scene reader does not know (world_check.cpp).
std::string why_not_together(const Scene& scene)
{
    const bool newton = scene.integrator.scheme == Scheme::Newton || scene.integrator.scheme == Scheme::Static;
    const bool merged = scene.coaxial && scene.coaxial->model == CoaxialSpec::Model::Merged;
    const bool touch = scene.instruments_touch || (scene.coaxial && !merged);
    if ((merged || touch) && !newton) return "instruments inside or beside each other take newton or static steps";
    if (touch && scene.contact.precision == Precision::Float32) return "instruments that touch each other take float64";
    if (!merged || scene.vessel.shape == VesselShape::None) return {};
    const Detection detection = scene.contact.detection;
    if (detection != Detection::Swept) return "instruments of one centreline take swept detection";
    return {};
}

}  // namespace

std::string why_not(const Model& model, const Scene& scene)
{
    const bool touches = model.detection || model.normal || model.friction || model.rolling || model.elastic_wall ||
                         model.wall_edge || model.precision;
    if (touches && scene.vessel.shape == VesselShape::None) return "the scene has no vessel to touch";
    if (model.coaxial && !scene.coaxial) return "the scene has no instruments inside each other";
    if (std::string reason = why_not_together(apply(model, scene)); !reason.empty()) return reason;
    try {
        // only the scene reader knows which choices fit together and which are built
        (void)read_scene_text(write_scene(apply(model, scene), scene.source.parent_path()), scene.source);
    } catch (const Error& error) {
        return without_place(error.what(), scene.source);
    }
    return {};
}

}  // namespace seldinger
