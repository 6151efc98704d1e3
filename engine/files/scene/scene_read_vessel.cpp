// [vessel]: a mesh file or a generated shape, and the wall.
#include "scene/scene_read.h"

#include <fmt/format.h>
#include <cmath>

namespace seldinger {
namespace {

/// A mesh, or one of the shapes with its own defaults.
void read_shape(const TableReader& t, VesselSpec& vessel)
{
    if (t.has("mesh")) t.refuse("shape", "contradicts mesh; give one or the other");
    else if (!t.has("shape")) t.fail("mesh", "is missing; give mesh = \"file.stl\" or a shape");
    const keys::Words shape = keys::words(vessel.shape, vessel_words);
    if (t.has("mesh")) vessel.shape = VesselShape::Mesh;
    else shape.set(t.word_index("shape", shape.list));
    const bool mesh = vessel.shape == VesselShape::Mesh;
    vessel.triangles = mesh ? 0 : vessel.shape == VesselShape::Arch ? 30'000 : 20'000;
    if (t.has("centreline")) vessel.centreline = "given";  // until it is read: it has keys of its own
    for (const char* key : {"centreline_units", "centreline_space"})
        if (mesh && t.has(key) && vessel.centreline.empty()) t.fail(key, "is of a given centreline; give vessel.centreline, or take it out");
    const std::string owner = mesh ? "a mesh" : fmt::format("shape = \"{}\"", word_of(vessel_words, vessel.shape));
    t.refuse_unused(keys::vessel(vessel), fmt::format("is not used by {}; take it out", owner));
}

void check_axes(const TableReader& t, VesselSpec& vessel)
{
    const bool turned = std::abs(vessel.axis.normalized().z()) > 0.9 && vessel.shape != VesselShape::Plane;
    if (!t.has("normal")) vessel.normal = turned ? Vec3::UnitX() : Vec3::UnitZ();
    if (vessel.shape != VesselShape::Plane && vessel.axis.normalized().cross(vessel.normal.normalized()).norm() < 1e-6)
        t.fail("normal", "is parallel to axis; give any other direction");
}

void check_elastic_wall(const TableReader& t, const VesselSpec& vessel)
{
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

void read_vessel_table(const toml::table& table, Scene& scene)
{
    VesselSpec& vessel = scene.vessel;
    const TableReader t(table, "vessel", keys::vessel(vessel));
    read_shape(t, vessel);
    t.read(keys::vessel(vessel), scene.source);
    vessel.youngs_given = t.has("youngs_pa");
    if (vessel.shape == VesselShape::Arc && vessel.bend_radius <= vessel.radius)
        t.fail("bend_radius_m", "expected more than radius_m, or the tube cuts itself");
    check_axes(t, vessel);
    check_elastic_wall(t, vessel);
}

}  // namespace seldinger
