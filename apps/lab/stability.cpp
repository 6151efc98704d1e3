// seldinger stability [SCENE.toml --vary KEY=V,V,...] [--quick] [-o DIR] [--row F3 ...] [--maps ...] [--methods ...] [--jobs N]
//                     [--cell-budget S] [--json] [--quiet]

#include "assets.h"
#include "command_line.h"
#include "lab/lab_commands.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "lab/stability_study.h"
#include "stop_signal.h"

#include <fmt/format.h>

#include <csignal>
#include <memory>

namespace seldinger::apps {

void add_stability(CommandLine& app, Command& chosen)
{
    struct Options : StabilityOptions {
        bool json = false;
    };
    auto options = std::make_shared<Options>();
    CommandLine* command = app.add_subcommand("stability", "map where each method is stable, and how it fails elsewhere");
    command
        ->add_option("-o", options->dir,
                     "folder for table, scenes and maps.json (default: stability); finished cells in it are kept")
        ->type_name("DIR");
    command->add_option("scene", options->scene, "your own scene, swept over its step and --vary, instead of the maps")
        ->type_name("SCENE.toml");
    command->add_option("--vary", options->vary, "key and values to vary in it, e.g. vessel.youngs_pa=1e5,1e6,1e7")
        ->type_name("KEY=V,V,...");
    command->add_flag("--quick", options->quick, "short check: nine cells a map, four methods, a few minutes");
    command->add_option("--row", options->rows, "only maps of these failure rows, e.g. F3,F4")
        ->type_name("F1..F21")
        ->delimiter(',');
    command->add_option("--maps", options->maps, "only these maps")->type_name("NAME")->delimiter(',');
    // a method's name may hold a comma
    command
        ->add_option(
            "--methods", options->methods,
            "only these methods; separate by spaces, quote names; all: every method (default: those in docs/stability.md)")
        ->type_name("NAME");
    command->add_option("--jobs", options->jobs, "threads (default: one per core)")->check(in_range(1, 1024))->type_name("N");
    command
        ->add_option("--cell-budget", options->cell_limit,
                     "seconds that one cell may take (default: 30); it is then \"unfinished\"")
        ->check(positive())
        ->type_name("S");
    command->add_flag("--quiet", options->quiet, "no progress, no summary");
    command->add_flag("--json", options->json, "print the counts as one JSON object");
    command->callback([options, &chosen] {
        chosen = [options] {
            const StabilityWork work = select_work(*options);
            const FileLock lock = FileLock::of_folder(options->dir);
            const StabilityProgress done = run_stability(work, *options);
            const ResultTable table = open_stability_table(options->dir);
            const std::string json = stability_json(work, table, options->dir);
            write_file(options->dir / "maps.json", json);
            const bool drawn = !done.interrupted && draw_with("plot_stability.py", {options->dir.string()});
            if (options->json) print(json);
            else if (!options->quiet) print(stability_summary(work, table, options->dir));
            if (drawn && !options->quiet && !options->json)
                print(fmt::format("{}: stability.csv, maps.json, stability.png\n", options->dir.string()));
            if (!done.interrupted) return ErrorKind::None;
            throw Error(stop_asked_for() == SIGTERM ? ErrorKind::TimeLimit : ErrorKind::Interrupted,
                        fmt::format("interrupted with {} cells of this selection still to run; finished cells are in {}, and the "
                                    "same command continues",
                                    done.left, (options->dir / stability_table_file).string()));
        };
    });
}

}  // namespace seldinger::apps
