// Does a task of a sweep by the batch loop and one of frames by `render`, and writes its time to the log.
#include "farm_task.h"

#include "batch_loop.h"
#include "command_line.h"
#include "core/clock.h"
#include "core/file_io.h"
#include "core/note.h"
#include "core/parallel.h"
#include "core/printable.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

/// Since this process began, its loading included [s]; in steps of 10 ms.
double process_age()
{
    std::ifstream stat("/proc/self/stat"), uptime("/proc/uptime");
    std::string text, word;
    std::getline(stat, text);
    std::istringstream fields(text.substr(std::min(text.size(), text.rfind(')') + 1)));
    for (int k = 3; k <= 22; ++k) fields >> word;
    double up = 0;
    uptime >> up;
    return up - std::strtod(word.c_str(), nullptr) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

void check_key(const Folder& dir, const FarmPlan& plan, const std::string& now)
{
    if (now != plan.key)
        throw Error(
            ExitCode::BadScene,
            fmt::format("{}: {} or a file that it names has changed since the farm was made, or this is another version ({}); "
                        "make a new farm",
                        dir.path().string(), plan.source.string(), version()));
}

BatchPart run_part(const Folder& dir, const FarmPlan& plan, std::size_t task, const TaskOptions& options)
{
    std::string sweep_text;
    const BatchSource source = farm_source(dir, plan, sweep_text);
    check_key(dir, plan, sweep_key(source, sweep_text));
    RunOptions what;
    const Folder own = open_task_folder(dir, plan, task);
    what.use = FolderUse::Resume;
    what.device = options.device;
    what.quiet = true;
    what.keep = dir;
    const FarmPlan::Part part = plan.part(task);
    try {
        return run_batch_part(source, sweep_text, part.begin, part.end, own, what);
    } catch (const Error& error) {
        // a checkpoint that cannot be resumed costs its task, not the farm
        if (error.code() != ExitCode::BadFile || !own.has("checkpoint.bin")) throw;
        what.use = FolderUse::Overwrite;
        return run_batch_part(source, sweep_text, part.begin, part.end, own, what);
    }
}

/// How a task ended, and the seconds of the work itself.
struct Work {
    ExitCode code = ExitCode::Done;
    double seconds = 0;
};

Work do_runs(const Folder& dir, const FarmPlan& plan, std::size_t task, const TaskOptions& options)
{
    const BatchPart part = run_part(dir, plan, task, options);
    // runs in which no step converged are results like the others
    if (part.outcome.code != ExitCode::Done && part.outcome.code != ExitCode::Stopped) return {part.outcome.code, part.step_s};
    write_rows(dir, plan, task, part.rows);
    remove_batch(open_task_folder(dir, plan, task));
    close_task_folder(dir, task);
    return {ExitCode::Done, part.step_s};
}

Work do_frames(const Folder& dir, const FarmPlan& plan, std::size_t task)
{
    check_key(dir, plan, frames_key(plan.source, plan.first, plan.items, plan.render));
    const auto begun = Clock::now();
    try {
        (void)render_command(plan, plan.part(task), dir.path())();
    } catch (const Error& error) {
        if (error.code() != ExitCode::TimeLimit && error.code() != ExitCode::Interrupted) throw;
        return {error.code(), seconds_since(begun)};
    }
    return {ExitCode::Done, seconds_since(begun)};
}

ExitCode work_on(TaskClaim& claim, const Folder& dir, const FarmPlan& plan, std::size_t task, const TaskOptions& options)
{
    static bool first_of_process = true;
    const double before = first_of_process ? process_age() : 0;
    first_of_process = false;
    const auto begun = Clock::now();
    const std::string worker = farm_worker();
    log_event(dir, task, worker, {claim.taken_over() ? "taken-over" : "began", before, 0, {}});
    try {
        const Work work = plan.kind == FarmKind::Sweep ? do_runs(dir, plan, task, options) : do_frames(dir, plan, task);
        const bool done = work.code == ExitCode::Done;
        log_event(dir, task, worker, {done ? "finished" : "stopped", before + seconds_since(begun), work.seconds, {}});
        if (done) claim.finish();
        else claim.give_back();
        return work.code;
    } catch (const Error& error) {
        log_event(dir, task, worker, {"failed", before + seconds_since(begun), 0, one_line(error.what())});
        claim.give_back();
        throw;
    }
}

/// What a farm's pictures may be told: how they look and what else is known of them. All else of `render` says where to write, or is given
/// by the farm; a farm.json that somebody has altered, its key computed anew, is held against the same words.
constexpr const char* looks[] = {"--size",    "--camera", "--background", "--no-legend", "--wall",   "--wall-max",    "--force-max", "--view",
                                 "--c-arm",   "--views",  "--sid",        "--sod",       "--field",  "--kvp",         "--kev",       "--photons",
                                 "--blur",    "--body",   "--seed",       "--mask",      "--log",    "--no-contrast", "--no-noise",  "--labels",
                                 "--label-vessel"};

void check_render_word(const std::string& word)
{
    const bool is_option = word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9');
    const std::string name = word.substr(0, word.find('='));
    if (!is_option || std::find(std::begin(looks), std::end(looks), name) != std::end(looks)) return;
    throw Error(ExitCode::BadScene, fmt::format("{}: tasks of a farm make only numbered pictures and their labels; leave it out (a "
                                                "film: farm merge DIR --video FILE.mp4)",
                                                name));
}

/// The labels' folder lies below the farm's, where --labels-in has them made through no link. In one word with its option it is none of ours.
void check_render_words(const std::vector<std::string>& words)
{
    for (std::size_t k = 0; k < words.size(); ++k) {
        check_render_word(words[k]);
        const bool joined = words[k].starts_with("--labels=");
        if (!joined && (words[k] != "--labels" || (k + 1 < words.size() && leads_below(words[k + 1])))) continue;
        throw Error(ExitCode::BadScene, fmt::format("--labels: got {}; expected a folder below the farm's. Fix: give a name, --labels labels",
                                                    joined ? words[k].substr(9) : k + 1 < words.size() ? words[k + 1] : "nothing"));
    }
}

}  // namespace

std::string sweep_key(const BatchSource& source, const std::string& sweep_text)
{
    std::vector<std::string> parts = {version(), source.scene_text, sweep_text};
    parts.insert(parts.end(), source.overrides.begin(), source.overrides.end());
    const Scene scene = source.scene(0);
    if (!scene.vessel.mesh.empty()) parts.push_back(read_file(scene.vessel.mesh));
    return farm_key(parts);
}

std::string frames_key(const fs::path& run, std::size_t first, std::size_t frames, const std::vector<std::string>& render)
{
    std::vector<std::string> parts = {version(), read_file(run / "wire.pvd"), fmt::format("{} {}", first, frames)};
    parts.insert(parts.end(), render.begin(), render.end());
    for (std::size_t k = 0; k + 1 < render.size(); ++k)
        if (render[k] == "--views") parts.push_back(read_file(render[k + 1]));
    return farm_key(parts);
}

BatchSource farm_source(const Folder& dir, const FarmPlan& plan, std::string& sweep_text)
{
    sweep_text = read_file(dir / "farm-sweep.toml");
    return make_source(read_file(dir / "farm-scene.toml"), plan.source, plan.overrides, sweep_text, plan.sweep);
}

Command render_command(const FarmPlan& plan, FarmPlan::Part part, const fs::path& dir)
{
    CommandLine app("", "seldinger");
    Command chosen;
    add_render(app, chosen);
    std::vector<std::string> words = plan.render;
    for (std::string word :
         {std::string("render"), plan.source.string(), std::string("--frames"),
          fmt::format("{}:{}", plan.first + part.begin, plan.first + part.end - 1), std::string("-o"),
          (dir / "frame.png").string(), std::string("--labels-in"), dir.string(), std::string("--resume"), std::string("--numbered"), std::string("--quiet")})
        words.push_back(std::move(word));
    std::rotate(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(plan.render.size()), words.end());
    if (const CommandLine::Parsed parsed = app.parse(std::move(words)); !parsed.error.empty())
        throw Error(ExitCode::BadScene, parsed.error + "; see `seldinger render --help`");
    check_render_words(plan.render);
    return chosen;
}

ExitCode do_task(const Folder& dir, const FarmPlan& plan, std::size_t task, const TaskOptions& options)
{
    set_thread_count(options.threads);
    reopen_if_lost(dir, plan, task);
    std::optional<TaskClaim> claim = TaskClaim::take(dir, task, farm_worker());
    if (!claim) return ExitCode::Done;
    if (has_result(dir, plan, task)) {  // its worker was killed after it had done it
        claim->finish();
        return ExitCode::Done;
    }
    return work_on(*claim, dir, plan, task, options);
}

ExitCode do_all_tasks(const Folder& dir, const FarmPlan& plan, const TaskOptions& options)
{
    ExitCode worst = ExitCode::Done;
    for (std::size_t task = 0; task < plan.tasks; ++task) {
        try {
            const ExitCode code = do_task(dir, plan, task, options);
            if (code == ExitCode::TimeLimit || code == ExitCode::Interrupted) return code;
        } catch (const Error& error) {
            note(fmt::format("seldinger: task {}: {}\n", task, error.what()));
            worst = error.code();
        }
    }
    return worst;
}

}  // namespace seldinger::apps
