// seldinger chart [--quick] [-o DIR] [--scenes NAME|FILE …] [--processor-time] [--overwrite] [--device N] [--quiet]

#include "command_line.h"
#include "lab/chart.h"
#include "assets.h"
#include "baselines/baselines.h"
#include "lab/lab_commands.h"
#include "core/file_lock.h"
#include "core/folder.h"
#include "core/note.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>
#include <chrono>
#include <csignal>
#include <memory>

namespace seldinger::apps {
namespace {

struct ChartArguments {
    ChartOptions chart;
    bool overwrite = false, quiet = false;
};

/// One line on stderr; nothing when it is not a terminal.
void show_model(const std::string& doing)
{
    if (isatty(STDERR_FILENO)) note(fmt::format("\r\033[K{}", doing));
}

/// Only what a chart writes: a folder of the user's may hold other things.
void forget(const std::filesystem::path& dir)
{
    const Folder folder(dir);
    for (const char* file : {"runs.csv", "chart.csv", "references.csv"}) (void)folder.remove(file);
}

ErrorKind chart(ChartArguments& options)
{
    const StopSignal listening;
    ChartOptions& what = options.chart;
    what.scenes_folder = assets_folder() / "scenes";
    what.baselines = baselines::all();
    what.stop = [] { return stop_asked_for() != 0; };
    if (!options.quiet) what.progress = show_model;
    const FileLock lock = FileLock::of_folder(what.dir);
    if (options.overwrite) forget(what.dir);
    const ChartResult result = make_chart(what);
    if (!options.quiet) show_model("");
    const std::string dir = what.dir.string();
    if (result.interrupted)
        throw Error(stop_asked_for() == SIGINT ? ErrorKind::Interrupted : ErrorKind::TimeLimit,
                    fmt::format("interrupted after {} of {} runs, all kept in {}; the same command continues", result.runs_done,
                                result.runs_wanted, dir));
    const bool drawn = draw_with("plot_chart.py", {dir});
    if (!options.quiet) {
        print(chart_summary(result));
        print(fmt::format("{}: chart.csv, references.csv, runs.csv{}\n", dir,
                          drawn ? ", chart.svg, chart.png and one picture per scene" : ""));
    }
    return ErrorKind::None;
}

}  // namespace

void add_chart(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<ChartArguments>();
    CommandLine* command = app.add_subcommand("chart", "speed against accuracy: the same scenes under every model");
    command->add_flag("--quick", options->chart.quick, "fewer models, shorter scenes: minutes instead of an hour");
    command
        ->add_option("-o", options->chart.dir,
                     "folder for the results (default: chart, or chart-quick); finished runs in it are kept")
        ->type_name("DIR");
    command
        ->add_option("--scenes", options->chart.scenes,
                     fmt::format("some of {}, or scene files", fmt::join(benchmark_names(), ", ")))
        ->type_name("NAME|FILE")
        ->delimiter(',');
    command->add_flag("--processor-time", options->chart.processor_time,
                      "measure cost in processor time instead of wall time (for a machine with other load)");
    command
        ->add_option("--planned", options->chart.planned,
                     "scene written by `plan`; its model joins the others (for one scene only)")
        ->type_name("FILE");
    command->add_option("--run-limit", options->chart.run_limit, "seconds after which a model is stopped (default: 60, or 10)")
        ->check(positive())
        ->type_name("S");
    command
        ->add_option("--reference-limit", options->chart.reference_limit, "seconds to refine the reference (default: 240, or 30)")
        ->check(positive())
        ->type_name("S");
    command->add_flag("--overwrite", options->overwrite, "run everything again");
    command->add_option("--device", options->chart.device, "OpenCL device, as `seldinger devices` lists them")
        ->type_name("N")
        ->check([](const std::string& text) { return text.starts_with('-') ? "got " + text + "; expected 0 or more" : ""; });
    command->add_flag("--quiet", options->quiet, "no progress, no summary");
    command->callback([options, &chosen] {
        chosen = [options] {
            if (options->chart.dir.empty()) options->chart.dir = options->chart.quick ? "chart-quick" : "chart";
            return chart(*options);
        };
    });
}

}  // namespace seldinger::apps
