// seldinger farm SCENE.toml --vary SWEEP.toml | RUN --frames A:B | all  -o DIR [--backend slurm | local] [--tasks N] [--jobs N]
//                [--set ...] [--sbatch OPTION]... [--submit | --dry-run] [options of render]
// seldinger farm status DIR · farm merge DIR [--video FILE.mp4 [--fps N]] · farm task DIR N | --all

#include "batch_loop.h"
#include "command_line.h"
#include "commands.h"
#include "core/child_process.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "farm_backend.h"
#include "farm_task.h"
#include "io/film_write.h"
#include "io/json_text.h"
#include "render_frames.h"
#include "run/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <optional>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t usual_tasks = 200;  // enough that a lost one is little work, few enough that starting them is

struct FarmArguments {
    fs::path source, sweep, dir;
    std::vector<std::string> overrides, sbatch, render;
    std::string frames, backend = "local";
    std::optional<int> tasks;
    LocalBackend local;
    std::string keep;
    bool bands = false, submit = false, dry_run = false;
};

struct ViewOptions {
    fs::path dir, video;
    std::optional<double> fps;
    bool json = false;
};

std::size_t task_count(const FarmArguments& options, const FarmPlan& plan)
{
    if (options.tasks && static_cast<std::size_t>(*options.tasks) > plan.items)
        throw Error(ExitCode::BadScene, fmt::format("--tasks {}: there are only {} {}s; give that many or fewer", *options.tasks,
                                                    plan.items, plan.item_word()));
    return options.tasks ? static_cast<std::size_t>(*options.tasks) : std::min(plan.items, usual_tasks);
}

/// The scene as a batch reads it, every run's values tried.
FarmPlan plan_sweep(const FarmArguments& options, std::string& scene_text, std::string& sweep_text)
{
    scene_text = read_file(options.source);
    sweep_text = read_file(options.sweep);
    FarmPlan plan;
    plan.source = fs::absolute(options.source).lexically_normal();
    plan.sweep = options.sweep;
    plan.overrides = options.overrides;
    const BatchSource source = make_source(scene_text, plan.source, options.overrides, sweep_text, options.sweep);
    (void)plan_worlds(source);
    plan.items = source.item_count();
    plan.tasks = task_count(options, plan);
    plan.key = sweep_key(source, sweep_text);
    return plan;
}

/// Each value as a separate word, and paths that do not depend on where a task starts.
std::vector<std::string> farm_words(const std::vector<std::string>& given)
{
    std::vector<std::string> words;
    for (const std::string& word : given) {
        const std::size_t equals = word.starts_with("--") ? word.find('=') : std::string::npos;
        words.push_back(word.substr(0, equals));
        if (equals != std::string::npos) words.push_back(word.substr(equals + 1));
    }
    for (std::size_t k = 0; k + 1 < words.size(); ++k)
        if (words[k] == "--views") words[k + 1] = fs::absolute(words[k + 1]).lexically_normal().string();
        else if (words[k] == "--labels") words[k + 1] = (fs::path(words[k + 1]) / "").lexically_normal().parent_path().string();
    return words;
}

FarmPlan plan_frames(const FarmArguments& options)
{
#ifdef SEL_WITH_VIEW
    FarmPlan plan;
    plan.kind = FarmKind::Frames;
    plan.source = fs::absolute(options.source).lexically_normal();
    plan.render = farm_words(options.render);
    plan.files = files_of_frame(plan.render);
    const std::size_t count = read_run_folder(plan.source).frames.size();
    FrameChoice choice;
    choice.first = 0, choice.last = static_cast<int>(count) - 1;
    if (options.frames != "all") {
        const auto [first, last] = two_numbers(options.frames, ':', "--frames", "FIRST:LAST, e.g. 0:499, or all");
        choice.first = first, choice.last = last;
    }
    const FrameRange range = frames_asked(choice, count);
    plan.first = range.first;
    plan.items = range.count();
    plan.tasks = task_count(options, plan);
    plan.key = frames_key(plan.source, plan.first, plan.items, plan.render);
    (void)render_command(plan, plan.part(0), options.dir);
    return plan;
#else
    (void)options;
    throw Error(ExitCode::BadScene, "--frames: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

/// What the words alone can get wrong, before anything is looked for or written.
void check_words(const FarmArguments& options)
{
    if (options.source.empty())
        throw Error(ExitCode::BadScene,
                    "farm: got no work; expected a sweep or frames. Fix: give SCENE.toml --vary SWEEP.toml, or the folder of a run with --frames 0:499");
    if (options.dir.empty()) throw Error(ExitCode::BadScene, "farm: give a folder that all machines share with -o DIR");
    if (options.submit && options.backend != "slurm")
        throw Error(ExitCode::BadScene, "--submit: got no --backend slurm; expected it. Fix: give both");
    const bool frames = !options.frames.empty();
    if (!frames && !options.render.empty())
        throw Error(ExitCode::BadScene, fmt::format("{}: unknown option; see `seldinger farm --help`", options.render.front()));
    if (frames == !options.sweep.empty())
        throw Error(ExitCode::BadScene,
                    "farm: give either --vary SWEEP.toml (runs of a scene) or --frames A:B (pictures of a run)");
}

/// Plans the farm and prepares its folder, or finds it prepared.
std::pair<Folder, FarmPlan> make_farm(const FarmArguments& options)
{
    std::string scene_text, sweep_text;
    const bool frames = !options.frames.empty();
    const FarmPlan plan = frames ? plan_frames(options) : plan_sweep(options, scene_text, sweep_text);
    make_folder(options.dir);
    Folder dir(options.dir);
    // one after the other: a task that another command's worker has begun would be waiting once more
    const FileLock one_at_a_time = FileLock::of_file(dir / "farm.json", std::chrono::hours(1));
    if (!frames && !dir.has("farm.json")) {
        if (dir.has("results.csv")) throw Error(ExitCode::BadScene, options.dir.string() + ": holds a batch; choose another folder with -o");
        write_file(dir / "farm-scene.toml", scene_text);
        write_file(dir / "farm-sweep.toml", sweep_text);
    }
    write_farm(dir, plan);
    return {std::move(dir), plan};
}

std::string status_text(const Folder& dir, const FarmPlan& plan, const FarmReport& r)
{
    std::string text =
        fmt::format("{}: {} {}s in {} tasks\n  {} done, {} running, {} waiting, {} lost (their workers are dead)\n", dir.path().string(),
                    plan.items, plan.item_word(), plan.tasks, r.count(TaskState::Done), r.count(TaskState::Running),
                    r.count(TaskState::Todo), r.count(TaskState::Lost));
    text += fmt::format("  begun {} times: {} begun again after a kill or a stop, {} done again that had finished\n", r.began,
                        r.begun_again, r.finished_again);
    if (r.count(TaskState::Done) > 0)
        text += fmt::format("  work {:.3g} s in all; overhead of a task {:.3g} s (median), {:.3g} s (longest)\n", r.work_s,
                            r.overhead_median_s, r.overhead_max_s);
    for (const auto& [task, why] : r.failed) text += fmt::format("  task {} failed: {}\n", task, why);
    if (r.count(TaskState::Done) == plan.tasks) text += fmt::format("  all done: seldinger farm merge {}\n", dir.path().string());
    return text;
}

Json status_json(const FarmPlan& plan, const FarmReport& r)
{
    Json out;
    out[plan.kind == FarmKind::Sweep ? "runs" : "frames"] = plan.items;
    out["tasks"] = plan.tasks;
    out["done"] = r.count(TaskState::Done);
    out["running"] = r.count(TaskState::Running);
    out["waiting"] = r.count(TaskState::Todo);
    out["lost"] = r.count(TaskState::Lost);
    out["begun"] = r.began;
    out["begun_again"] = r.begun_again;
    out["finished_again"] = r.finished_again;
    out["failed"] = r.failed.size();
    out["work_s"] = r.work_s;
    out["overhead_median_s"] = r.overhead_median_s;
    out["overhead_max_s"] = r.overhead_max_s;
    out["missing"] = r.list_missing();
    return out;
}

ExitCode farm(FarmArguments& options)
{
    check_words(options);
    if (options.bands) options.overrides.push_back("output.bands=true");
    if (!options.keep.empty())
        for (const std::string& setting : keep_settings(options.keep)) options.overrides.push_back(setting);
    if (options.submit) need_slurm();
    options.dir = fs::absolute(options.dir).lexically_normal();
    if (options.backend == "slurm") check_job_scripts(options.dir, options.sbatch);
    const auto [dir, plan] = make_farm(options);
    const std::string head =
        fmt::format("{}: {} {}s in {} tasks\n", options.dir.string(), plan.items, plan.item_word(), plan.tasks);
    if (options.backend == "slurm") {
        const auto arrays = write_slurm_jobs(dir, plan, {options.sbatch});
        std::string text = head;
        if (options.submit) text += submit(dir, arrays);
        else
            for (const auto& array : arrays) text += "  " + shell_text(array) + "\n";
        if (arrays.empty()) text += fmt::format("  all done: seldinger farm merge {}\n", options.dir.string());
        print(text);
        return ExitCode::Done;
    }
    if (options.dry_run) {
        print(head + fmt::format("  seldinger farm task {} --all\n", options.dir.string()));
        return ExitCode::Done;
    }
    const ExitCode code = run_here(dir, plan, options.local);
    const FarmReport report = look_at_farm(dir, plan);
    if (!options.local.quiet) print(status_text(dir, plan, report));
    if (code == ExitCode::TimeLimit || code == ExitCode::Interrupted)
        throw Error(code, fmt::format("stopped with {} of {} tasks done; run the same command again to continue",
                                      report.count(TaskState::Done), plan.tasks));
    if (report.count(TaskState::Done) < plan.tasks)
        throw Error(ExitCode::Stopped, fmt::format("{}: tasks {} are not done; `seldinger farm status {}` says why",
                                                   options.dir.string(), report.list_missing(), options.dir.string()));
    return ExitCode::Done;
}

// ---------------------------------------------------------------- merge

[[noreturn]] void say_missing(const Folder& dir, const FarmPlan& plan, const std::vector<std::size_t>& tasks)
{
    std::vector<std::size_t> items;
    for (const std::size_t t : tasks)
        for (std::size_t i = plan.part(t).begin; i < plan.part(t).end; ++i) items.push_back(plan.first + i);
    throw Error(
        ExitCode::BadFile,
        fmt::format("{}: {} of {} tasks are missing: {} ({}s {}); do them (the same `seldinger farm` again) and merge then",
                    dir.path().string(), tasks.size(), plan.tasks, list_ranges(tasks), plan.item_word(), list_ranges(items)));
}

ExitCode merge_sweep(const Folder& dir, const FarmPlan& plan)
{
    std::string sweep_text;
    const BatchSource source = farm_source(dir, plan, sweep_text);
    const Scene first = source.scene(0);
    std::vector<BatchRow> rows;
    std::vector<std::size_t> missing;
    for (std::size_t t = 0; t < plan.tasks; ++t) {
        const auto part = read_rows(dir, plan, t, static_cast<std::size_t>(first.instrument_count()));
        if (part) rows.insert(rows.end(), part->begin(), part->end());
        else missing.push_back(t);
    }
    if (!missing.empty()) say_missing(dir, plan, missing);
    Json summary;
    summary["name"] = first.name;
    summary["status"] = "done";
    add_answer(summary, source, rows);
    summary["results"] = "results.csv";
    summary["version"] = version();
    summary["farm"] = status_json(plan, look_at_farm(dir, plan));
    write_file(dir / "scene.toml", resolved_scene(source, dir.path()));
    write_file(dir / "sweep.toml", sweep_text);
    if (const LoadedVessel vessel = load_vessel(first.vessel); !vessel.mesh.triangles.empty()) write_file(dir / "vessel.vtp", wall_vtp(vessel.mesh));
    write_file(dir / "summary.json", json_text(summary, 2) + "\n");
    write_tables(dir, source, rows);
    const auto stopped = summary["stopped"].get<long>();
    const std::string answer = summary["answer"].get<std::string>();
    print(fmt::format("{}: {} runs, {} stopped: results.csv, results-units.csv, results.npz, shapes.csv, summary.json\n{}", dir.path().string(),
                      source.sweep.run_count(), stopped, answer.empty() ? "" : answer + "\n"));
    return stopped > 0 ? ExitCode::Stopped : ExitCode::Done;
}

ExitCode merge_frames(const Folder& dir, const FarmPlan& plan, const ViewOptions& options)
{
    std::vector<std::size_t> missing;
    for (std::size_t t = 0; t < plan.tasks; ++t) {
        if (!has_result(dir, plan, t)) missing.push_back(t);
    }
    if (!missing.empty()) say_missing(dir, plan, missing);
    std::string text =
        fmt::format("{}: {} frames: {} to {}\n", dir.path().string(), plan.items, frame_file(plan.files.front(), plan.first),
                    frame_file(plan.files.front(), plan.first + plan.items - 1));
#ifdef SEL_WITH_VIEW
    if (!options.video.empty()) {
        FrameChoice choice;
        choice.rate = options.fps.value_or(0);
        const FrameRange range{plan.first, plan.first + plan.items - 1};
        const double rate = choice.rate > 0 ? choice.rate : film_rate(choice, read_run_folder(plan.source), range);
        std::vector<std::string> pictures;  // of each view
        for (const std::string& file : plan.files)
            if (file.starts_with("frame_") && file.ends_with(".png") && file.find('/') == std::string::npos) pictures.push_back(file);
        for (std::size_t k = 0; k < pictures.size(); ++k) {
            fs::path name = options.video;
            if (pictures.size() > 1)
                name = name.parent_path() / fmt::format("{}_v{}{}", name.stem().string(), k + 1, name.extension().string());
            FilmWriter film(name, rate);
            for (std::size_t i = range.first; i <= range.last; ++i) film.add_png(read_file(dir / frame_file(pictures[k], i)));
            film.finish();
            text += name.string() + "\n";
        }
    }
#endif
    print(text);
    return ExitCode::Done;
}

ExitCode merge(const ViewOptions& options)
{
    const Folder dir(options.dir);
    const FarmPlan plan = read_farm(dir);
    if (plan.kind == FarmKind::Frames) return merge_frames(dir, plan, options);
    if (!options.video.empty()) throw Error(ExitCode::BadScene, "--video: a sweep has no pictures; it is for a farm of --frames");
    return merge_sweep(dir, plan);
}

void add_status(CommandLine& farm_command, Command& chosen)
{
    auto options = std::make_shared<ViewOptions>();
    CommandLine* command = farm_command.add_subcommand("status", "show the state of each task");
    command->add_option("DIR", options->dir, "folder of a farm")->required();
    command->add_flag("--json", options->json, "as one JSON object");
    command->callback([options, &chosen] {
        chosen = [options] {
            const Folder dir(options->dir);
            const FarmPlan plan = read_farm(dir);
            const FarmReport report = look_at_farm(dir, plan);
            print(options->json ? json_text(status_json(plan, report), 2) + "\n" : status_text(dir, plan, report));
            return ExitCode::Done;
        };
    });
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

void add_task(CommandLine& farm_command, Command& chosen)
{
    struct One {
        fs::path dir;
        std::optional<std::size_t> task;
        bool all = false;
        pid_t parent = 0;
        TaskOptions how;
    };
    auto options = std::make_shared<One>();
    CommandLine* command = farm_command.add_subcommand("task", "run one task, or all that are waiting (called by the backends)");
    command->add_option("DIR", options->dir, "folder of a farm")->required();
    command->add_option("N", options->task, "task, from 0");
    command->add_flag("--all", options->all, "every task that is neither finished nor running");
    command->add_option("--threads", options->how.threads, "threads of the host (default: all cores)")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command->add_option("--device", options->how.device, "OpenCL device, as `seldinger devices` lists them")->type_name("N");
    command->add_option("--parent", options->parent)->hidden();  // of a worker of `farm` here: ends with it, its state saved
    command->callback([options, &chosen] {
        chosen = [options] {
            if (options->parent > 0) end_with_parent(options->parent, SIGTERM);
            const Folder dir(options->dir);
            const FarmPlan plan = read_farm(dir);
            if (options->all == options->task.has_value())
                throw Error(ExitCode::BadScene, "farm task: give the number of a task, or --all");
            if (options->all) return do_all_tasks(dir, plan, options->how);
            if (*options->task >= plan.tasks)
                throw Error(ExitCode::BadScene,
                            fmt::format("task {}: the farm has tasks 0 to {}", *options->task, plan.tasks - 1));
            return do_task(dir, plan, *options->task, options->how);
        };
    });
}

}  // namespace

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
    command->add_option("--tasks", options->tasks, "how many tasks (default: 200, or one for each run or frame)")
        ->type_name("N")
        ->check(in_range(1, 1000000));
    command->add_option("--backend", options->backend, "local (this machine, now) or slurm (array jobs)")
        ->check(one_of({"local", "slurm"}));
    command->add_option("--jobs", options->local.jobs, "local: tasks at a time (default 1)")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command->add_option("--threads", options->local.threads, "local: threads of each task (default: all cores, divided by --jobs)")
        ->type_name("N")
        ->check(in_range(1, 1024));
    command->add_option("--device", options->local.device, "local: OpenCL device, as `seldinger devices` lists them")
        ->type_name("N");
    command->add_option("--sbatch", options->sbatch, "slurm: an option of the array job, e.g. --sbatch=--time=60; repeats")
        ->type_name("OPTION")
        ->allow_extra_args(false);
    auto* submit_flag = command->add_flag("--submit", options->submit, "slurm: submit the jobs (default: print the commands)");
    command->add_flag("--dry-run", options->dry_run, "prepare the folder and print what would be done")->excludes(submit_flag);
    command->add_flag("--quiet", options->local.quiet, "no progress, no status at the end");
    add_status(*command, chosen);
    add_merge(*command, chosen);
    add_task(*command, chosen);
    command->callback([options, command, &chosen] {
        if (command->went_below()) return;
        options->render = command->remaining();
        chosen = [options] { return farm(*options); };
    });
}

}  // namespace seldinger::apps
