// seldinger check SCENE.toml: reads the scene, loads the vessel, runs nothing.

#include "commands.h"
#include "scene/scene.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

namespace seldinger::apps {
namespace {

std::string describe(const Scene& scene, const RepairReport& vessel)
{
    std::string text = fmt::format("{}: ok\n  ", scene.source.string());
    if (scene.integrator.scheme == Scheme::Static) text += "one static equilibrium";
    else text += fmt::format("{} steps of {:g} ms", scene.steps(), 1e3 * scene.dt);
    text += fmt::format("; wire {:g} mm long, {:g} mm thick", 1e3 * scene.wire.length, 2e3 * scene.wire.shaft.radius);
    if (vessel.triangles > 0) text += fmt::format("; vessel of {} triangles, {} openings", vessel.triangles, vessel.loops.size());
    text += "\n";
    for (const std::string& note : vessel.notes) text += "  vessel: " + note + "\n";
    for (const auto& [name, value] : scene.notes) text += fmt::format("  {}: {}\n", name, value);
    return text;
}

}  // namespace

void add_check(CLI::App& app, Command& chosen)
{
    auto file = std::make_shared<std::filesystem::path>();
    CLI::App* check = app.add_subcommand("check", "say whether a scene can be run");
    check->add_option("SCENE", *file, "scene file (TOML)")->required();
    check->callback([file, &chosen] {
        chosen = [file] {
            const Scene scene = read_scene(*file);
            RepairReport vessel;
            (void)make_setup(scene, -1, &vessel);
            print(describe(scene, vessel));
            return ExitCode::Done;
        };
    });
}

}  // namespace seldinger::apps
