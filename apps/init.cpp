// seldinger init MESH [-o scene.toml] [--units mm] [--inlet N] [--instrument NAME] [--overwrite]: a first scene for the user's own
// mesh, and a picture of its inlets.

#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "core/printable.h"
#include "scene/first_scene.h"
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#ifdef SEL_WITH_VIEW
    #include "view/ways_in.h"
#endif

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path mesh, scene;
    std::string units, instrument;
    int inlet = 1;
    bool overwrite = false;
};

std::string sizes(const UnitGuess& guess)
{
    return fmt::format("a lumen of {:.3g} mm radius (half of it is wider) in {:.4g} mm from corner to corner", 1e3 * guess.lumen, 1e3 * guess.extent);
}

/// The unit and its reason, one line.
std::string unit_reason(const std::vector<UnitGuess>& guesses, const UnitGuess& taken, bool given)
{
    std::string text = fmt::format("{}: {}", given ? "given" : "guessed from its size", sizes(taken));
    if (!taken.plausible) text += "; no vessel in the body is like that";
    std::string others;
    for (const UnitGuess& other : guesses)
        if (other.plausible && other.unit != taken.unit) others += (others.empty() ? "" : ", ") + other.unit;
    if (!others.empty()) text += fmt::format("; {} would be possible too", others);
    return text;
}

void refuse_to_overwrite(const Options& options, const fs::path& picture)
{
    if (options.overwrite) return;
    for (const fs::path& file : {options.scene, picture})
        if (fs::exists(file))
            throw Error(ExitCode::BadScene, fmt::format("{}: is there already; give --overwrite to replace it, or another name with -o",
                                                        file.string()));
}

/// @return a line about the picture
std::string draw(const fs::path& picture, const WallMesh& mesh, const FirstScene& first)
{
#ifdef SEL_WITH_VIEW
    try {
        draw_ways_in(picture, mesh, first.inlets, first.inlet);
        return fmt::format("  {}: the ways in, numbered\n", picture.string());
    } catch (const Error& error) {  // a scene is what was asked for: no display is no failure
        return fmt::format("  note: no picture of the ways in: {}\n", error.what());
    }
#else
    (void)picture, (void)mesh, (void)first;
    return "  note: no picture of the ways in: this build has no renderer (-DSELDINGER_VIEW=ON)\n";
#endif
}

ExitCode init(Options& options)
{
    if (options.mesh.extension() == ".toml")
        throw Error(ExitCode::BadScene, fmt::format("{}: is a scene already; expected a mesh", options.mesh.string()));
    if (options.scene.empty()) options.scene = options.mesh.stem().string() + ".toml";
    const fs::path picture = options.scene.parent_path() / (options.scene.stem().string() + "-ways-in.png");
    refuse_to_overwrite(options, picture);
    LoadedVessel vessel;
    const std::vector<UnitGuess> guesses = guess_units(options.mesh, vessel);
    UnitGuess unit = guesses.front();
    if (!options.units.empty() && options.units != unit.unit) {
        unit = *std::find_if(guesses.begin(), guesses.end(), [&](const UnitGuess& g) { return g.unit == options.units; });
        VesselSpec spec;
        spec.shape = VesselShape::Mesh;
        spec.mesh = fs::absolute(options.mesh);
        spec.units = unit.unit;
        vessel = load_vessel(spec);
    }
    if (options.units.empty() && !unit.plausible)
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: in no unit the size of a vessel (in {} it is {}); say with --units which one it has",
                                options.mesh.string(), unit.unit, sizes(unit)));
    FirstScene first;
    first.mesh = options.mesh;
    first.file = options.scene;
    first.unit = unit.unit;
    first.unit_why = unit_reason(guesses, unit, !options.units.empty());
    first.inlets = find_inlets(vessel.report.loops, vessel.centreline);
    first.inlet = options.inlet;
    if (first.inlets.empty())
        throw Error(ExitCode::BadFile, fmt::format("{}: has no opening and no lumen with an axis; is it a vessel's wall?", options.mesh.string()));
    if (static_cast<std::size_t>(options.inlet) > first.inlets.size())
        throw Error(ExitCode::BadScene, fmt::format("--inlet {}: the vessel has {} way{} in", options.inlet, first.inlets.size(),
                                                    first.inlets.size() == 1 ? "" : "s"));
    const Inlet& inlet = first.inlets[static_cast<std::size_t>(options.inlet) - 1];
    first.way = way_through(vessel.centreline, inlet);
    first.wire = choose_wire(first.way, options.instrument);
    const std::string text = first_scene_text(first);
    // what is written runs: read and set up as `check` would
    const Scene scene = read_scene_text(text, options.scene);
    (void)make_setup(std::span(&scene, 1), vessel, -1);
    if (options.scene.has_parent_path()) make_folder(options.scene.parent_path());
    write_file(options.scene, text);
    std::string out = fmt::format("{}: units \"{}\", {}\n", printable(options.mesh.string()), first.unit, first.unit_why);
    for (std::size_t k = 0; k < first.inlets.size(); ++k)
        out += fmt::format("  way in {}: {}{}\n", k + 1, describe(first.inlets[k]),
                           static_cast<int>(k) + 1 == first.inlet ? "  <- taken" : "");
    out += fmt::format("  wire: {}\n  {}: the scene; next: seldinger run {}\n", first.wire.why, options.scene.string(), options.scene.string());
    print(out + draw(picture, vessel.mesh, first));
    return ExitCode::Done;
}

}  // namespace

void add_init(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<Options>();
    CommandLine* command = app.add_subcommand("init", "write a first scene for a mesh: its unit, way in and a wire that fits");
    command->add_option("MESH", options->mesh, "mesh (STL, OBJ, PLY, VTP)")->required();
    command->add_option("-o", options->scene, "the scene to write (default: <mesh>.toml here)")->type_name("SCENE.toml");
    command->add_option("--units", options->units, "of the mesh: m, cm, mm, um, in (default: guessed from its size)")
        ->check(one_of({"m", "cm", "mm", "um", "in"}));
    command->add_option("--inlet", options->inlet, "another way in, as they are listed (default: 1)")
        ->type_name("N")
        ->check(in_range(1, 1000));
    command->add_option("--instrument", options->instrument, "of the catalogue (default: a guidewire that fits)")->type_name("NAME");
    command->add_flag("--overwrite", options->overwrite, "replace a scene and a picture that are there");
    command->callback([options, &chosen] { chosen = [options] { return init(*options); }; });
}

}  // namespace seldinger::apps
