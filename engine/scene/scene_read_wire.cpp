// Properties, sections and placement of an instrument ([wire], [[instrument]]).
#include "scene/scene_read.h"

#include "contact/quadrature.h"
#include "core/error.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Properties that the wire and its sections share; an absent one keeps its value (a section inherits the shaft's).
void read_properties(const TableReader& t, WireSection& s)
{
    t.number("radius_m", s.radius, positive);
    t.number("density", s.density, positive);
    for (const auto key : {"bend_nm2", "twist_nm2", "stretch_n"})
        if (t.has("youngs_pa")) t.refuse(key, "contradicts youngs_pa; give a material or the three stiffnesses, not both");
    t.number("youngs_pa", s.youngs, positive);
    if (s.youngs == 0) t.refuse("poisson", "needs youngs_pa; add it or take poisson out");
    t.number("poisson", s.poisson, poisson_range);
    // an inherited material follows this section's radius, and a stiffness given here wins over it
    if (s.youngs > 0) set_stiffness_from_material(s);
    t.number("bend_nm2", s.bend_stiffness, positive);
    t.number("twist_nm2", s.twist_stiffness, positive);
    t.number("stretch_n", s.stretch_stiffness, positive);
    t.number("mu_static", s.mu_static, friction_range);
    t.number("mu_sliding", s.mu_sliding, friction_range);
    check_friction(t, s.mu_static, s.mu_sliding);
}

/// A wire cannot need less force to start sliding than to go on: a mu_static that nobody gave here is raised to mu_sliding, and
/// whatever is written says so. One that was given is refused (check_friction).
void order_friction(double& mu_static, double mu_sliding, const std::string& where, Scene& scene)
{
    if (mu_static >= mu_sliding) return;
    note_raised_friction(scene, where, mu_static, mu_sliding);
    mu_static = mu_sliding;
}

/// Contact is looked for once a radius: a key given too small makes more places than there is memory for. The vessel has been read.
void check_slender(const TableReader& t, const Scene& scene, double length, double radius)
{
    if (scene.vessel.shape != VesselShape::None && length > most_slender * radius)
        t.fail("radius_m", fmt::format("{} m is thinner than {:g} to the wire's length, {} m; check the units (metres)", radius,
                                       1 / most_slender, length));
}

void read_section(const toml::table& table, const std::string& path, WireSpec& wire, Scene& scene)
{
    const TableReader t(table, path,
                        {"from_tip_m", "radius_m", "density", "youngs_pa", "poisson", "bend_nm2", "twist_nm2", "stretch_n",
                         "mu_static", "mu_sliding", "rest_curvature_1_m"});
    WireSectionRange range;
    range.section = wire.shaft;
    t.need("from_tip_m", "the stretch [from, to] in metres from the tip");
    const toml::array* ends = t.node("from_tip_m")->as_array();
    if (!ends || ends->size() != 2 || !(*ends)[0].is_number() || !(*ends)[1].is_number())
        t.fail("from_tip_m", "expected [from, to] in metres from the tip");
    range.begin = *(*ends)[0].value<double>();
    range.end = *(*ends)[1].value<double>();
    if (!(range.begin >= 0 && range.begin < range.end && range.end <= wire.length))
        t.fail("from_tip_m", fmt::format("expected 0 <= from < to <= the wire's length, {} m", wire.length));
    read_properties(t, range.section);
    check_slender(t, scene, wire.length, range.section.radius);
    if (t.has("rest_curvature_1_m")) {
        const toml::array* k = t.node("rest_curvature_1_m")->as_array();
        for (std::size_t i = 0; i < 2; ++i) {
            const auto value = k && k->size() == 2 && (*k)[i].is_number() ? (*k)[i].value<double>() : std::nullopt;
            if (!value || !std::isfinite(*value)) t.fail("rest_curvature_1_m", "expected two numbers [k1, k2] in 1/m");
            range.section.rest_curvature[i] = *value;
        }
    }
    order_friction(range.section.mu_static, range.section.mu_sliding, path, scene);
    wire.sections.push_back(range);
}

constexpr double most_placed_strain = 0.4;  // edges that change by half are torn (rod/no_state.h)

/// bend_scale: bending stiffness of the shaft and all sections, and twisting stiffness with it.
void scale_stiffness(const TableReader& t, WireSpec& wire)
{
    double scale = 1;
    t.number("bend_scale", scale, positive);
    const auto apply = [scale](WireSection& s) { s.bend_stiffness *= scale, s.twist_stiffness *= scale; };
    apply(wire.shaft);
    for (WireSectionRange& range : wire.sections) apply(range.section);
}

void read_points(const TableReader& t, WireSpec& wire)
{
    std::vector<std::vector<double>> rows;
    t.need("points", "shape = \"points\" follows them from base to tip");
    t.rows("points", rows, 3, 2, "[x, y, z]");
    double length = 0;
    for (const auto& row : rows) {
        const Vec3 p(row[0], row[1], row[2]);
        const double step = wire.place.points.empty() ? 1.0 : (p - wire.place.points.back()).norm();
        if (!(step > 0)) t.fail("points", "expected no point twice in a row; take the second one out");
        if (!wire.place.points.empty()) length += step;
        wire.place.points.push_back(p);
    }
    // chords are shorter than their arc; more than this is a wire placed under strain
    if (!wire.place.stretched && std::abs(length - wire.length) > 0.05 * wire.length)
        t.fail("points",
               fmt::format("the points are {:.6g} m long, the wire {:.6g} m; expected the same within 5 %. Fix: other points, or stretch = "
                           "\"as-placed\" for a wire that is under tension",
                           length, wire.length));
    if (wire.place.stretched && std::abs(length / wire.length - 1) > most_placed_strain)
        t.fail("points", fmt::format("the points are {:.6g} m long, the wire {:.6g} m: a strain of {:.3g}; expected at most {}. Fix: length_m is "
                                     "the length without stress",
                                     length, wire.length, length / wire.length - 1, most_placed_strain));
}

/// The first director of a wire whose scene gives none: z, or x for a wire along z.
Vec3 default_normal(const Vec3& direction) { return std::abs(direction.normalized().z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX(); }

void read_place(const toml::table& table, const std::string& path, WireSpec& wire)
{
    const TableReader t(table, path, {"shape", "base", "direction", "normal", "bend_radius_m", "twist_rad", "points", "from_m", "stretch"});
    WirePlacement& place = wire.place;
    t.choice("shape", place.shape, place_words);
    t.vector("base", place.base);
    t.direction("direction", place.direction);
    place.normal = default_normal(place.direction);
    t.direction("normal", place.normal);

    const std::string shape(word_of(place_words, place.shape));
    auto only_for = [&](std::string_view key, PlaceShape owner) {
        if (place.shape != owner) t.refuse(key, fmt::format("is not used by shape = \"{}\"; take it out", shape));
    };
    only_for("bend_radius_m", PlaceShape::Arc);
    only_for("twist_rad", PlaceShape::Ring);
    only_for("points", PlaceShape::Points);
    only_for("stretch", PlaceShape::Points);
    only_for("from_m", PlaceShape::Centreline);
    if (place.shape == PlaceShape::Points || place.shape == PlaceShape::Centreline)
        for (const auto key : {"base", "direction"})
            t.refuse(key, fmt::format("follows from shape = \"{}\"; take it out", shape));
    else if (place.direction.normalized().cross(place.normal.normalized()).norm() < 1e-6)
        t.fail("normal", "is parallel to direction; give any other direction");

    if (place.shape == PlaceShape::Arc) t.need("bend_radius_m", "the radius of the circle that the wire follows");
    t.number("bend_radius_m", place.bend_radius, positive);
    t.number("twist_rad", place.twist, any_number);
    t.number("from_m", place.from, not_negative);
    t.choice("stretch", place.stretched, stretch_words);
    if (place.shape == PlaceShape::Points) read_points(t, wire);
}

void read_nodes(const TableReader& t, WireSpec& wire)
{
    wire.nodes = 101;
    const toml::node* nodes = t.node("nodes");
    if (nodes && nodes->is_string()) {
        if (nodes->value<std::string>() != "adaptive") t.fail("nodes", "expected a whole number or \"adaptive\"");
        wire.nodes = 0;
    } else {
        t.count("nodes", wire.nodes, 3, 200'000);
    }
    t.number("min_edge_m", wire.min_edge, positive);
    t.number("max_edge_m", wire.max_edge, positive);
    t.number("edge_error_m", wire.edge_error, positive);
    if (wire.nodes == 0 && wire.min_edge >= wire.max_edge)
        t.fail("min_edge_m", fmt::format("expected less than max_edge_m, {} m", wire.max_edge));
    if (wire.nodes == 0 && wire.length / wire.min_edge > 200'000)
        t.fail("min_edge_m",
               fmt::format("makes up to {:.3g} nodes, expected at most 200000; make it longer", wire.length / wire.min_edge));
}

/// A fed wire starts straight and at rest at the inlet: what places another wire contradicts [feed].
void refuse_placement(const TableReader& t)
{
    for (const auto key : {"place", "velocity_m_s", "spin_rad_s"})
        t.refuse(key, "a fed wire starts at rest at the inlet; take this or [feed] out");
    if (t.node("rest") && t.node("rest")->value<std::string>() == "placed")
        t.fail("rest", "a fed wire is not placed; use rest_curvature_1_m in [[wire.section]], or take [feed] out");
}

/// Where it is at first, how it moves there and what shape is free of stress.
void read_start(const TableReader& t, const std::string& path, bool fed, WireSpec& wire)
{
    if (fed) refuse_placement(t);
    t.choice("rest", wire.place.rest_is_placed, rest_words);
    t.vector("velocity_m_s", wire.place.velocity);
    t.number("spin_rad_s", wire.place.spin_rate, any_number);
    if (const toml::node* place = t.node("place")) {
        if (!place->is_table()) t.fail("place", "expected { shape = \"straight\", base = [x, y, z], ... }");
        read_place(*place->as_table(), path + ".place", wire);
    }
}

/// The wall of a catheter has some thickness everywhere.
void check_lumen(const TableReader& t, WireSpec& wire)
{
    double lumen = 0, thinnest = wire.shaft.radius;
    t.number("lumen_radius_m", lumen, not_negative);
    for (const WireSectionRange& range : wire.sections) thinnest = std::min(thinnest, range.section.radius);
    if (lumen >= thinnest) t.fail("lumen_radius_m", fmt::format("expected less than the smallest outer radius, {} m", thinnest));
    wire.lumen_radius = lumen;
}

}  // namespace

void check_friction(const TableReader& t, double mu_static, double mu_sliding)
{
    if (t.has("mu_static") && mu_static < mu_sliding)
        t.fail("mu_static", fmt::format("is {}, below mu_sliding, {}: a wire cannot need less force to start sliding than to continue; "
                                        "make it {} or more, or take it out",
                                        mu_static, mu_sliding, mu_sliding));
}

void note_raised_friction(Scene& scene, const std::string& where, double mu_static, double mu_sliding)
{
    const std::string key = where + ".mu_static";
    const std::string what = fmt::format("{} (raised from {}: not below mu_sliding, and not given)", mu_sliding, mu_static);
    scene.notes.emplace_back(key, what);
    scene.warnings.push_back(key + " is " + what);
}

void read_wire_table(const toml::table& table, const std::string& path, std::initializer_list<std::string_view> extra, bool fed,
                     SceneInstrument& into, Scene& scene)
{
    std::vector<std::string_view> keys = {
        "length_m", "radius_m",     "density",    "nodes",     "min_edge_m",     "max_edge_m", "edge_error_m", "youngs_pa",
        "poisson",  "bend_nm2",     "twist_nm2",  "stretch_n", "mu_static",      "mu_sliding", "curvature",    "place",
        "rest",     "velocity_m_s", "spin_rad_s", "section",   "lumen_radius_m", "preset",   "bend_scale"};
    keys.insert(keys.end(), extra);
    const TableReader t(table, path, keys);
    WireSpec& wire = into.wire;
    for (const auto key : {"length_m", "radius_m", "density"}) t.need(key);
    if (!t.has("youngs_pa"))
        for (const auto key : {"bend_nm2", "twist_nm2", "stretch_n"})
            t.need(key, "stiffness is youngs_pa and poisson, or bend_nm2, twist_nm2 and stretch_n");
    t.number("length_m", wire.length, positive);
    order_friction(scene.contact.mu_static, scene.contact.mu_sliding, "contact", scene);
    wire.shaft.mu_static = scene.contact.mu_static;
    wire.shaft.mu_sliding = scene.contact.mu_sliding;
    read_properties(t, wire.shaft);
    order_friction(wire.shaft.mu_static, wire.shaft.mu_sliding, path, scene);
    if (wire.shaft.radius * 2 > wire.length)
        t.fail("radius_m", "expected a wire longer than it is thick; check the units (metres)");
    check_slender(t, scene, wire.length, wire.shaft.radius);
    read_nodes(t, wire);
    t.choice("curvature", wire.curvature, curvature_words);
    read_start(t, path, fed, wire);
    for_each_table(table, "section", path + ".section",
                   [&](const toml::table& section, const std::string& where) { read_section(section, where, wire, scene); });
    scale_stiffness(t, wire);
    check_lumen(t, wire);
}

}  // namespace seldinger
