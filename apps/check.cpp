// seldinger check SCENE.toml [--set ...] [--wire NAME]: reads the scene, loads the vessel, runs nothing.

#include "command_line.h"
#include "commands.h"
#include "contact/wall_body.h"
#include "run/ready.h"
#include "scene/scene.h"
#include "setup/vessel_load.h"
#include "vessel/inlets.h"
#include "vessel/parts.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace seldinger::apps {
namespace {

/// A point of one's own in mid-lumen is no way into a patient.
std::string describe_entry(const Scene& scene, const RepairReport& vessel, const WorldSetup& setup)
{
    const std::vector<Inlet> inlets = find_inlets(vessel.loops, setup.centreline);
    std::string text;
    for (int k = 0; k < scene.instrument_count() && !inlets.empty(); ++k) {
        const FeedSpec& feed = setup.wires[static_cast<std::size_t>(k)].feed;
        if (!feed.on || scene.instrument(k).feed.inlet_auto) continue;
        const auto distance = [&](const Inlet& i) { return (i.point - feed.point).norm(); };
        const auto nearest = std::min_element(inlets.begin(), inlets.end(),
                                              [&](const Inlet& a, const Inlet& b) { return distance(a) < distance(b); });
        if (distance(*nearest) <= 3 * nearest->radius) continue;
        text += fmt::format(
            "  note: feed.point lies {:.3g} mm from the nearest inlet, number {}; a wire enters a vessel at an opening or an "
            "end. Fix: "
            "inlet = {}, unless it is meant to start there\n",
            1e3 * distance(*nearest), nearest - inlets.begin() + 1, nearest - inlets.begin() + 1);
        break;  // instruments inside each other enter at one place
    }
    return text;
}

/// The control mesh that an elastic wall will have, and its errors in displacement and stress.
std::string describe_wall_mesh(const WorldSetup& setup, const WallMechanics& made)
{
    if (made.vertices == 0 || !std::isfinite(made.decay)) return {};
    const bool chosen = setup.vessel.wall_edge == 0;
    const double edge = chosen ? std::min(made.edge, 0.5 * made.decay) : made.edge;
    const WallMeshBand band = wall_mesh_band(edge, made.decay, setup.vessel.shape == VesselShape::Plane);
    return fmt::format(
        "  elastic wall: a dent decays over {:.3g} mm; control edges of {:.3g} mm{} leave up to {:.1g} % in displacement and "
        "{:.2g} % in "
        "stress{}\n",
        1e3 * made.decay, 1e3 * edge,
        chosen ? " where a trial run with a rigid wall touches (longer if they were more than 3,000)" : "", 1e2 * band.move,
        1e2 * std::min(1.0, 0.5 * band.stress),
        chosen ? "" : "; leave vessel.wall_edge_m out for short ones where instruments touch");
}

std::string describe(const Scene& scene, const RepairReport& vessel, const WorldSetup& setup)
{
    std::string text = fmt::format("{}: ok\n  ", scene.source.string());
    if (scene.integrator.scheme == Scheme::Static) text += "one static equilibrium";
    else text += fmt::format("{} steps of {:g} ms", scene.steps(), 1e3 * scene.dt);
    text += fmt::format("; wire {:g} mm long, {:g} mm thick", 1e3 * scene.wire.length, 2e3 * scene.wire.shaft.radius);
    if (vessel.triangles > 0) text += fmt::format("; vessel of {} triangles, {} openings", vessel.triangles, vessel.loops.size());
    text += "\n";
    for (const std::string& note : vessel.notes) text += "  vessel: " + note + "\n";
    if (const std::string thick = describe_thick_wall(setup.vessel, setup.centreline); !thick.empty())
        text += "  note: " + thick + "\n";
    const WallMechanics made = expected_mechanics(setup.vessel, setup.mesh, setup.centreline);
    if (const std::string coarse = describe_coarse_wall(made, setup.vessel); !coarse.empty() && setup.vessel.wall_edge > 0)
        text += "  note: " + coarse + "\n";
    text += describe_wall_mesh(setup, made);
    for (const WireSetup& wire : setup.wires)
        if (!wire.inlet.empty())
            text += fmt::format("  {}inlet {}\n", wire.name.empty() ? "" : wire.name + ": ", wire.inlet);
    if (vessel.components > 1)
        for (const WireSetup& wire : setup.wires)
            if (wire.feed.on) {
                const VesselParts parts(setup.mesh, vessel.loops);
                for (const std::string& line : parts.describe_choice(parts.part_at(wire.feed.point)))
                    text += "  note: " + line + "\n";
                break;
            }
    if (setup.vessel.shape == VesselShape::Mesh) text += describe_entry(scene, vessel, setup);
    for (const std::string& warning : scene.warnings) text += "  note: " + warning + "\n";
    for (const auto& [name, value] : scene.notes) text += fmt::format("  {}: {}\n", name, value);
    return text;
}

}  // namespace

void add_check(CommandLine& app, Command& chosen)
{
    struct Options {
        std::filesystem::path file;
        std::vector<std::string> overrides;
        std::optional<std::string> wire;
    };
    auto options = std::make_shared<Options>();
    CommandLine* check = app.add_subcommand("check", "check a scene without running it");
    check->add_option("SCENE", options->file, "scene file (TOML), or the name of a scene of the program")->scene()->required();
    check->add_option("--set", options->overrides, "change a key of the scene; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    check->add_option("--wire", options->wire, "another instrument of the catalogue: --set wire.preset=NAME")->type_name("NAME");
    check->callback([options, &chosen] {
        chosen = [options] {
            if (options->wire) options->overrides.push_back("wire.preset=" + *options->wire);
            const Scene scene = read_scene(options->file, options->overrides);
            RepairReport vessel;
            const WorldSetup setup = ready_setup(scene, -1, &vessel);
            print(describe(scene, vessel, setup));
            return ErrorKind::None;
        };
    });
}

}  // namespace seldinger::apps
