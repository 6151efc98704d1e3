// seldinger init MESH [-o scene.toml] [--units mm] [--centreline FILE] [--inlet N] [--instrument NAME] [--overwrite]: a first scene
// for the user's own mesh, and a picture of its inlets.

#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "io/file_remarks.h"
#include "io/label_map.h"
#include "mesh_options.h"
#include "run/ready.h"
#include "scene/scene.h"
#include "setup/access.h"
#include "setup/first_scene.h"
#include "vessel/branches.h"
#include "vessel/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#ifdef SEL_WITH_VIEW
    #include "view/inlet_picture.h"
#endif

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

struct InitArguments {
    fs::path mesh, scene;
    MeshOptions given;
    std::string instrument;
    int inlet = 0;  // 0: chosen
    bool overwrite = false;
};

void refuse_to_overwrite(const InitArguments& options, const fs::path& picture)
{
    if (options.overwrite) return;
    for (const fs::path& file : {options.scene, picture})
        if (fs::exists(file))
            throw Error(
                ErrorKind::BadScene,
                fmt::format("{}: is there already; give --overwrite to replace it, or another name with -o", file.string()));
}

/// @return a line about the picture
std::string draw(const fs::path& picture, const WallMesh& mesh, const Centreline& line, const FirstScene& first)
{
#ifdef SEL_WITH_VIEW
    try {
        const Branches numbered(line, end_at(line, first.inlets[static_cast<std::size_t>(first.inlet) - 1].point));
        std::vector<Vec3> branches;
        for (int k = 1; k <= numbered.count(); ++k)
            branches.push_back(line.points[static_cast<std::size_t>(numbered.points(k).back())]);
        draw_inlets(picture, mesh, first.inlets, branches, first.inlet);
        return fmt::format("  {}: the inlets and the branches, numbered\n", picture.string());
    } catch (const Error& error) {  // a scene is what was asked for: no display is no failure
        return fmt::format("  note: no picture of the inlets: {}\n", error.what());
    }
#else
    (void)picture, (void)mesh, (void)line, (void)first;
    return "  note: no picture of the inlets: this build has no renderer (-DSELDINGER_VIEW=ON)\n";
#endif
}

/// Its unit: given, else said by the file's header, else guessed.
LoadedVessel load_in_its_unit(const InitArguments& options, const FileRemarks& remarks, FirstScene& first)
{
    LoadedVessel vessel;
    const std::string said = remarks.units, asked = options.given.units.empty() ? said : options.given.units;
    const std::vector<UnitGuess> guesses = guess_units(options.mesh, vessel, asked, options.given.label);
    const UnitGuess unit = asked.empty() ? guesses.front() : *std::ranges::find(guesses, asked, &UnitGuess::unit);
    if (options.given.has_centreline()) vessel = options.given.load(options.mesh, unit.unit);
    first.unit = unit.unit;
    first.label = options.given.label;
    first.centreline = options.given.centreline;
    first.centreline_units = options.given.centreline_units;
    first.centreline_space = options.given.centreline_space;
    first.unit_why = describe_unit(guesses, unit,
                                   !options.given.units.empty() ? "given"
                                   : remarks.by_format    ? "as label maps are read"
                                   : !said.empty()        ? "said by the file's header"
                                                          : "guessed from its size");
    if (options.given.units.empty() && !unit.plausible)
        throw Error(
            ErrorKind::BadScene,
            fmt::format("{}: got units \"{}\", {}; expected a lumen of 0.3 to 20 mm radius along most of its axis. Fix: say "
                        "with --units which unit it has",
                        options.mesh.string(), unit.unit, first.unit_why));
    if (const std::string why = describe_no_vessel(vessel); !why.empty() && options.given.units.empty())
        throw Error(
            ErrorKind::BadFile,
            fmt::format("{}: is no vessel: {}. Fix: give the surface of a lumen, cut where the vessel ends; --units takes "
                        "it as it is",
                        options.mesh.string(), why));
    return vessel;
}

/// DICOM's axes unless the file's header says others.
void find_axes(const FileRemarks& remarks, FirstScene& first)
{
    const FileAxes axes = remarks.axes;
    if (axes == FileAxes::Ras) first.back = -Vec3::UnitY();
    first.axes_why =
        remarks.by_format ? "The surface of a label map is in LPS: x to the left, y to the back, z to the head"
        : axes == FileAxes::Ras ? "The file says SPACE=RAS: x to the right, y to the front, z to the head"
        : axes == FileAxes::Lps
            ? "The file says SPACE=LPS: x to the left, y to the back, z to the head"
            : "The file says nothing of its axes; LPS is taken, as in DICOM: x to the left, y to the back, z to the head";
}

/// @return why each inlet was taken or left, and what part of the surface it leads into
std::vector<std::string> choose_inlet(const InitArguments& options, const LoadedVessel& vessel, FirstScene& first)
{
    first.inlets = find_inlets(vessel.report.loops, vessel.centreline);
    if (first.inlets.empty())
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: got a surface without an opening and without a lumen that has an axis; expected the wall of "
                                "a vessel. Fix: cut the vessel's ends, or give the surface of its lumen",
                                options.mesh.string()));
    if (static_cast<std::size_t>(std::max(0, options.inlet)) > first.inlets.size())
        throw Error(ErrorKind::BadScene, fmt::format("--inlet {}: the vessel has {} inlet{}", options.inlet, first.inlets.size(),
                                                    first.inlets.size() == 1 ? "" : "s"));
    std::vector<int> part(first.inlets.size(), 0);
    std::optional<VesselParts> parts;
    if (vessel.report.components > 1) {
        parts.emplace(vessel.mesh, vessel.report.loops);
        for (std::size_t k = 0; k < part.size(); ++k) part[k] = parts->part_at(first.inlets[k].point);
    }
    const Access access = choose_access(first.inlets, part, vessel.centreline, first.head, first.back);
    first.inlet = options.inlet > 0 ? options.inlet : access.inlet;
    first.inlet_why = options.inlet > 0 ? "asked for" : access.reason[static_cast<std::size_t>(first.inlet) - 1];
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < first.inlets.size(); ++k) {
        const bool taken = static_cast<int>(k) + 1 == first.inlet;
        lines.push_back(fmt::format("inlet {}: {}{}{}", k + 1, describe(first.inlets[k]), taken ? "  <- taken, " : "; ",
                                    taken ? first.inlet_why : access.reason[k]));
    }
    if (parts)
        for (const std::string& line : parts->describe_choice(part[static_cast<std::size_t>(first.inlet) - 1]))
            lines.push_back(line);
    return lines;
}

/// The written scene runs: read and set up as `check` would. The scene is not there yet, so that no message may send anyone to
/// it.
void require_runnable(const InitArguments& options, const std::string& text, const LoadedVessel& vessel)
{
    try {
        const Scene scene = read_scene_text(text, options.scene);
        (void)ready_setup(std::span(&scene, 1), vessel, -1);
    } catch (const Error& error) {
        std::string what = error.what();
        if (const std::string name = options.scene.string() + ": "; what.starts_with(name)) what = what.substr(name.size());
        throw Error(error.kind(), fmt::format("{}: no scene was written, as none would run: {}", options.mesh.string(), what));
    }
}

ErrorKind init(InitArguments& options)
{
    if (options.mesh.extension() == ".toml")
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: got a scene; expected a mesh. Fix: give the file of the vessel's surface, or run the scene",
                                options.mesh.string()));
    if (options.scene.empty())
        options.scene = (is_label_map(options.mesh) ? options.mesh.stem().stem() : options.mesh.stem()).string() + ".toml";
    const fs::path picture = options.scene.parent_path() / (options.scene.stem().string() + "-ways-in.png");
    refuse_to_overwrite(options, picture);
    FirstScene first;
    first.mesh = options.mesh;
    first.file = options.scene;
    const FileRemarks remarks = remarks_of_file(options.mesh);
    const LoadedVessel vessel = load_in_its_unit(options, remarks, first);
    find_axes(remarks, first);
    const std::vector<std::string> ways = choose_inlet(options, vessel, first);
    const Inlet& inlet = first.inlets[static_cast<std::size_t>(first.inlet) - 1];
    first.way = way_through(vessel.centreline, inlet);
    first.wire = choose_wire(first.way, options.instrument);
    const std::string text = first_scene_text(first);
    require_runnable(options, text, vessel);
    make_folder_of(options.scene);
    write_file(options.scene, text);
    std::string out = fmt::format("{}: units \"{}\", {}\n", printable(options.mesh.string()), first.unit, first.unit_why);
    if (remarks.by_format)
        for (const std::string& note : vessel.report.notes) out += fmt::format("  {}\n", note);
    out += fmt::format("  axes: {}\n", first.axes_why);
    for (const std::string& line : ways) out += fmt::format("  {}\n", line);
    out += fmt::format("  wire: {}\n  {}: the scene; next: seldinger run {}\n", first.wire.why, options.scene.string(),
                       options.scene.string());
    print(out + draw(picture, vessel.mesh, vessel.centreline, first));
    return ErrorKind::None;
}

}  // namespace

void add_init(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<InitArguments>();
    CommandLine* command = app.add_subcommand("init", "write a first scene for a mesh: its unit, inlet and a wire that fits");
    command->add_option("MESH", options->mesh, "mesh (STL, OBJ, PLY, VTP, VTK) or label map (NIfTI, NRRD, MetaImage)")
        ->required();
    command->add_option("-o", options->scene, "the scene to write (default: <mesh>.toml here)")->type_name("SCENE.toml");
    options->given.add_to(*command, "of the mesh: m, cm, mm, um, in (default: guessed from its size)");
    command->add_option("--inlet", options->inlet, "number of an inlet of the list (default: chosen, with the reason)")
        ->type_name("N")
        ->check(in_range(1, 1000));
    command->add_option("--instrument", options->instrument, "of the catalogue (default: a guidewire that fits)")
        ->type_name("NAME");
    command->add_flag("--overwrite", options->overwrite, "replace a scene and a picture that are there");
    command->callback([options, &chosen] { chosen = [options] { return init(*options); }; });
}

}  // namespace seldinger::apps
