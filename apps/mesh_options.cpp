// Options of the commands that take a mesh.
#include "mesh_options.h"

#include "core/error.h"

namespace seldinger::apps {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to)
{
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

}  // namespace

void MeshOptions::add_to(CommandLine& command, const std::string& units_help)
{
    command.add_option("--units", units, units_help)->check(one_of({"m", "cm", "mm", "um", "in"}));
    command.add_option("--label", label, "of a label map: number or name of the vessel's (default: the only one)")->type_name("LABEL");
    command.add_option("--centreline", centreline, "polylines with radii, .vtp or .vtk (default: found from the mesh)")
        ->type_name("FILE");
    command
        .add_option("--centreline-units", centreline_units, "unit of --centreline (default: what its header says, else the mesh's)")
        ->check(one_of({"m", "cm", "mm", "um", "in"}));
    command.add_option("--centreline-space", centreline_space, "axes of --centreline: LPS or RAS (default: as with its unit)")
        ->check(one_of({"LPS", "RAS"}));
}

std::string MeshOptions::first_given() const
{
    return !units.empty()              ? "--units"
           : !label.empty()            ? "--label"
           : !centreline.empty()       ? "--centreline"
           : !centreline_units.empty() ? "--centreline-units"
           : !centreline_space.empty() ? "--centreline-space"
                                       : "";
}

LoadedVessel MeshOptions::load(const std::filesystem::path& mesh, const std::string& unit) const
{
    if (const std::string lone = centreline_units + centreline_space; centreline.empty() && !lone.empty())
        throw Error(ErrorKind::BadScene,
                    "--centreline-units, --centreline-space: got no --centreline; expected the file that they are of. Fix: give "
                    "--centreline FILE");
    VesselSpec spec;
    spec.shape = VesselShape::Mesh;
    spec.mesh = std::filesystem::absolute(mesh);
    spec.units = unit;
    spec.label_name = label;
    if (!centreline.empty()) spec.centreline = std::filesystem::absolute(centreline);
    spec.centreline_units = centreline_units;
    spec.centreline_space = centreline_space;
    try {
        return load_vessel(spec);
    } catch (const Error& error) {
        std::string text = error.what();
        replace_all(text, "vessel.centreline", "--centreline");
        for (const std::string word : {"units", "space"})
            replace_all(text, "--centreline_" + word + " = ", "--centreline-" + word + " ");
        throw Error(error.kind(), text);
    }
}

}  // namespace seldinger::apps
