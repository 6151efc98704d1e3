// seldinger run SCENE.toml [-o DIR] [--set ...] [--wire NAME] [--resume | --overwrite] [--time-limit S] [--device N] [--quiet]
// [--verbose] [--json]

#include "command_line.h"
#include "commands.h"
#include "run_loop.h"


#include <cstdlib>
#include <memory>
#include <optional>

namespace seldinger::apps {

void add_limits(CommandLine& command, double& time_limit, int& device)
{
    command
        .add_option("--time-limit", time_limit,
                    "stop this number of seconds after the start of the command with the state saved, exit 75")
        ->type_name("S")
        ->check([](const std::string& text) {
            return std::strtod(text.c_str(), nullptr) > 0 ? "" : "got " + text + "; expected seconds above 0";
        });
    command.add_option("--device", device, "OpenCL device, as `seldinger devices` lists them")
        ->type_name("N")
        ->check([](const std::string& text) { return text.starts_with('-') ? "got " + text + "; expected 0 or more" : ""; });
}

void add_run(CommandLine& app, Command& chosen)
{
    struct Options {
        std::filesystem::path scene;
        RunOptions run;
        std::optional<std::string> wire;
        std::string estimate = "auto";
        bool resume = false, overwrite = false, json = false, verbose = false;
    };
    auto options = std::make_shared<Options>();
    CommandLine* run = app.add_subcommand("run", "run a scene and record it");
    run->add_option("SCENE", options->scene,
                    "scene file (TOML), or the name of a scene of the program; with --resume that of DIR, if not given")
        ->scene();
    run->add_option("-o", options->run.dir, "folder for the results (default: <scene>-run here)")->type_name("DIR");
    run->add_option("--set", options->run.overrides, "change a key of the scene; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    run->add_option("--wire", options->wire, "another instrument of the catalogue: --set wire.preset=NAME")->type_name("NAME");
    auto* resume = run->add_flag("--resume", options->resume, "continue the run in DIR (without one: from the start)");
    run->add_option("--replay", options->run.replay,
                    "use the inputs of a recorded live session instead of the key frames; the result has the same bits")
        ->excludes(resume)
        ->type_name("FILE");
    run->add_flag("--overwrite", options->overwrite, "replace the run in DIR")->excludes(resume);
    run->add_option("--error-estimate", options->estimate,
                    "estimate the time-step error of forces and tip: auto (a tenth of the run's steps), on or off")
        ->check(one_of({"auto", "on", "off"}));
    add_limits(*run, options->run.time_limit, options->run.device);
    run->add_flag("--quiet", options->run.quiet, "no progress, no summary");
    run->add_flag("--verbose", options->verbose, "print more closing lines: model, inlet, bands, numerics, state hash");
    run->add_flag("--json", options->json, "print the summary as one JSON object");
    run->callback([options, &chosen] {
        chosen = [options] {
            RunOptions& what = options->run;
            if (options->scene.empty()) {
                if (!options->resume || what.dir.empty())
                    throw Error(ErrorKind::BadScene,
                                "SCENE is required; see `seldinger run --help`. Only --resume -o DIR takes that of DIR");
                options->scene = what.dir / "scene.toml";
            }
            if (options->wire) what.overrides.push_back("wire.preset=" + *options->wire);
            what.estimate = options->estimate != "off";
            what.asked_estimate = options->estimate == "on";
            if (options->resume) what.use = FolderUse::Resume;
            if (options->overwrite) what.use = FolderUse::Overwrite;
            if (what.dir.empty()) what.dir = options->scene.stem().string() + "-run";
            const RunOutcome outcome = run_scene(read_scene(options->scene, what.overrides), what);
            if (options->json) print(outcome.summary);
            else if (!what.quiet) print(summary_for_people(outcome.summary, what.dir, options->verbose));
            if (!outcome.message.empty()) throw Error(outcome.code, outcome.message);
            return outcome.code;
        };
    });
}

}  // namespace seldinger::apps
