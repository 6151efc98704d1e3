// seldinger vessel MESH --units mm [--centreline FILE] | SCENE.toml [--json] [--subdivide N] [-o DIR]: what import finds and
// mends, and the mesh as the engine sees it.

#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "io/file_remarks.h"
#include "io/json_text.h"
#include "io/mesh_file.h"
#include "mesh_options.h"
#include "repair/repair.h"
#include "scene/scene.h"
#include "setup/vessel_load.h"
#include "shapes/subdivide.h"
#include "vessel/inlets.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace seldinger::apps {
namespace {

using Json = nlohmann::ordered_json;

struct VesselArguments {
    std::filesystem::path input, dir;
    MeshOptions mesh;
    bool json = false;
    int subdivide = 0;
};

/// @param unit  out
LoadedVessel load(const VesselArguments& options, std::string& unit)
{
    if (options.input.extension() == ".toml") {
        if (const std::string given = options.mesh.first_given(); !given.empty())
            throw Error(ErrorKind::BadScene, given + ": a scene states its own; take it out");
        const Scene scene = read_scene(options.input);
        if (scene.vessel.shape == VesselShape::None)
            throw Error(ErrorKind::BadScene, fmt::format("{}: vessel: the scene has no [vessel]", options.input.string()));
        unit = scene.vessel.units;
        return load_vessel(scene.vessel);
    }
    unit = options.mesh.units;
    if (unit.empty()) unit = remarks_of_file(options.input).units;
    if (unit.empty()) unit = VesselSpec{}.units;
    return options.mesh.load(options.input, unit);
}

Json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json repairs_of(const RepairReport& r)
{
    return {{"vertices_welded", r.vertices_welded},
            {"non_finite_dropped", r.non_finite_dropped},
            {"degenerate_dropped", r.degenerate_dropped},
            {"duplicates_dropped", r.duplicates_dropped},
            {"flipped", r.flipped},
            {"inverted", r.inverted},
            {"hole_loops_closed", r.hole_loops_closed},
            {"non_manifold_edges", r.non_manifold_edges},
            {"boundary_edges", r.boundary_edges},
            {"components", r.components},
            {"slivers", r.slivers},
            {"notes", r.notes}};
}

Json centreline_of(const Centreline& line)
{
    std::vector<double> radius = line.radius;
    std::sort(radius.begin(), radius.end());
    const auto percentile = [&](double p) {
        return radius.empty() ? Json()
                              : Json(radius[static_cast<std::size_t>(p / 100 * static_cast<double>(radius.size() - 1) + 0.5)]);
    };
    std::vector<int> children(line.points.size(), 0);
    for (const int parent : line.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    Json ends = Json::array();
    for (std::size_t i = 0; i < line.points.size(); ++i)
        if (line.parent[i] < 0 || children[i] == 0) ends.push_back(list(line.points[i]));
    return {{"points", line.points.size()},
            {"length_m", line.total_length()},
            {"radius", {{"p5", percentile(5)}, {"p50", percentile(50)}, {"max", percentile(100)}}},
            {"ends", ends}};
}

Json report_of(const LoadedVessel& vessel)
{
    const RepairReport& r = vessel.report;
    Json loops = Json::array(), inlets = Json::array();
    for (const BoundaryLoop& loop : r.loops)
        loops.push_back({{"centre", list(loop.centre)}, {"radius", loop.radius}, {"inward", list(loop.inward)}});
    for (const Inlet& inlet : find_inlets(r.loops, vessel.centreline))
        inlets.push_back({{"point", list(inlet.point)},
                          {"direction", list(inlet.direction)},
                          {"radius", inlet.radius},
                          {"opening", inlet.opening >= 0 ? Json(inlet.opening) : Json()}});
    Json unreached = Json::array();
    for (const Vec3& p : r.unreached) unreached.push_back(list(p));
    return {{"length_unit", "m"},
            {"triangles_read", r.triangles_read},
            {"triangles", r.triangles},
            {"vertices", r.vertices},
            {"repairs", repairs_of(r)},
            {"loops", loops},
            {"centreline", centreline_of(vessel.centreline)},
            {"unreached", unreached},
            {"inlets", inlets}};
}

/// As a scene takes it, and as --json has it.
std::string place(const Json& p)
{
    return fmt::format("[{:.5f}, {:.5f}, {:.5f}] m", p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
}

std::string for_people(const Json& report, const std::string& name)
{
    std::string text = fmt::format("{}: {} triangles read, {} kept, {} vertices\n", name, report["triangles_read"].get<long>(),
                                   report["triangles"].get<long>(), report["vertices"].get<long>());
    for (const Json& note : report["repairs"]["notes"]) text += "  " + note.get<std::string>() + "\n";
    text += fmt::format("  {} openings\n", report["loops"].size());
    const Json& line = report["centreline"];
    if (line["points"].get<long>() > 0)
        text += fmt::format(
            "  centreline {:.4f} m long in all, lumen radius {:.5f} m (5 %), {:.5f} m (median of its points, more in narrow "
            "branches), {:.5f} m (widest)\n",
            line["length_m"].get<double>(), line["radius"]["p5"].get<double>(), line["radius"]["p50"].get<double>(),
            line["radius"]["max"].get<double>());
    int number = 0;
    for (const Json& inlet : report["inlets"])
        text += fmt::format("  inlet {}: {} along [{:.3f}, {:.3f}, {:.3f}], radius {:.5f} m{}\n", ++number, place(inlet["point"]),
                            inlet["direction"][0].get<double>(), inlet["direction"][1].get<double>(),
                            inlet["direction"][2].get<double>(), inlet["radius"].get<double>(),
                            inlet["opening"].is_null() ? " (a closed end)" : "");
    return text;
}

/// All three in the unit of the mesh (mm for a generated shape), so that a scene can name them as they stand.
void write_files(const LoadedVessel& vessel, const std::string& units, const std::filesystem::path& dir)
{
    make_folder(dir);
    write_mesh(dir / "vessel.stl", vessel.mesh, units);
    write_mesh(dir / "vessel.vtp", vessel.mesh, units);
    if (!vessel.centreline.empty()) write_centreline_vtp(dir / "centreline.vtp", vessel.centreline, units);
}

ErrorKind inspect(const VesselArguments& options)
{
    std::string unit;
    LoadedVessel vessel = load(options, unit);
    if (options.subdivide > 0) {
        const long read = vessel.report.triangles_read;
        for (int round = 0; round < options.subdivide; ++round) vessel.mesh = subdivide_loop(vessel.mesh);
        vessel.report = describe(vessel.mesh);
        vessel.report.triangles_read = read;
    }
    Json report = report_of(vessel);
    if (!options.dir.empty()) {
        write_files(vessel, unit, options.dir);
        report["files_unit"] = unit;
    }
    std::string text = options.json ? json_text(report, 2) + "\n"
                                    : for_people(report, printable(options.input.string()));
    if (!options.json && !options.dir.empty())
        text += fmt::format("  {}: vessel.stl, vessel.vtp{} (in {})\n", options.dir.string(),
                            vessel.centreline.empty() ? "" : ", centreline.vtp", unit);
    print(text);
    return ErrorKind::None;
}

}  // namespace

void add_vessel(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<VesselArguments>();
    CommandLine* vessel = app.add_subcommand("vessel", "inspect a vessel mesh, or the vessel of a scene");
    vessel
        ->add_option("INPUT", options->input,
                     "mesh (STL, OBJ, PLY, VTP, VTK), label map (NIfTI, NRRD, MetaImage), or scene file (TOML) or its name")
        ->scene()
        ->type_name("MESH|SCENE.toml")
        ->required();
    options->mesh.add_to(*vessel, "unit of the mesh: m, cm, mm, um or in (default: the one in its header, else mm)");
    vessel->add_flag("--json", options->json, "print one JSON object");
    vessel->add_option("-o", options->dir, "folder for the cleaned mesh and the centreline")->type_name("DIR");
    vessel
        ->add_option("--subdivide", options->subdivide,
                     "rounds of Loop subdivision: each smooths the surface, with four times the triangles")
        ->check(in_range(0, 6))
        ->type_name("N");
    vessel->callback([options, &chosen] { chosen = [options] { return inspect(*options); }; });
}

}  // namespace seldinger::apps
