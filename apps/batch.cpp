// seldinger batch SCENE.toml --vary SWEEP.toml [-o DIR] [--set ...] [--bands] [--resume | --overwrite] [--time-limit S] [--device N]
//                 [--threads N] [--keep traces,last-frame] [--quiet] [--json]

#include "batch_loop.h"
#include "command_line.h"
#include "commands.h"
#include "core/parallel.h"
#include "batch/batch_keep.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace seldinger::apps {
namespace {

struct BatchArguments {
    std::filesystem::path scene, sweep;
    RunOptions run;
    int threads = 0;
    std::string keep;
    bool bands = false, resume = false, overwrite = false, json = false;
};

std::string batch_for_people(const std::string& json, const std::filesystem::path& dir)
{
    const nlohmann::json s = nlohmann::json::parse(json);
    std::string text = fmt::format(
        "{}: {}, {} runs in {} worlds, {} stopped\n  {} wire-steps in {:.3g} s ({:.0f} per second) on {}, {} threads\n"
        "  {}: results.csv, results-units.csv, results.npz, shapes.csv, summary.json, scene.toml, sweep.toml\n",
        s.at("name").get<std::string>(), s.at("status").get<std::string>(), s.at("runs").get<long>(), s.at("worlds").get<long>(),
        s.at("stopped").get<long>(), s.at("wire_steps").get<long>(), s.at("wall_s").get<double>(),
        s.at("wire_steps_per_s").get<double>(), s.at("device").get<std::string>(), s.at("threads").get<int>(), dir.string());
    for (const auto& warning : s.value("warnings", nlohmann::json::array())) text += "  note: " + warning.get<std::string>() + "\n";
    if (const std::string answer = s.at("answer").get<std::string>(); !answer.empty()) text += answer + "\n";
    if (s.contains("wall_bands")) text += "bands of the elastic wall: " + s.at("wall_bands").get<std::string>() + "\n";
    return text;
}

ExitCode batch(BatchArguments& options)
{
    RunOptions& what = options.run;
    if (options.resume) what.use = FolderUse::Resume;
    if (options.overwrite) what.use = FolderUse::Overwrite;
    if (what.dir.empty()) what.dir = options.scene.stem().string() + "-batch";
    if (options.bands) what.overrides.push_back("output.bands=true");
    if (!options.keep.empty())
        for (const std::string& setting : keep_settings(options.keep)) what.overrides.push_back(setting);
    set_thread_count(options.threads);
    const RunOutcome outcome = run_batch(options.scene, options.sweep, what);
    if (options.json) print(outcome.summary);
    else if (!what.quiet) print(batch_for_people(outcome.summary, what.dir));
    if (!outcome.message.empty()) throw Error(outcome.code, outcome.message);
    return outcome.code;
}

}  // namespace

void add_batch(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<BatchArguments>();
    CommandLine* command = app.add_subcommand("batch", "run a scene many times with keys varied, many wires at once");
    command->add_option("SCENE", options->scene, "scene file (TOML), or the name of a scene of the program")->scene()->required();
    command->add_option("--vary", options->sweep, "sweep file: [vary] with lists (grid) and {min, max, n} (draws)")
        ->type_name("SWEEP.toml")
        ->required();
    command->add_option("-o", options->run.dir, "folder for the results (default: <scene>-batch here)")->type_name("DIR");
    command->add_option("--set", options->run.overrides, "change a key of the scene for all runs; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    command->add_flag("--bands", options->bands, "each run a second time with half the step: a band for each force, --set output.bands=true");
    command->add_option("--keep", options->keep, "files of each run in DIR/runs: traces, last-frame or traces,last-frame (default: none)")->type_name("WHAT");
    auto* resume =
        command->add_flag("--resume", options->resume, "continue the batch in DIR (without one: from the start)");
    command->add_flag("--overwrite", options->overwrite, "replace the contents of DIR")->excludes(resume);
    add_limits(*command, options->run.time_limit, options->run.device);
    command->add_option("--threads", options->threads, "of the host's part (default: all cores); the results do not depend on it")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command->add_flag("--quiet", options->run.quiet, "no progress, no summary");
    command->add_flag("--json", options->json, "print the summary as one JSON object");
    command->callback([options, &chosen] { chosen = [options] { return batch(*options); }; });
}

}  // namespace seldinger::apps
