// seldinger batch SCENE.toml --vary SWEEP.toml [-o DIR] [--set ...] [--bands] [--resume | --overwrite] [--time-limit S] [--device
// N]
//                 [--threads N] [--keep traces,last-frame] [--part K/N] [--quiet] [--json]
// seldinger batch merge DIR...

#include "batch_loop.h"
#include "command_line.h"
#include "commands.h"
#include "core/child_process.h"
#include "core/parallel.h"
#include "batch/batch_keep.h"
#include "render_frames.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <memory>

namespace seldinger::apps {
namespace {

struct BatchArguments {
    std::filesystem::path scene, sweep;
    RunOptions run;
    int threads = 0;
    std::string keep, part;
    std::filesystem::path scene_at;
    int parent = 0;
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
    for (const auto& warning : s.value("warnings", nlohmann::json::array()))
        text += "  note: " + warning.get<std::string>() + "\n";
    if (const std::string answer = s.at("answer").get<std::string>(); !answer.empty()) text += answer + "\n";
    if (s.contains("wall_bands")) text += "bands of the elastic wall: " + s.at("wall_bands").get<std::string>() + "\n";
    return text;
}

/// "3/40"
PartChoice part_of(const BatchArguments& options)
{
    const auto [part, parts] = two_numbers(options.part, '/', "--part", "PART/PARTS, e.g. 1/40 to 40/40");
    if (part < 1 || part > parts)
        throw Error(ErrorKind::BadScene,
                    fmt::format("--part: got {}; expected a part from 1/{} to {}/{}", options.part, parts, parts, parts));
    return {static_cast<std::size_t>(part), static_cast<std::size_t>(parts), options.scene_at};
}

ErrorKind batch(BatchArguments& options)
{
    RunOptions& what = options.run;
    if (options.scene.empty())
        throw Error(ErrorKind::BadScene, "batch: got no scene; expected one. Fix: give SCENE.toml --vary SWEEP.toml");
    if (options.sweep.empty())
        throw Error(ErrorKind::BadScene, "batch: got no --vary; expected a sweep. Fix: give --vary SWEEP.toml");
    if (options.parent > 0) end_with_parent(options.parent, SIGTERM);
    if (options.resume) what.use = FolderUse::Resume;
    if (options.overwrite) what.use = FolderUse::Overwrite;
    if (what.dir.empty()) what.dir = options.scene.stem().string() + "-batch";
    if (options.bands) what.overrides.push_back("output.bands=true");
    if (!options.keep.empty())
        for (const std::string& setting : keep_settings(options.keep)) what.overrides.push_back(setting);
    set_thread_count(options.threads);
    const bool whole = options.part.empty();
    const RunOutcome outcome = whole ? run_batch(options.scene, options.sweep, what)
                                     : run_batch_part(options.scene, options.sweep, part_of(options), what);
    if (options.json) print(outcome.summary);
    else if (!what.quiet && !whole && outcome.message.empty())
        print(fmt::format("{}: part {} is done; when all are: seldinger batch merge {}\n", what.dir.string(), options.part,
                          what.dir.string()));
    else if (!what.quiet && whole) print(batch_for_people(outcome.summary, what.dir));
    if (!outcome.message.empty()) throw Error(outcome.code, outcome.message);
    return outcome.code;
}

void add_merge(CommandLine& batch_command, Command& chosen)
{
    auto dirs = std::make_shared<std::vector<std::filesystem::path>>();
    CommandLine* command = batch_command.add_subcommand("merge", "make the table of a batch from its parts");
    command->add_option("DIR", *dirs, "folder of --part -o; of several, in which parts lie, the first gets the table")
        ->required();
    command->callback([dirs, &chosen] { chosen = [dirs] { return merge_and_tell(*dirs); }; });
}

}  // namespace

ErrorKind merge_and_tell(const std::vector<std::filesystem::path>& dirs)
{
    const RunOutcome outcome = merge_parts(dirs);
    const nlohmann::json s = nlohmann::json::parse(outcome.summary);
    const std::string answer = s.at("answer").get<std::string>();
    print(fmt::format("{}: {} runs, {} stopped: results.csv, results-units.csv, results.npz, shapes.csv, summary.json\n{}",
                      dirs.front().string(), s.at("runs").get<long>(), s.at("stopped").get<long>(),
                      answer.empty() ? "" : answer + "\n"));
    return outcome.code;
}

void add_batch(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<BatchArguments>();
    CommandLine* command = app.add_subcommand("batch", "run a scene many times with keys varied, many wires at once");
    command->add_option("SCENE", options->scene, "scene file (TOML), or the name of a scene of the program")->scene();
    command->add_option("--vary", options->sweep, "sweep file: [vary] with lists (grid) and {min, max, n} (draws)")
        ->type_name("SWEEP.toml");
    command->add_option("-o", options->run.dir, "folder for the results (default: <scene>-batch here)")->type_name("DIR");
    command->add_option("--set", options->run.overrides, "change a key of the scene for all runs; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    command->add_flag("--bands", options->bands,
                      "each run a second time with half the step: a band for each force, --set output.bands=true");
    command
        ->add_option("--keep", options->keep,
                     "files of each run in DIR/runs: traces, last-frame or traces,last-frame (default: none)")
        ->type_name("WHAT");
    command
        ->add_option("--part", options->part,
                     "only part K of N of the runs, in DIR/parts, from where it stands; `batch merge DIR` makes the table of all")
        ->type_name("K/N");
    command->add_option("--scene-at", options->scene_at)->hidden();  // of a farm, which has a copy of the scene
    command->add_option("--parent", options->parent)->hidden();      // of a farm: ends with it, its state saved
    auto* resume =
        command->add_flag("--resume", options->resume, "continue the batch in DIR (without one: from the start)");
    command->add_flag("--overwrite", options->overwrite, "replace the contents of DIR")->excludes(resume);
    add_limits(*command, options->run.time_limit, options->run.device);
    command->add_option("--threads", options->threads, "of the host's part (default: all cores); the results do not depend on it")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command->add_flag("--quiet", options->run.quiet, "no progress, no summary");
    command->add_flag("--json", options->json, "print the summary as one JSON object");
    command->require_subcommand(0, 1);
    add_merge(*command, chosen);
    command->callback([options, command, &chosen] {
        if (!command->went_below()) chosen = [options] { return batch(*options); };
    });
}

}  // namespace seldinger::apps
