// The loop of `seldinger batch`: worlds one after the other, results table, checkpoints, Ctrl-C and time limit between steps.
#include "batch_loop.h"

#include "core/clock.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/note.h"
#include "core/parallel.h"
#include "io/json_text.h"
#include "progress.h"
#include "run/frames.h"
#include "scene/scene_difference.h"
#include "scene/toml_parse.h"
#include "batch/batch_answer.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr double save_seconds = 5;
constexpr double save_share = 50;  // saves, of hundreds of megabytes for a thousand wires, take at most a fiftieth of the time
constexpr const char* batch_files[] = {"results.csv", "results-units.csv", "results.npz", "shapes.csv", "sweep.toml"};

void check_batch_folder(const Folder& folder, FolderUse use, const BatchSource& source, const std::string& sweep_text)
{
    const fs::path& dir = folder.path();
    std::error_code ignored;
    for (const fs::path& given : {source.scene_file, source.sweep.source})
        for (const char* name : {"scene.toml", "sweep.toml"})
            if (fs::equivalent(dir / name, given, ignored) && !folder.has("checkpoint.bin"))
                throw Error(ErrorKind::BadScene,
                            fmt::format("{}: {} lies there itself and would be overwritten; choose another folder with -o",
                                        dir.string(), given.string()));
    if (folder.has("parts.json"))
        throw Error(ErrorKind::BadScene, dir.string() + ": holds a batch in parts (--part, farm); choose another folder with -o");
    if (!holds_a_batch(folder)) return;
    if (use == FolderUse::Refuse)
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: holds a run already; give --resume to continue it, --overwrite to replace it, "
                                "or another folder with -o",
                                dir.string()));
    if (use == FolderUse::Overwrite || !folder.has("checkpoint.bin")) return;
    const bool same = folder.has("sweep.toml") && read_file(folder / "sweep.toml") == sweep_text &&
                      read_file(folder / "scene.toml") == resolved_scene(source, dir);
    if (!same)
        throw Error(ErrorKind::BadScene,
                    fmt::format("{}: scene.toml or sweep.toml differs from what is to be resumed; give the same scene, sweep "
                                "and --set, or --overwrite",
                                dir.string()));
}

/// What killed processes have left of a file. Who calls has its lock.
void remove_half_written(const Folder& folder, const std::string& name)
{
    for (const std::string& other : folder.names())
        if (other.starts_with(name + ".") && other.ends_with(".tmp")) (void)folder.remove(other);
}

/// Runs of a sweep that one call does, and where they are saved.
struct Task {
    FilePlace file;
    std::size_t begin, end;
    std::string scene;  // of SavedBatch
    bool whole;         // else a part: tables and summary are left to the merge
};

class Batch {
public:
    Batch(const BatchSource& source, const std::string& sweep_text, Task task, const Folder& folder, const RunOptions& options)
        : source_(source), options_(options), folder_(folder), task_(std::move(task))
    {
        const Scene first = source.scene(0);
        now_.scene = task_.scene, now_.sweep = sweep_text;
        now_.name = first.name, now_.seed = source.seed, now_.layout = source.layout();
        now_.instruments = static_cast<std::uint64_t>(first.instrument_count());
        now_.begin = task_.begin, now_.end = task_.end;
        now_.ramp = options.time_limit > 0;  // worlds that grow: a limit may stop this
        worlds_ = plan_worlds(source, task_.begin, task_.end, now_.ramp, &warnings_);
        planning_.reset();
        const std::string saved = task_.file.path().filename().string();
        if (options.use == FolderUse::Resume && (task_.whole ? folder : folder.make("parts")).has(saved)) {
            restore();
            return;
        }
        if (task_.whole) remove_batch(folder);
        if (!folder.has("scene.toml")) write_file(folder / "scene.toml", resolved_scene(source, folder.path()));
        if (!folder.has("sweep.toml")) write_file(folder / "sweep.toml", sweep_text);
    }

    RunOutcome go(Clock::time_point called)
    {
        start_ = last_save_ = Clock::now();
        earlier_wall_ = now_.totals.wall;
        BatchProgress progress(task_.end - task_.begin, options_.quiet);
        for (bool first = true; now_.at < worlds_.size();) {
            if (!world_) open_world();
            for (; !world_->finished(); first = false) {
                if (stop_asked_for() != 0)
                    return stop(stop_asked_for() == SIGINT ? RunStatus::Interrupted : RunStatus::TimeLimit);
                if (!first && options_.time_limit > 0 && seconds_since(called) >= options_.time_limit)
                    return stop(RunStatus::TimeLimit);
                take_step();
                if (seconds_since(last_save_) >= std::max(save_seconds, save_share * save_cost_)) save(RunStatus::Running);
                progress.show(now_.rows.size(), now_.at, worlds_.size(), *world_,
                              static_cast<double>(now_.totals.wire_steps) / wall());
            }
            now_.device = world_->world().device_name();
            world_.reset();
            ++now_.at;
        }
        return stop(RunStatus::Done);
    }

private:
    double wall() const { return earlier_wall_ + seconds_since(start_); }

    void open_world()
    {
        const NoPolling loading;
        // worlds in a row often share the vessel: it is loaded once
        Scene scene = source_.scene(0);
        scene.vessel = source_.scene(worlds_[now_.at].front()).vessel;
        std::string key = write_scene(scene, folder_.path());
        if (key != vessel_key_) vessel_ = load_vessel(scene.vessel);
        vessel_key_ = std::move(key);
        world_.emplace(source_, worlds_[now_.at], vessel_, options_.device);
        // of run 0: the vessel is seldom varied
        if (task_.begin == 0 && now_.at == 0 && !vessel_.mesh.triangles.empty())
            write_file(folder_ / "vessel.vtp", wall_vtp(vessel_.mesh));
        now_.device = world_->world().device_name();
    }

    void take_step()
    {
        const StageTimes before = world_->stages();
        now_.totals.wire_steps += static_cast<std::int64_t>(world_->running());
        now_.totals.world_steps++;
        for (BatchRow& row : world_->step()) now_.rows.push_back(row);
        write_kept(folder_, world_->take_kept());
        now_.totals.stages += world_->stages();
        now_.totals.stages -= before;
    }

    void save(RunStatus status)
    {
        const auto begun = Clock::now();
        now_.status = status, now_.open = world_.has_value(), now_.totals.wall = wall();
        if (task_.whole) write_tables(folder_, {source_.sweep, now_.layout}, now_.rows);
        write_saved(task_.file, now_, [this](std::vector<std::uint8_t>& bytes) {
            const std::uint64_t vessel = hash_of(world_->world().setup().mesh);
            put_bytes(bytes, &vessel, 1);
            world_->save(bytes);
        });
        last_save_ = Clock::now();
        save_cost_ = seconds_since(begun);
    }

    [[noreturn]] void refuse(const std::string& what) const
    {
        throw Error(ErrorKind::BadFile, fmt::format("{}: {}; run again with --overwrite", task_.file.path().string(), what));
    }

    void restore()
    {
        std::vector<std::uint8_t> world;
        SavedBatch saved = read_saved(task_.file, world);
        if (saved.scene + saved.sweep != now_.scene + now_.sweep)
            refuse("is of another scene or sweep, " + first_difference(saved.scene + saved.sweep, now_.scene + now_.sweep));
        // the worlds are those that it was begun with, whether or not there is a limit now
        if (now_.ramp != saved.ramp) worlds_ = plan_worlds(source_, task_.begin, task_.end, saved.ramp);
        if (saved.begin != now_.begin || saved.end != now_.end || saved.instruments != now_.instruments ||
            saved.at > worlds_.size() || (saved.open && saved.at == worlds_.size()))
            refuse("is corrupt: a value is out of range");
        now_ = std::move(saved);
        if (now_.open) restore_world(world);
        saved_as_done_ = now_.status == RunStatus::Done;
        if (!saved_as_done_) now_.totals.resumes++;
    }

    void restore_world(const std::vector<std::uint8_t>& world)
    {
        const std::string before = now_.device;
        open_world();
        const std::uint8_t *at = world.data(), *end = at + world.size();
        std::uint64_t vessel = 0;
        take_bytes(at, end, &vessel, 1);
        if (vessel != hash_of(world_->world().setup().mesh)) refuse("the vessel has changed since the batch began");
        if (before != now_.device && !options_.quiet)
            note(fmt::format("seldinger: resumed on \"{}\" after \"{}\": the bits may differ from a batch in one piece\n",
                             now_.device, before));
        try {
            world_->restore(at, end);
        } catch (const Error& error) {
            refuse(error.what());
        }
        if (at != end) refuse("has data after its end");
    }

    std::string summary(RunStatus status) const
    {
        const BatchTotals& totals = now_.totals;
        const double to_ms = 1e3 / static_cast<double>(std::max<std::int64_t>(totals.world_steps, 1));
        const StageTimes& s = totals.stages;
        Json out;
        out["name"] = now_.name;
        out["status"] = status_word(status);
        add_answer(out, {source_.sweep, now_.layout}, now_.rows);
        if (!warnings_.empty()) out["warnings"] = warnings_;
        out["results"] = "results.csv";
        out["worlds"] = worlds_.size();
        out["wire_steps"] = totals.wire_steps;
        out["version"] = version();
        out["resumes"] = totals.resumes;
        out["threads"] = thread_count();
        out["device"] = now_.device;
        out["wall_s"] = totals.wall;
        out["wire_steps_per_s"] = static_cast<double>(totals.wire_steps) / std::max(totals.wall, 1e-9);
        out["stage_ms"] = {{"detect", s.detect * to_ms}, {"evaluate", s.evaluate * to_ms}, {"reduce", s.reduce * to_ms},
                           {"solve", s.solve * to_ms},   {"wall", 0.0},                    {"adapt", s.adapt * to_ms}};
        return json_text(out, 2) + "\n";
    }

    RunOutcome stop(RunStatus status)
    {
        if (status != RunStatus::Done || !saved_as_done_) save(status);
        RunOutcome outcome{ErrorKind::None, summary(status), {}};
        if (task_.whole) write_file(folder_ / "summary.json", outcome.summary);
        const std::string saved =
            fmt::format("with {} of {} runs done, state saved in {}; run again{}", now_.rows.size(), task_.end - task_.begin,
                        folder_.path().string(), task_.whole ? " with --resume" : "");
        if (status == RunStatus::TimeLimit)
            outcome.code = ErrorKind::TimeLimit, outcome.message = "stopped by a limit or SIGTERM " + saved;
        if (status == RunStatus::Interrupted) outcome.code = ErrorKind::Interrupted, outcome.message = "interrupted " + saved;
        if (status != RunStatus::Done || !task_.whole) return outcome;  // runs that stopped are results of a part like the others
        std::int64_t stopped = 0, first = -1;
        const auto runs = static_cast<std::int64_t>(source_.sweep.run_count());
        for (const BatchRow& row : now_.rows)
            if (row.run < runs && row.status == RunStatus::Stopped && (stopped++ == 0 || row.run < first)) first = row.run;
        if (stopped == 0) return outcome;
        outcome.code = ErrorKind::Stopped;
        outcome.message = fmt::format(
            "{} of {} runs stopped where no step converged, run {} first; see the column status of {}; make scene.dt_s smaller "
            "or contact.stiffness lower there",
            stopped, std::min<std::size_t>(now_.rows.size(), source_.sweep.run_count()), first,
            (folder_.path() / "results.csv").string());
        return outcome;
    }

    const BatchSource& source_;
    const RunOptions& options_;
    const Folder folder_;
    const Task task_;
    std::vector<std::string> warnings_;  // of the scenes
    std::optional<NoPolling> planning_{std::in_place};  // until worlds_ are known
    std::vector<std::vector<std::size_t>> worlds_;  // runs of each
    SavedBatch now_;
    bool saved_as_done_ = false;
    std::optional<BatchWorld> world_;  // worlds_[now_.at]
    LoadedVessel vessel_;
    std::string vessel_key_;
    double save_cost_ = 0;  // [s] of the last one
    double earlier_wall_ = 0;
    Clock::time_point start_, last_save_;
};

}  // namespace

void write_tables(const Folder& folder, const BatchTable& table, const std::vector<BatchRow>& rows)
{
    write_file(folder / "results-units.csv", batch_units_csv(table.sweep, table.layout));
    write_file(folder / "shapes.csv", batch_shapes_csv(table.layout, rows));
    write_file(folder / "results.npz", batch_npz(table.sweep, table.layout, rows));
    write_file(folder / "results.csv", batch_csv(table.sweep, table.layout, rows));
}

void add_answer(Json& summary, const BatchTable& table, const std::vector<BatchRow>& rows)
{
    const auto& [sweep, layout] = table;
    const std::vector<RunRows> runs = rows_by_run(layout, rows);
    const auto stopped = static_cast<std::size_t>(
        std::count_if(runs.begin(), runs.end(), [](const RunRows& of) { return of.row->status == RunStatus::Stopped; }));
    const BatchAnswer answer = answer_of(layout, rows);
    summary["runs"] = sweep.run_count();
    summary["done"] = runs.size() - stopped;
    summary["stopped"] = stopped;
    Json branches = Json::object(), paths = Json::object(), left = Json::object();
    for (const auto& [branch, count] : answer.ends.branches) branches[std::to_string(branch)] = count;
    for (const auto& [place, count] : answer.ends.places)
        if (!place.second.empty()) paths[place.second] = count;
    for (const auto& [inlet, count] : answer.ends.left) left[std::to_string(inlet)] = count;
    summary["branches"] = std::move(branches);
    summary["branch_paths"] = std::move(paths);
    summary["left_through"] = std::move(left);
    if (layout.task) {
        Json ranking = Json::array();
        for (const BatchAnswer::Ranked& one : answer.ranking)
            ranking.push_back({{"run", one.run},
                               {"label", label_of(sweep, one.run)},
                               {"until_patch_force_max_n", one.value},
                               {"band_n", std::isfinite(one.band) ? Json(one.band) : Json()}});
        summary["task"] = {{"target", layout.target},
                           {"reached", answer.reached},
                           {"passed", answer.passed},
                           {"force_patch_m", layout.patch},
                           {"ranking", std::move(ranking)}};
    }
    summary["answer"] = answer_line(sweep, layout, answer);
    constexpr std::size_t wall_band = column_index("wall_move_max_band_m");
    if (std::any_of(rows.begin(), rows.end(), [](const BatchRow& row) { return row.numbers[wall_band] > 0; }))
        summary["wall_bands"] =
            layout.bands ? "of control mesh, linear theory, nodes and step"
                         : "of control mesh, linear theory and nodes; with --bands, and of `seldinger run`, of the step too";
}

std::string resolved_scene(const BatchSource& source, const fs::path& dir)
{
    return write_scene(read_scene_text(source.scene_text, source.scene_file, source.overrides), dir);
}

RunOutcome run_batch(const fs::path& scene, const fs::path& sweep, const RunOptions& options)
{
    const auto called = Clock::now();
    const StopSignal listening;
    const std::string sweep_text = with_designs(read_scene_file(sweep), sweep);
    const BatchSource source = make_source(read_scene_file(scene), scene, options.overrides, sweep_text, sweep);
    const FileLock lock = FileLock::of_folder(options.dir);
    const Folder folder(options.dir);
    check_batch_folder(folder, options.use, source, sweep_text);
    const Task all{folder / "checkpoint.bin", 0, source.item_count(), resolved_scene(source, folder.path()), true};
    return Batch(source, sweep_text, all, folder, options).go(called);
}

RunOutcome run_batch_part(const fs::path& scene, const fs::path& sweep, const PartChoice& which, RunOptions options)
{
    const auto called = Clock::now();
    const StopSignal listening("run the same command again");
    const std::string sweep_text = with_designs(read_scene_file(sweep), sweep);
    const fs::path lies_at = which.scene_at.empty() ? scene : which.scene_at;
    const BatchSource source = make_source(read_scene_file(scene), lies_at, options.overrides, sweep_text, sweep);
    const PartPlan plan = begin_parts(source, sweep_text, which.parts, options.dir);
    const Folder folder(options.dir);
    const auto [begin, end] = plan.range(which.part);
    const Task part{part_file(folder, plan, which.part), begin, end, plan.key, false};
    const FileLock lock = FileLock::of_file(part.file);
    remove_half_written(folder.inner("parts"), part.file.name());
    if (options.use != FolderUse::Overwrite) options.use = FolderUse::Resume;
    try {
        return Batch(source, sweep_text, part, folder, options).go(called);
    } catch (const Error& error) {
        // a file that cannot be gone on from costs its part, not the batch
        if (error.kind() != ErrorKind::BadFile || options.use == FolderUse::Overwrite || !fs::exists(part.file.path())) throw;
        note(fmt::format("seldinger: {}: begun again, since {}\n", plan.name(which.part), error.what()));
        options.use = FolderUse::Overwrite;
        return Batch(source, sweep_text, part, folder, options).go(called);
    }
}

bool holds_a_batch(const Folder& folder)
{
    return holds_a_run(folder) ||
           std::any_of(std::begin(batch_files), std::end(batch_files), [&](const char* name) { return folder.has(name); });
}

void remove_batch(const Folder& folder)
{
    remove_old_run(folder);
    remove_kept(folder);
    for (const char* name : batch_files) (void)folder.remove(name);
}

}  // namespace seldinger::apps
