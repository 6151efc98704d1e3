// [vessel]: a mesh file or a generated shape, and the wall.
#include "scene/scene_read.h"

#include "core/error.h"
#include "core/printable.h"
#include "scene/toml_parse.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

/// Keys of each shape; required ones come first.
struct ShapeKeys {
    VesselShape shape;
    std::vector<std::string_view> needed, optional;
};

const ShapeKeys& keys_of(VesselShape shape)
{
    static const std::vector<ShapeKeys> all = {
        {VesselShape::Tube, {"radius_m", "length_m"}, {"axis", "origin", "normal", "triangles"}},
        {VesselShape::Arc,
         {"radius_m", "bend_radius_m", "angle_deg"},
         {"lead_in_m", "lead_out_m", "axis", "origin", "normal", "triangles"}},
        {VesselShape::Plane, {"size_m"}, {"origin", "normal", "triangles"}},
        {VesselShape::Arch, {}, {"axis", "origin", "normal", "triangles"}},
        {VesselShape::Mesh, {"mesh"}, {"units"}},
    };
    return *std::find_if(all.begin(), all.end(), [&](const ShapeKeys& k) { return k.shape == shape; });
}

void read_shape_choice(const TableReader& t, Scene& scene)
{
    VesselSpec& vessel = scene.vessel;
    if (t.has("mesh")) {
        t.refuse("shape", "contradicts mesh; give one or the other");
        vessel.shape = VesselShape::Mesh;
        vessel.mesh = existing_file(t, "mesh", scene);
        const int unit = t.word_index("units", unit_words);
        vessel.units = std::string(unit_words[unit < 0 ? 0 : unit]);
        return;
    }
    if (!t.choice("shape", vessel.shape, vessel_words)) t.fail("mesh", "is missing; give mesh = \"file.stl\" or a shape");
}

/// Refuses the keys of other shapes, and needs those of this one.
void check_shape_keys(const TableReader& t, VesselShape shape)
{
    const ShapeKeys& keys = keys_of(shape);
    const std::string owner = shape == VesselShape::Mesh ? "a mesh" : fmt::format("shape = \"{}\"", word_of(vessel_words, shape));
    for (const auto key : {"units", "radius_m", "length_m", "bend_radius_m", "angle_deg", "lead_in_m", "lead_out_m", "size_m",
                           "axis", "origin", "normal", "triangles"}) {
        const auto has = [&](const std::vector<std::string_view>& list) {
            return std::find(list.begin(), list.end(), key) != list.end();
        };
        if (!has(keys.needed) && !has(keys.optional)) t.refuse(key, fmt::format("is not used by {}; take it out", owner));
    }
    for (const auto key : keys.needed) t.need(key, fmt::format("{} needs it", owner));
}

void read_dimensions(const TableReader& t, VesselSpec& vessel)
{
    t.number("radius_m", vessel.radius, positive);
    t.number("length_m", vessel.length, positive);
    t.number("bend_radius_m", vessel.bend_radius, positive);
    double angle_deg = 0;
    if (t.number("angle_deg", angle_deg, {0, 360, true, false, "an angle above 0, at most 360"}))
        vessel.angle = angle_deg * std::numbers::pi / 180;
    t.number("lead_in_m", vessel.lead_in, not_negative);
    t.number("lead_out_m", vessel.lead_out, not_negative);
    t.number("size_m", vessel.size, positive);
    const bool arch = vessel.shape == VesselShape::Arch;  // its branches need some triangles (vessel/aortic_arch.h)
    vessel.triangles = vessel.shape == VesselShape::Mesh ? 0 : arch ? 30'000 : 20'000;
    t.count("triangles", vessel.triangles, arch ? 2'000 : 2, arch ? 1'000'000 : 20'000'000);
    if (vessel.shape == VesselShape::Arc && vessel.bend_radius <= vessel.radius)
        t.fail("bend_radius_m", "expected more than radius_m, or the tube cuts itself");
}

void read_axes(const TableReader& t, VesselSpec& vessel)
{
    t.vector("origin", vessel.origin);
    t.direction("axis", vessel.axis);
    const bool turned = std::abs(vessel.axis.normalized().z()) > 0.9 && vessel.shape != VesselShape::Plane;
    vessel.normal = turned ? Vec3::UnitX() : Vec3::UnitZ();
    t.direction("normal", vessel.normal);
    if (vessel.shape != VesselShape::Plane && vessel.axis.normalized().cross(vessel.normal.normalized()).norm() < 1e-6)
        t.fail("normal", "is parallel to axis; give any other direction");
}

/// Support and loads of an elastic wall.
void read_elastic_wall(const TableReader& t, VesselSpec& vessel)
{
    t.number("support_pa_m", vessel.support, not_negative);
    t.number("support_pa_s_m", vessel.support_damping, not_negative);
    t.number("relaxation_s", vessel.relaxation, not_negative);
    t.number("pressure_pa", vessel.pressure, any_number);
    t.number("wall_edge_m", vessel.wall_edge, not_negative);
    t.choice("rims", vessel.rims_held, rims_words);
    if (!vessel.elastic) return;
    if (vessel.support == 0 && !vessel.rims_held)
        t.fail("support_pa_m",
               "expected more than 0 where rims = \"free\": the wall could fly away; give it tissue, or set rims = "
               "\"held\"");
    const bool has_radius = vessel.shape == VesselShape::Tube || vessel.shape == VesselShape::Arc;
    if (has_radius && vessel.thickness > vessel.radius)
        t.fail("thickness_m",
               fmt::format("expected at most radius_m, {} m, of a wall = \"elastic\", which is a thin shell; make it "
                           "thinner, or set wall = \"rigid\"",
                           vessel.radius));
}

}  // namespace

std::filesystem::path existing_file(const TableReader& t, std::string_view key, const Scene& scene)
{
    std::string written;
    t.text(key, written);
    std::error_code ignored;
    const auto& source = t.node(key)->source().path;
    const std::filesystem::path file = source && !source->starts_with("--set ") ? std::filesystem::path(*source) : scene.source;
    const std::filesystem::path joined = std::filesystem::absolute(file, ignored).parent_path() / written;
    std::filesystem::path path = std::filesystem::weakly_canonical(joined, ignored);
    if (path.empty()) path = joined;  // too long for a name, or links that go round in a circle
    if (!std::filesystem::is_regular_file(path, ignored)) {
        try {
            const bool escaped = written.find_first_of("\b\t\n\f\r\x1b") != std::string::npos;
            const char* advice = escaped || written.find('\\') != std::string::npos ? backslash_advice : "check the path (relative to the scene file)";
            t.fail(key, fmt::format("no file at {}; {}", printable(path.string()), advice));
        } catch (const Error& error) {
            throw Error(ExitCode::BadFile, error.what());
        }
    }
    return path;
}

void read_vessel_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "vessel", {"mesh",         "units",       "shape",       "radius_m",      "length_m",
                                          "axis",         "origin",      "normal",      "bend_radius_m", "angle_deg",
                                          "lead_in_m",    "lead_out_m",  "size_m",      "triangles",     "wall",
                                          "youngs_pa",    "poisson",     "thickness_m", "support_pa_m",  "support_pa_s_m",
                                          "relaxation_s", "pressure_pa", "wall_edge_m", "rims",          "centreline"});
    VesselSpec& vessel = scene.vessel;
    read_shape_choice(t, scene);
    check_shape_keys(t, vessel.shape);
    read_dimensions(t, vessel);
    read_axes(t, vessel);
    t.choice("wall", vessel.elastic, wall_words);
    vessel.youngs_given = t.has("youngs_pa");
    t.number("youngs_pa", vessel.youngs, positive);
    t.number("poisson", vessel.poisson, {0, 0.5, false, true, "a Poisson's ratio from 0 to below 0.5"});  // D6: 1 - 2 nu > 0
    t.number("thickness_m", vessel.thickness, positive);
    read_elastic_wall(t, vessel);
    if (t.has("centreline")) vessel.centreline = existing_file(t, "centreline", scene);
}

}  // namespace seldinger
