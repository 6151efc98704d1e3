// Properties, sections and placement of an instrument ([wire], [[instrument]]).
#include "scene/scene_read.h"
#include "scene/scene_tables.h"

#include "contact/quadrature.h"
#include "core/error.h"
#include "world/setup_check.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Properties that the wire and its sections share; an absent one keeps its value (a section inherits the shaft's).
void read_properties(const TableReader& t, const std::vector<Key>& keys, const std::string& path, WireSection& s, Scene& scene)
{
    for (const auto key : keys::stiffness)
        if (t.has("youngs_pa"))
            t.refuse(key, "contradicts youngs_pa; give a material or the three stiffnesses, not both. "
                          "Fix: with a preset that has stiffnesses, set bend_scale");
    if (s.youngs == 0 && !t.has("youngs_pa")) t.refuse("poisson", "needs youngs_pa; add it or take poisson out");
    t.read(keys);
    // an inherited material follows this section's radius, and a stiffness given here wins over it
    WireSection solid = s;
    set_stiffness_from_material(solid);
    if (s.youngs > 0 && !t.has("bend_nm2")) s.bend_stiffness = solid.bend_stiffness;
    if (s.youngs > 0 && !t.has("twist_nm2")) s.twist_stiffness = solid.twist_stiffness;
    if (s.youngs > 0 && !t.has("stretch_n")) s.stretch_stiffness = solid.stretch_stiffness;
    order_friction(t, path, s.mu_static, s.mu_sliding, scene);
}

/// Contact is looked for once a radius: a key given too small makes more places than there is memory for. The vessel has been
/// read.
void check_slender(const TableReader& t, const Scene& scene, double length, double radius)
{
    if (scene.vessel.shape != VesselShape::None && length > most_slender * radius)
        t.fail("radius_m", fmt::format("{} m is thinner than {:g} to the wire's length, {} m; check the units (metres)", radius,
                                       1 / most_slender, length));
}

/// A table of measured stiffness and where it counts [m].
struct Measured {
    BendTable table;
    double begin, end;
};

std::filesystem::path bend_table_of(const TableReader& t, const Scene& scene)
{
    std::filesystem::path file;
    t.read({Key{"bend_table", "", &file, ""}}, scene.source);
    return file;
}

/// Properties that a table gives and the shaft does not: as in the last row.
void complete_shaft(const BendTable& table, WireSection& shaft)
{
    for (const auto& [value, column] :
         {std::pair(&shaft.bend_stiffness, &table.bend), std::pair(&shaft.twist_stiffness, &table.twist),
          std::pair(&shaft.stretch_stiffness, &table.stretch)})
        if (*value == 0 && !column->empty()) *value = column->back();
}

void need_stiffness(const TableReader& t, const Scene& scene)
{
    BendTable table;
    if (const std::filesystem::path file = bend_table_of(t, scene); !file.empty()) table = read_bend_table(file, INFINITY);
    const std::vector<double>* columns[] = {&table.bend, &table.twist, &table.stretch};
    for (std::size_t k = 0; k < std::size(columns); ++k)
        if (columns[k]->empty())
            t.need(keys::stiffness[k],
                   "stiffness is youngs_pa and poisson, or bend_nm2, twist_nm2 and stretch_n (or bend_table)");
}

void read_section(const toml::table& table, const std::string& path, WireSpec& wire, Scene& scene,
                  std::vector<Measured>& measured)
{
    WireSectionRange& range = wire.sections.emplace_back();
    range.section = wire.shaft;
    const TableReader t(table, path, keys::section(range));
    read_properties(t, keys::section(range), path, range.section, scene);
    if (!(range.begin >= 0 && range.begin < range.end && range.end <= wire.length))
        t.fail("from_tip_m", fmt::format("expected 0 <= from < to <= the wire's length, {} m", wire.length));
    check_slender(t, scene, wire.length, range.section.radius);
    if (const std::filesystem::path file = bend_table_of(t, scene); !file.empty())
        measured.push_back({read_bend_table(file, wire.length), range.begin, range.end});
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

void check_points(const TableReader& t, const WireSpec& wire)
{
    const std::vector<Vec3>& points = wire.place.points;
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
        const double step = (points[i] - points[i - 1]).norm();
        if (!(step > 0)) t.fail("points", "expected no point twice in a row; take the second one out");
        length += step;
    }
    // chords are shorter than their arc; more than this is a wire placed under strain
    if (!wire.place.stretched && std::abs(length - wire.length) > 0.05 * wire.length)
        t.fail(
            "points",
            fmt::format(
                "the points are {:.6g} m long, the wire {:.6g} m; expected the same within 5 %. Fix: other points, or stretch = "
                "\"as-placed\" for a wire that is under tension",
                length, wire.length));
    if (wire.place.stretched && std::abs(length / wire.length - 1) > most_placed_strain)
        t.fail("points",
               fmt::format(
                   "the points are {:.6g} m long, the wire {:.6g} m: a strain of {:.3g}; expected at most {}. Fix: length_m is "
                   "the length without stress",
                   length, wire.length, length / wire.length - 1, most_placed_strain));
}

/// The first director of a wire whose scene gives none: z, or x for a wire along z.
Vec3 default_normal(const Vec3& direction) { return std::abs(direction.normalized().z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX(); }

void read_place(const toml::table& table, const std::string& path, WireSpec& wire)
{
    WirePlacement& place = wire.place;
    const TableReader t(table, path, keys::place(place));
    const keys::Words shape = keys::words(place.shape, place_words);
    if (t.has("shape")) shape.set(t.word_index("shape", shape.list));
    const bool is_based = place.shape != PlaceShape::Points && place.shape != PlaceShape::Centreline;
    for (const auto key : {"base", "direction"})
        if (!is_based) t.refuse(key, fmt::format("follows from shape = \"{}\"; take it out", word_of(place_words, place.shape)));
    t.refuse_unused(keys::place(place),
                    fmt::format("is not used by shape = \"{}\"; take it out", word_of(place_words, place.shape)));
    if (place.shape == PlaceShape::Arc) t.need("bend_radius_m", "the radius of the circle that the wire follows");
    if (place.shape == PlaceShape::Points) t.need("points", "shape = \"points\" follows them from base to tip");
    t.read(keys::place(place));
    if (!t.has("normal")) place.normal = default_normal(place.direction);
    if (is_based && place.direction.normalized().cross(place.normal.normalized()).norm() < 1e-6)
        t.fail("normal", "is parallel to direction; give any other direction");
    if (place.shape == PlaceShape::Points) check_points(t, wire);
}

void check_nodes(const TableReader& t, const WireSpec& wire)
{
    if (wire.nodes == 0 && wire.min_edge >= wire.max_edge)
        t.fail("min_edge_m", fmt::format("expected less than max_edge_m, {} m", wire.max_edge));
    if (wire.nodes == 0 && wire.length / wire.min_edge > keys::most_nodes)
        t.fail("min_edge_m", fmt::format("makes up to {:.3g} nodes, expected at most {}; make it longer",
                                         wire.length / wire.min_edge, keys::most_nodes));
}

/// A fed wire starts straight and at rest at the inlet: what places another wire contradicts [feed].
void refuse_placement(const TableReader& t)
{
    for (const auto key : {"place", "velocity_m_s", "spin_rad_s"})
        t.refuse(key, "a fed wire starts at rest at the inlet; take this or [feed] out");
    if (t.node("rest") && t.node("rest")->value<std::string>() == "placed")
        t.fail("rest", "a fed wire is not placed; use rest_curvature_1_m in [[wire.section]], or take [feed] out");
}

/// The wall of a catheter has some thickness everywhere.
void check_lumen(const TableReader& t, const WireSpec& wire)
{
    if (wire.lumen_radius >= wire.least_radius())
        t.fail("lumen_radius_m", fmt::format("expected less than the smallest outer radius, {} m", wire.least_radius()));
}

}  // namespace

void order_friction(const TableReader& t, const std::string& path, double& mu_static, double mu_sliding, Scene& scene)
{
    if (friction_in_order(mu_static, mu_sliding)) return;
    if (t.has("mu_static"))
        t.fail("mu_static",
               fmt::format("is {}, below mu_sliding, {}: a wire cannot need less force to start sliding than to continue; "
                           "make it {} or more, or take it out",
                           mu_static, mu_sliding, mu_sliding));
    const std::string key = path + ".mu_static";
    const std::string what = fmt::format("{} (raised from {}: not below mu_sliding, and not given)", mu_sliding, mu_static);
    scene.notes.emplace_back(key, what);
    scene.warnings.push_back(key + " is " + what);
    mu_static = mu_sliding;
}

void read_wire_table(const toml::table& table, const std::string& path, bool fed, SceneInstrument& into, Scene& scene)
{
    WireSpec& wire = into.wire;
    wire.nodes = 101;
    wire.shaft.mu_static = scene.contact.mu_static;
    wire.shaft.mu_sliding = scene.contact.mu_sliding;
    const TableReader t(table, path, keys::wire(into));
    if (fed) refuse_placement(t);
    if (!t.has("youngs_pa")) need_stiffness(t, scene);
    read_properties(t, keys::wire(into), path, wire.shaft, scene);
    if (wire.shaft.radius * 2 > wire.length)
        t.fail("radius_m", "expected a wire longer than it is thick; check the units (metres)");
    check_slender(t, scene, wire.length, wire.shaft.radius);
    check_nodes(t, wire);
    if (const toml::node* place = t.node("place")) {
        if (!place->is_table()) t.fail("place", "expected { shape = \"straight\", base = [x, y, z], ... }");
        read_place(*place->as_table(), path + ".place", wire);
    }
    std::vector<Measured> measured;
    if (const std::filesystem::path file = bend_table_of(t, scene); !file.empty()) {
        measured.push_back({read_bend_table(file, wire.length), 0, wire.length});
        complete_shaft(measured.front().table, wire.shaft);
    }
    for_each_table(table, "section", path + ".section", [&](const toml::table& section, const std::string& where) {
        read_section(section, where, wire, scene, measured);
    });
    for (const Measured& own : measured) take_bend_table(own.table, own.begin, own.end, wire);
    scale_stiffness(t, wire);
    check_lumen(t, wire);
}

}  // namespace seldinger
