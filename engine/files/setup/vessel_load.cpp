// A vessel from its description.
#include "setup/vessel_load.h"

#include "core/error.h"
#include "engine.h"
#include "io/file_remarks.h"
#include "io/mesh_file.h"
#include "repair/repair.h"
#include "setup/centreline_check.h"
#include "setup/vessel_cache.h"
#include "shapes/aortic_arch.h"
#include "shapes/shapes.h"
#include "vessel/extract_centreline.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace seldinger {
namespace {

LoadedVessel generated(GeneratedVessel shape)
{
    LoadedVessel vessel{std::move(shape.mesh), {}, std::move(shape.centreline)};
    vessel.report = describe(vessel.mesh);
    return vessel;
}

// A tenth of what a 0.035 inch wire's own weight sinks into a wall of 1 MPa [m].
constexpr double felt_rounding = 5e-8;

std::string describe_rounding(double rounding)
{
    return fmt::format(
        "The file holds float32 numbers, rounded by up to {:.2g} um this far from its origin, which contact forces "
        "feel; store it nearer to its origin, or with doubles (.vtp, .ply, .obj).",
        1e6 * rounding);
}

std::string describe_remarks(const FileRemarks& remarks, const std::string& units)
{
    std::string text;
    if (remarks.axes != FileAxes::Unsaid && !remarks.by_format)
        text = remarks.axes == FileAxes::Ras ? "The file says SPACE=RAS: x to the patient's right, y to the front, z to the head."
                                             : "The file says SPACE=LPS: x to the patient's left, y to the back, z to the head.";
    if (!remarks.units.empty() && remarks.units != units)
        text +=
            fmt::format("{}The file says that its unit is {}; it was read in {}.", text.empty() ? "" : " ", remarks.units, units);
    return text;
}

Centreline found_centreline(LoadedVessel& vessel)
{
    try {
        CentrelineGaps gaps;
        Centreline line =
            extract_centreline(vessel.mesh, vessel.report.loops, LumenQuery(vessel.mesh, vessel.report.loops), &gaps);
        vessel.report.unreached = std::move(gaps.unreached);
        if (gaps.side_by_side > 0)
            vessel.report.notes.push_back(
                "The lumen is flat in long stretches, as the two lumens of a dissection are: one path along each is its axis, "
                "others beside it are "
                "left out.");
        return line;
    } catch (const Error& error) {
        throw Error(error.kind(),
                    fmt::format("{}. Fix: remesh it evenly, or give an axis of your own with vessel.centreline", error.what()));
    }
}

LoadedVessel prepare(const VesselSpec& spec, std::string bytes)
{
    LoadedVessel vessel;
    MeshFileFacts facts;
    vessel.mesh = parse_mesh(bytes, spec.mesh, spec.units, &facts, spec.label_text());
    const std::string remarks = describe_remarks(remarks_in(bytes, spec.mesh), spec.units);
    bytes = {};  // as much memory as the mesh
    try {
        vessel.report = repair(vessel.mesh, spec.close_holes);
        vessel.report.notes.insert(vessel.report.notes.begin(), facts.notes.begin(), facts.notes.end());
        if (!remarks.empty()) vessel.report.notes.push_back(remarks);
        if (facts.rounding > felt_rounding) vessel.report.notes.push_back(describe_rounding(facts.rounding));
        if (spec.centreline.empty()) {
            vessel.centreline = found_centreline(vessel);
            check_found_centreline(vessel);
        }
    } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("{}: {}", spec.mesh.string(), error.what()));
    }
    return vessel;
}

LoadedVessel from_file(const VesselSpec& spec)
{
    std::string bytes = read_mesh_bytes(spec.mesh, spec.units);
    std::string key;
    std::optional<LoadedVessel> vessel;
    if (vessel_cache_limit() > 0) {
        std::string kind = spec.mesh.extension().string() + (spec.close_holes ? "" : ", holes open");
        if (const std::string label = spec.label_text(); !label.empty()) kind += ", label " + label;
        key = vessel_key(bytes, kind, spec.units, spec.centreline.empty());
        vessel = find_prepared(key);
    }
    if (!vessel) {
        vessel = prepare(spec, std::move(bytes));
        keep_prepared(key, *vessel);
    }
    if (!spec.centreline.empty()) read_given_centreline(spec, *vessel);
    return std::move(*vessel);
}

}  // namespace

LoadedVessel load_vessel(const VesselSpec& spec)
{
    switch (spec.shape) {
        case VesselShape::None: return {};
        case VesselShape::Mesh: return from_file(spec);
        case VesselShape::Tube: return generated(make_tube(spec));
        case VesselShape::Arc: return generated(make_arc(spec));
        case VesselShape::Plane: return generated(make_plane(spec));
        case VesselShape::Arch: return generated(make_aortic_arch(spec));
    }
    throw Error(ErrorKind::BadScene, "vessel.shape: unknown value");
}

std::string describe_thick_wall(const VesselSpec& spec, const Centreline& centreline)
{
    const auto narrowest = std::min_element(centreline.radius.begin(), centreline.radius.end());
    if (!spec.elastic || narrowest == centreline.radius.end() || *narrowest >= spec.thickness) return {};
    const Vec3& at = centreline.points[static_cast<std::size_t>(narrowest - centreline.radius.begin())];
    return fmt::format(
        "the lumen narrows to a radius of {:.3g} mm near [{:.4g}, {:.4g}, {:.4g}] m, in a wall of {:.3g} mm: that is not a "
        "thin shell, and a wire cannot open it there; make vessel.thickness_m smaller, or set vessel.wall = "
        "\"rigid\"",
        1e3 * *narrowest, at.x(), at.y(), at.z(), 1e3 * spec.thickness);
}

std::string describe_coarse_wall(const WallMechanics& wall, const VesselSpec& spec)
{
    if (wall.vertices == 0 || !(wall.edge_touched > wall.decay)) return {};
    const WallMeshBand band = wall_mesh_band(wall.edge_touched, wall.decay, spec.shape == VesselShape::Plane);
    const auto share = [](double of) {
        return of < 0.9 ? fmt::format("about {:.0f} %", 1e2 * of) : std::string("more than 90 %");
    };
    const double fine = 0.5 * wall.decay;
    return fmt::format(
        "vessel.wall_edge_m: got control edges of {:.3g} mm where instruments touch, {:.2g} decay lengths; expected at most one "
        "decay "
        "length of {:.3g} mm. Displacement then reads up to {} too low and stress up to {} too low. Fix: {}",
        1e3 * wall.edge_touched, wall.edge_touched / wall.decay, 1e3 * wall.decay, share(band.move), share(0.5 * band.stress),
        spec.wall_edge > 0 ? fmt::format("leave vessel.wall_edge_m out, or set it to {:.2g}", fine)
                           : fmt::format("vessel.wall_edge_m = {:.2g}", fine));
}

void load_vessel(WorldSetup& setup)
{
    LoadedVessel vessel = load_vessel(setup.vessel);
    setup.mesh = std::move(vessel.mesh);
    setup.centreline = std::move(vessel.centreline);
}

}  // namespace seldinger
