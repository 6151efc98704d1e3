// seldinger farm SCENE.toml --vary SWEEP.toml | RUN --frames A:B | all  -o DIR [--backend slurm | local] [--tasks N] [--jobs N]
//                [--set ...] [--sbatch OPTION]... [--submit | --dry-run] [options of render]
// seldinger farm status DIR · farm merge DIR [--video FILE.mp4 [--fps N]]

#include "farm.h"
#include "batch/batch_keep.h"
#include "batch_loop.h"
#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "core/note.h"
#include "dataset.h"
#include "io/film_write.h"
#include "io/json_text.h"
#include "render_frames.h"
#include "run/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t slurm_tasks = 200;  // enough that a lost one is little work, few enough that starting them is
constexpr std::size_t local_tasks = 8;    // for each job: enough that all jobs end together

struct FarmArguments {
    fs::path source, sweep, dir;
    std::vector<std::string> overrides, render;
    FarmBackend backend;
    std::string frames, keep;
    bool bands = false;
};

struct ViewOptions {
    fs::path dir, video;
    std::optional<double> fps;
    bool json = false;
};

/// Every run's values are tried. The parts read copies, so that a later edit does not affect half of the table.
PartPlan plan_sweep(const FarmArguments& options)
{
    const std::string scene_text = read_file(options.source), sweep_text = with_designs(read_file(options.sweep), options.sweep);
    const BatchSource source = make_source(scene_text, options.source, options.overrides, sweep_text, options.sweep);
    std::vector<std::string> warnings;
    (void)plan_worlds(source, 0, source.item_count(), false, &warnings);
    for (const std::string& warning : warnings) note("seldinger: note: " + warning + "\n");
    const PartPlan plan =
        begin_parts(source, sweep_text, options.backend.part_count(options.dir, source.item_count(), "run"), options.dir);
    const Folder parts = Folder(options.dir).make("parts");
    if (!parts.has("scene.toml")) write_file(parts / "scene.toml", scene_text);
    if (!parts.has("sweep.toml")) write_file(parts / "sweep.toml", sweep_text);
    return plan;
}

PartCommand batch_command(const FarmArguments& options)
{
    const fs::path parts = options.dir / "parts";
    PartCommand command{{"batch", (parts / "scene.toml").string(), "--scene-at", options.source.string(), "--vary",
                         (parts / "sweep.toml").string(), "-o", options.dir.string(), "--quiet"}};
    for (const std::string& setting : options.overrides) command.words.insert(command.words.end(), {"--set", setting});
    return command;
}

/// Each value as a separate word, and paths that do not depend on where a part starts or how they are spelt.
std::vector<std::string> farm_words(const std::vector<std::string>& given)
{
    std::vector<std::string> words;
    for (const std::string& word : given) {
        const std::size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
        words.push_back(word.substr(0, equals));
        if (equals != std::string::npos) words.push_back(word.substr(equals + 1));
    }
    for (std::size_t k = 0; k + 1 < words.size(); ++k) {
        const fs::path path = words[k + 1], plain = (path / "").lexically_normal().parent_path();
        if (words[k] == "--views") words[k + 1] = fs::absolute(path).lexically_normal().string();
        else if (words[k] == "--labels" && !plain.empty()) words[k + 1] = plain.string();
    }
    return words;
}

/// Of the run that the pictures show, 16 digits: the first of a plan's key.
std::string run_key(const fs::path& run) { return plan_key({version(), read_file(run / "wire.pvd")}); }

PartPlan plan_frames(const FarmArguments& options, const std::vector<std::string>& words)
{
#ifdef SEL_WITH_VIEW
    PartPlan plan;
    plan.frames = true;
    plan.files = files_of_frame(words);
    const RunFolder run = read_run_folder(options.source);
    FrameChoice choice;
    choice.first = 0, choice.last = static_cast<int>(run.frames.size()) - 1;
    if (options.frames != "all") {
        const auto [first, last] = two_numbers(options.frames, ':', "--frames", "FIRST:LAST, e.g. 0:499, or all");
        choice.first = first, choice.last = last;
    }
    const FrameRange range = frames_asked(choice, run.frames.size());
    plan.first = range.first, plan.items = range.count(), plan.rate = film_rate(choice, run, range);
    plan.parts = options.backend.part_count(options.dir, plan.items, "frame");
    std::vector<std::string> looked = words;
    for (std::size_t k = 0; k + 1 < words.size(); ++k)
        if (words[k] == "--views") looked.push_back(read_file(words[k + 1]));
    plan.key = run_key(options.source) + plan_key(looked);
    make_folder(options.dir);
    write_plan(Folder(options.dir), plan);
    return plan;
#else
    (void)options, (void)words;
    throw Error(ErrorKind::BadScene, "--frames: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

PartCommand render_command(const FarmArguments& options, const std::vector<std::string>& words)
{
    PartCommand command{{"render", options.source.string(), "-o", (options.dir / "frame.png").string(), "--farm",
                         options.dir.string(), "--resume", "--numbered", "--quiet"},
                        "--frames"};
    command.words.insert(command.words.end(), words.begin(), words.end());
    return command;
}

/// What the words alone can get wrong, before anything is looked for or written.
void check_words(const FarmArguments& options)
{
    if (options.source.empty())
        throw Error(ErrorKind::BadScene,
                    "farm: got no work; expected a sweep or frames. Fix: give SCENE.toml --vary SWEEP.toml, or the folder of a "
                    "run with --frames 0:499");
    if (options.dir.empty()) throw Error(ErrorKind::BadScene, "farm: give a folder that all machines share with -o DIR");
    const bool frames = !options.frames.empty();
    if (!frames && !options.render.empty())
        throw Error(ErrorKind::BadScene, fmt::format("{}: unknown option; see `seldinger farm --help`", options.render.front()));
    if (frames == !options.sweep.empty())
        throw Error(ErrorKind::BadScene,
                    "farm: give either --vary SWEEP.toml (runs of a scene) or --frames A:B (pictures of a run)");
}

// ---------------------------------------------------------------- status, merge

struct Status {
    std::size_t items = 0;             // that are there
    std::vector<std::size_t> missing;  // parts
};

Status status_of(const Folder& dir, const PartPlan& plan)
{
    Status status;
    for (std::size_t part = 1; part <= plan.parts; ++part) {
        const std::size_t there = items_there(dir, plan, part);
        status.items += there;
        if (there < plan.size(part)) status.missing.push_back(part);
    }
    return status;
}

std::string head_of(const Folder& dir, const PartPlan& plan)
{
    return fmt::format("{}: {} {}s in {} tasks\n", dir.path().string(), plan.items, plan.item_word(), plan.parts);
}

ErrorKind show_status(const ViewOptions& options)
{
    const Folder dir(options.dir);
    const PartPlan plan = read_plan(dir);
    const Status status = status_of(dir, plan);
    const std::size_t done = plan.parts - status.missing.size();
    const std::string items = fmt::format("{}s", plan.item_word()), missing = list_ranges(status.missing);
    const Json out = {
        {items, plan.items}, {items + "_done", status.items}, {"tasks", plan.parts}, {"done", done}, {"missing", missing}};
    if (options.json) print(json_text(out, 2) + "\n");
    else
        print(head_of(dir, plan) + fmt::format("  {} tasks done, {} {}; {}\n", done, status.items, items,
                                               missing.empty() ? "all done: seldinger farm merge " + dir.path().string()
                                                               : "missing: tasks " + missing));
    return ErrorKind::None;
}

ErrorKind merge_frames(const Folder& dir, const PartPlan& plan, const ViewOptions& options)
{
    if (const Status status = status_of(dir, plan); !status.missing.empty()) say_missing(dir, plan, status.missing);
    const std::size_t end = plan.first + plan.items;
    std::string text = fmt::format("{}: {} frames: {} to {}\n", dir.path().string(), plan.items,
                                   frame_file(plan.files.front(), plan.first), frame_file(plan.files.front(), end - 1));
    std::vector<std::string> pictures;  // of each view
    for (const std::string& file : plan.files)
        if (file.starts_with("frame_") && file.ends_with(".png") && file.find('/') == std::string::npos) pictures.push_back(file);
    for (std::size_t k = 0; k < pictures.size() && !options.video.empty(); ++k) {
        fs::path name = options.video;
        if (pictures.size() > 1)
            name = name.parent_path() / fmt::format("{}_v{}{}", name.stem().string(), k + 1, name.extension().string());
        FilmWriter film(name, options.fps.value_or(plan.rate));
        for (std::size_t i = plan.first; i < end; ++i) film.add_png(read_file(dir / frame_file(pictures[k], i)));
        film.finish();
        text += name.string() + "\n";
    }
    print(text);
    return ErrorKind::None;
}

ErrorKind merge(const ViewOptions& options)
{
    const Folder dir(options.dir);
    const PartPlan plan = read_plan(dir);
    if (plan.of_dataset() && options.video.empty()) return finish_dataset(options.dir, false);
    if (plan.frames) return merge_frames(dir, plan, options);
    if (!options.video.empty())
        throw Error(ErrorKind::BadScene, "--video: a sweep has no pictures; it is for a farm of --frames");
    return merge_and_tell({options.dir});
}

// ---------------------------------------------------------------- farm

ErrorKind farm(FarmArguments& options)
{
    check_words(options);
    if (options.bands) options.overrides.push_back("output.bands=true");
    if (!options.keep.empty())
        for (const std::string& setting : keep_settings(options.keep)) options.overrides.push_back(setting);
    options.source = fs::absolute(options.source).lexically_normal();
    options.dir = fs::absolute(options.dir).lexically_normal();
    options.backend.check(options.dir);
    const bool frames = !options.frames.empty(), quiet = options.backend.local.quiet;
    const std::vector<std::string> words = farm_words(options.render);
    const PartPlan plan = frames ? plan_frames(options, words) : plan_sweep(options);
    return options.backend.run(options.dir, plan, frames ? render_command(options, words) : batch_command(options), [&] {
        if (!quiet) return merge({options.dir, {}, {}, false});
        return plan.frames ? ErrorKind::None : merge_parts({options.dir}).code;
    });
}

void add_status(CommandLine& farm_command, Command& chosen)
{
    auto options = std::make_shared<ViewOptions>();
    CommandLine* command = farm_command.add_subcommand("status", "show how much is done, and which tasks are missing");
    command->add_option("DIR", options->dir, "folder of a farm")->required();
    command->add_flag("--json", options->json, "as one JSON object");
    command->callback([options, &chosen] { chosen = [options] { return show_status(*options); }; });
}

void add_merge(CommandLine& farm_command, Command& chosen)
{
    auto options = std::make_shared<ViewOptions>();
    CommandLine* command =
        farm_command.add_subcommand("merge", "merge finished tasks: results.csv of a sweep, or a film of frames");
    command->add_option("DIR", options->dir, "folder of a farm")->required();
    command->add_option("--video", options->video, "film of the frames, by ffmpeg")->type_name("FILE.mp4");
    command->add_option("--fps", options->fps, "frames per second of the film (default: real time, at least 15)")
        ->check(in_range(0.1, 240.0))
        ->type_name("N");
    command->callback([options, &chosen] { chosen = [options] { return merge(*options); }; });
}

}  // namespace

void FarmBackend::declare(CommandLine& command)
{
    command.add_option("--tasks", tasks, "how many tasks (default: 8 for each of --jobs; slurm: 200)")
        ->type_name("N")
        ->check(in_range(1, 1000000));
    command.add_option("--backend", name, "local (this machine, now) or slurm (array jobs)")->check(one_of({"local", "slurm"}));
    command.add_option("--jobs", local.jobs, "local: tasks at a time (default 1)")->type_name("N")->check(in_range(1, 1024));
    command.add_option("--threads", local.threads, "local: threads of each task (default: all cores, divided by --jobs)")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command.add_option("--device", local.device, "local: OpenCL device, as `seldinger devices` lists them")->type_name("N");
    command.add_option("--sbatch", sbatch, "slurm: an option of the array job, e.g. --sbatch=--time=60; repeats")
        ->type_name("OPTION")
        ->allow_extra_args(false);
    auto* submit_flag = command.add_flag("--submit", submit, "slurm: submit the jobs (default: print the commands)");
    command.add_flag("--dry-run", dry_run, "prepare the folder and print a command for each task that is not done")
        ->excludes(submit_flag);
    command.add_flag("--quiet", local.quiet, "no progress, no status at the end");
}

void FarmBackend::check(const fs::path& dir) const
{
    if (submit && name != "slurm")
        throw Error(ErrorKind::BadScene, "--submit: got no --backend slurm; expected it. Fix: give both");
    if (submit) need_slurm();
    if (name == "slurm") check_job_script(dir, sbatch);
}

std::size_t FarmBackend::part_count(const fs::path& dir, std::size_t items, const char* word) const
{
    if (tasks && static_cast<std::size_t>(*tasks) > items)
        throw Error(ErrorKind::BadScene,
                    fmt::format("--tasks {}: there are only {} {}s; give that many or fewer", *tasks, items, word));
    if (tasks) return static_cast<std::size_t>(*tasks);
    if (fs::exists(dir / "parts.json")) return std::min(items, read_plan(Folder(dir)).parts);
    return std::min(items, name == "slurm" ? slurm_tasks : local_tasks * static_cast<std::size_t>(local.jobs));
}

ErrorKind FarmBackend::run(const fs::path& path, const PartPlan& plan, PartCommand command,
                           const std::function<ErrorKind()>& merge) const
{
    const Folder dir(path);
    command.words.insert(command.words.begin(), fs::read_symlink("/proc/self/exe").string());
    Status status = status_of(dir, plan);
    if (name == "slurm") {
        const auto array = write_slurm_job(dir, plan, command, sbatch, status.missing);
        const std::string merge_words = shell_text({command.words.front(), "farm", "merge", path.string()});
        print(head_of(dir, plan) + (status.missing.empty() ? fmt::format("  all done: seldinger farm merge {}\n", path.string())
                                    : submit               ? apps::submit(dir, array)
                                                           : fmt::format("  {}\n  then: {}\n", shell_text(array), merge_words)));
        return ErrorKind::None;
    }
    if (dry_run) {
        std::string text = "# " + head_of(dir, plan);
        for (const std::size_t part : status.missing) text += shell_text(command.of(plan, part)) + "\n";
        print(text);
        return ErrorKind::None;
    }
    const ErrorKind code = run_here(dir, plan, command, local);
    status = status_of(dir, plan);
    if (code == ErrorKind::TimeLimit || code == ErrorKind::Interrupted)
        throw Error(code, fmt::format("stopped with {} of {} tasks done; run the same command again to continue",
                                      plan.parts - status.missing.size(), plan.parts));
    if (!status.missing.empty())
        throw Error(ErrorKind::Stopped, fmt::format("{}: tasks {} are not done; run the same command again for them",
                                                    path.string(), list_ranges(status.missing)));
    return merge();
}

std::vector<std::string> PartCommand::of(const PartPlan& plan, std::size_t part) const
{
    const auto [begin, end] = plan.range(part);
    std::vector<std::string> all = words;
    all.push_back(option);
    all.push_back(plan.frames ? fmt::format("{}:{}", plan.first + begin, plan.first + end - 1)
                              : fmt::format("{}/{}", part, plan.parts));
    return all;
}

void check_farm_of(const fs::path& farm, const fs::path& run)
{
    if (const PartPlan plan = read_plan(Folder(farm)); !plan.key.starts_with(run_key(run)))
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: the run {} has changed since the farm was made, or this is another version ({}); "
                                "make a new farm",
                                farm.string(), run.string(), version()));
}

void add_farm(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<FarmArguments>();
    CommandLine* command = app.add_subcommand("farm", "divide a batch, or the frames of a run, into tasks for many machines");
    command->require_subcommand(0, 1);
    command->allow_extras();
    command->add_option("SOURCE", options->source, "scene file with --vary, or folder of a run with --frames");
    command->add_option("--vary", options->sweep, "sweep file, as for batch")->type_name("SWEEP.toml");
    command->add_option("--frames", options->frames, "frames of the run; options of render may follow (--view fluoro ...)")
        ->type_name("A:B|all");
    command->add_option("-o", options->dir, "folder that all machines share")->type_name("DIR");
    command->add_option("--set", options->overrides, "change a key of the scene for all runs; repeats")
        ->type_name("table.key=value")
        ->allow_extra_args(false);
    command->add_flag("--bands", options->bands, "each run a second time with half the step, as of batch");
    command->add_option("--keep", options->keep, "files of each run in DIR/runs, as of batch")->type_name("WHAT");
    options->backend.declare(*command);
    add_status(*command, chosen);
    add_merge(*command, chosen);
    command->callback([options, command, &chosen] {
        if (command->went_below()) return;
        options->render = command->remaining();
        chosen = [options] { return farm(*options); };
    });
}

}  // namespace seldinger::apps
