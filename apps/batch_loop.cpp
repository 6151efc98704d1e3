// The loop of `seldinger batch`: worlds one after the other, results table, checkpoints, Ctrl-C and time limit between steps.
#include "batch_loop.h"

#include "core/clock.h"
#include "core/file_io.h"
#include "core/file_lock.h"
#include "core/note.h"
#include "core/parallel.h"
#include "core/sealed_file.h"
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
constexpr std::string_view magic = "SELBATC8";
constexpr const char* batch_files[] = {"results.csv", "results-units.csv", "results.npz", "shapes.csv", "sweep.toml"};

/// Sums over the whole batch, resumed parts included. Plain bytes, for the checkpoint.
struct Totals {
    std::int64_t wire_steps = 0, world_steps = 0, resumes = 0;
    double wall = 0;
    StageTimes stages;
};

bool holds_a_batch(const Folder& folder)
{
    return holds_a_run(folder) ||
           std::any_of(std::begin(batch_files), std::end(batch_files), [&](const char* name) { return folder.has(name); });
}

void check_batch_folder(const Folder& folder, FolderUse use, const BatchSource& source, const std::string& sweep_text)
{
    const fs::path& dir = folder.path();
    std::error_code ignored;
    for (const fs::path& given : {source.scene_file, source.sweep.source})
        for (const char* name : {"scene.toml", "sweep.toml"})
            if (fs::equivalent(dir / name, given, ignored) && !folder.has("checkpoint.bin"))
                throw Error(ExitCode::BadScene,
                            fmt::format("{}: {} lies there itself and would be overwritten; choose another folder with -o",
                                        dir.string(), given.string()));
    if (!holds_a_batch(folder)) return;
    if (use == FolderUse::Refuse)
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: holds a run already; give --resume to continue it, --overwrite to replace it, "
                                "or another folder with -o",
                                dir.string()));
    if (use == FolderUse::Overwrite || !folder.has("checkpoint.bin")) return;
    const bool same = folder.has("sweep.toml") && read_file(folder / "sweep.toml") == sweep_text &&
                      read_file(folder / "scene.toml") == resolved_scene(source, dir);
    if (!same)
        throw Error(ExitCode::BadScene,
                    fmt::format("{}: scene.toml or sweep.toml differs from what is to be resumed; give the same scene, sweep "
                                "and --set, or --overwrite",
                                dir.string()));
}

class Batch {
public:
    Batch(const BatchSource& source, std::string sweep_text, std::size_t begin, std::size_t end, const Folder& folder, const RunOptions& options)
        : source_(source), options_(options), folder_(folder), begin_(begin), end_(end), runs_(end - begin), ramp_(options.time_limit > 0)
    {
        worlds_ = plan_worlds(source, begin, end, ramp_, &warnings_);
        planning_.reset();
        const std::string scene = resolved_scene(source, folder.path());
        given_ = scene + sweep_text;
        if (options.use == FolderUse::Resume && folder.has("checkpoint.bin")) {
            restore();
            return;
        }
        remove_batch(folder);
        write_file(folder / "scene.toml", scene);
        write_file(folder / "sweep.toml", sweep_text);
    }

    RunOutcome go(Clock::time_point called)
    {
        start_ = last_save_ = Clock::now();
        earlier_wall_ = totals_.wall;
        BatchProgress progress(runs_, options_.quiet);
        for (bool first = true; at_ < worlds_.size();) {
            if (!world_) open_world();
            for (; !world_->finished(); first = false) {
                if (stop_asked_for() != 0)
                    return stop(stop_asked_for() == SIGINT ? RunStatus::Interrupted : RunStatus::TimeLimit);
                if (!first && options_.time_limit > 0 && seconds_since(called) >= options_.time_limit)
                    return stop(RunStatus::TimeLimit);
                take_step();
                if (seconds_since(last_save_) >= std::max(save_seconds, save_share * save_cost_)) save(RunStatus::Running);
                progress.show(rows_.size(), at_, worlds_.size(), *world_, static_cast<double>(totals_.wire_steps) / wall());
            }
            device_ = world_->world().device_name();
            world_.reset();
            ++at_;
        }
        return stop(RunStatus::Done);
    }

    [[nodiscard]] const std::vector<BatchRow>& rows() const { return rows_; }
    [[nodiscard]] double step_seconds() const { return step_seconds_; }

private:
    double wall() const { return earlier_wall_ + seconds_since(start_); }

    void open_world()
    {
        const NoPolling loading;
        // worlds in a row often share the vessel: it is loaded once
        Scene scene = source_.scene(0);
        scene.vessel = source_.scene(worlds_[at_].front()).vessel;
        std::string key = write_scene(scene, folder_.path());
        if (key != vessel_key_) vessel_ = load_vessel(scene.vessel);
        vessel_key_ = std::move(key);
        world_.emplace(source_, worlds_[at_], vessel_, options_.device);
        // of the first world: the vessel is seldom varied. A task of a farm leaves it to the merge
        const bool whole = begin_ == 0 && end_ == source_.item_count();
        if (whole && at_ == 0 && !vessel_.mesh.triangles.empty()) write_file(folder_ / "vessel.vtp", wall_vtp(vessel_.mesh));
        device_ = world_->world().device_name();
    }

    void take_step()
    {
        const StageTimes before = world_->stages();
        totals_.wire_steps += static_cast<std::int64_t>(world_->running());
        totals_.world_steps++;
        const auto begun = Clock::now();
        for (BatchRow& row : world_->step()) rows_.push_back(row);
        step_seconds_ += seconds_since(begun);
        write_kept(options_.keep.path().empty() ? folder_ : options_.keep, world_->take_kept());
        totals_.stages += world_->stages();
        totals_.stages -= before;
    }

    void save(RunStatus status)
    {
        totals_.wall = wall();
        const auto begun = Clock::now();
        write_tables(folder_, source_, rows_);
        std::vector<std::uint8_t> bytes;
        const auto put_list = [&](const auto& list) {
            const std::uint64_t count = list.size();
            put_bytes(bytes, &count, 1);
            put_bytes(bytes, list.data(), list.size());
        };
        put_list(std::string(version()));
        put_list(device_);
        put_list(given_);
        put_bytes(bytes, &status, 1);
        const std::uint8_t ramp = ramp_;
        put_bytes(bytes, &ramp, 1);
        put_bytes(bytes, &totals_, 1);
        put_rows(bytes, rows_);
        const std::uint64_t at = at_;
        const std::uint8_t open = world_.has_value();
        put_bytes(bytes, &at, 1);
        put_bytes(bytes, &open, 1);
        if (world_) {
            const std::uint64_t vessel = hash_of(world_->world().setup().mesh);
            put_bytes(bytes, &vessel, 1);
            world_->save(bytes);
        }
        write_sealed(folder_ / "checkpoint.bin", magic, bytes);
        last_save_ = Clock::now();
        save_cost_ = seconds_since(begun);
    }

    void restore()
    {
        const fs::path file = folder_.path() / "checkpoint.bin";
        const std::vector<std::uint8_t> bytes = read_sealed(folder_ / "checkpoint.bin", magic);
        const std::uint8_t *at = bytes.data(), *end = at + bytes.size();
        const auto take_list = [&](auto& list) {
            std::uint64_t count = 0;
            take_bytes(at, end, &count, 1);
            if (count > static_cast<std::uint64_t>(end - at) / sizeof list[0])
                throw Error(ExitCode::BadFile, file.string() + ": a list is longer than the file; run again with --overwrite");
            list.resize(count);
            take_bytes(at, end, list.data(), count);
        };
        std::string writer;
        take_list(writer);
        if (writer != version())
            throw Error(ExitCode::BadFile,
                        fmt::format("{}: was written by version {}, this is {}; resume with that one, or run again with "
                                    "--overwrite",
                                    file.string(), writer, version()));
        take_list(device_);
        std::string given;
        take_list(given);
        if (given != given_)
            throw Error(ExitCode::BadFile, fmt::format("{}: is of another scene or sweep, {}; run again with --overwrite",
                                                       file.string(), first_difference(given, given_)));
        take_bytes(at, end, &saved_status_, 1);
        // the worlds are those that it was begun with, whether or not there is a limit now
        std::uint8_t ramp = 0;
        take_bytes(at, end, &ramp, 1);
        if (ramp > 1) throw Error(ExitCode::BadFile, file.string() + ": is corrupt: a value is out of range; run again with --overwrite");
        if (ramp_ != (ramp == 1)) {
            ramp_ = ramp == 1;
            worlds_ = plan_worlds(source_, begin_, end_, ramp_);
        }
        take_bytes(at, end, &totals_, 1);
        rows_ = take_rows(at, end);
        std::uint64_t index = 0;
        std::uint8_t open = 0;
        take_bytes(at, end, &index, 1);
        take_bytes(at, end, &open, 1);
        at_ = index;
        check_restored(file, open);
        if (open) restore_world(file, at, end);
        if (at != end) throw Error(ExitCode::BadFile, file.string() + ": has data after its end; run again with --overwrite");
        if (saved_status_ != RunStatus::Done) totals_.resumes++;
    }

    /// What the file says, before it is gone on from. @throws Error BadFile
    void check_restored(const fs::path& file, std::uint8_t open) const
    {
        const auto is_time = [](double seconds) { return seconds >= 0 && seconds < 1e12; };
        const auto is_count = [](std::int64_t count) { return count >= 0 && count <= std::int64_t{1} << 53; };
        static_assert(sizeof(StageTimes) % sizeof(double) == 0);
        const auto* stages = reinterpret_cast<const double*>(&totals_.stages);
        const bool sound = at_ <= worlds_.size() && open <= (at_ < worlds_.size()) && saved_status_ >= RunStatus::Running &&
                           saved_status_ <= RunStatus::Stopped && is_count(totals_.wire_steps) && is_count(totals_.world_steps) &&
                           is_count(totals_.resumes) && is_time(totals_.wall) &&
                           std::all_of(stages, stages + sizeof(StageTimes) / sizeof(double), is_time) && are_sound(rows_, begin_, end_, source_.scene(0).instrument_count());
        if (!sound) throw Error(ExitCode::BadFile, file.string() + ": is corrupt: a value is out of range; run again with --overwrite");
    }

    void restore_world(const fs::path& file, const std::uint8_t*& at, const std::uint8_t* end)
    {
        const std::string before = device_;
        open_world();
        std::uint64_t vessel = 0;
        take_bytes(at, end, &vessel, 1);
        if (vessel != hash_of(world_->world().setup().mesh))
            throw Error(
                ExitCode::BadFile,
                fmt::format("{}: the vessel has changed since the batch began; run again with --overwrite", file.string()));
        if (before != device_ && !options_.quiet)
            note(fmt::format("seldinger: resumed on \"{}\" after \"{}\": the bits may differ from a batch in one piece\n",
                             device_, before));
        try {
            world_->restore(at, end);
        } catch (const Error& error) {
            throw Error(error.code(), fmt::format("{}: {}; run again with --overwrite", file.string(), error.what()));
        }
    }

    std::string summary(RunStatus status) const
    {
        const double to_ms = 1e3 / static_cast<double>(std::max<std::int64_t>(totals_.world_steps, 1));
        const StageTimes& s = totals_.stages;
        Json out;
        out["name"] = source_.scene(0).name;
        out["status"] = status_word(status);
        add_answer(out, source_, rows_);
        if (!warnings_.empty()) out["warnings"] = warnings_;
        out["results"] = "results.csv";
        out["worlds"] = worlds_.size();
        out["wire_steps"] = totals_.wire_steps;
        out["version"] = version();
        out["resumes"] = totals_.resumes;
        out["threads"] = thread_count();
        out["device"] = device_;
        out["wall_s"] = totals_.wall;
        out["wire_steps_per_s"] = static_cast<double>(totals_.wire_steps) / std::max(totals_.wall, 1e-9);
        out["stage_ms"] = {{"detect", s.detect * to_ms}, {"evaluate", s.evaluate * to_ms}, {"reduce", s.reduce * to_ms},
                           {"solve", s.solve * to_ms},   {"wall", 0.0},                    {"adapt", s.adapt * to_ms}};
        return json_text(out, 2) + "\n";
    }

    RunOutcome stop(RunStatus status)
    {
        RunOutcome outcome;
        if (status != RunStatus::Done || saved_status_ != RunStatus::Done) save(status);
        outcome.summary = summary(status);
        write_file(folder_ / "summary.json", outcome.summary);
        const std::string dir = folder_.path().string();
        const std::string saved = fmt::format("with {} of {} runs done, state saved in {}; run again with --resume", rows_.size(),
                                              runs_, dir);
        if (status == RunStatus::TimeLimit) outcome = {ExitCode::TimeLimit, outcome.summary, "stopped by a limit " + saved};
        if (status == RunStatus::Interrupted) outcome = {ExitCode::Interrupted, outcome.summary, "interrupted " + saved};
        if (status != RunStatus::Done) return outcome;
        std::int64_t stopped = 0, first = -1;
        const auto runs = static_cast<std::int64_t>(source_.sweep.run_count());
        for (const BatchRow& row : rows_)
            if (row.run < runs && row.status == RunStatus::Stopped && (stopped++ == 0 || row.run < first)) first = row.run;
        if (stopped > 0)
            outcome = {
                ExitCode::Stopped, outcome.summary,
                fmt::format(
                    "{} of {} runs stopped where no step converged, run {} first; see the column status of {}; make scene.dt_s "
                    "smaller or contact.stiffness lower there",
                    stopped, std::min<std::size_t>(rows_.size(), source_.sweep.run_count()), first, (folder_.path() / "results.csv").string())};
        return outcome;
    }

    const BatchSource& source_;
    const RunOptions& options_;
    const Folder folder_;
    std::size_t begin_, end_, runs_;
    bool ramp_;                                     // worlds that grow (plan_worlds): a limit may stop this
    std::vector<std::string> warnings_;             // of the scenes
    std::optional<NoPolling> planning_{std::in_place};  // until worlds_ are known
    std::vector<std::vector<std::size_t>> worlds_;  // runs of each
    std::size_t at_ = 0;                            // world being run
    std::optional<BatchWorld> world_;
    LoadedVessel vessel_;
    std::string vessel_key_, device_;
    std::string given_;  // scene and sweep, as the checkpoint carries them
    std::vector<BatchRow> rows_;
    Totals totals_;
    double save_cost_ = 0;     // [s] of the last one
    double step_seconds_ = 0;  // since this call began
    RunStatus saved_status_ = RunStatus::Running;
    double earlier_wall_ = 0;
    Clock::time_point start_, last_save_;
};

}  // namespace

void write_tables(const Folder& folder, const BatchSource& source, const std::vector<BatchRow>& rows)
{
    const BatchLayout layout = source.layout();
    write_file(folder / "results-units.csv", batch_units_csv(source.sweep, layout));
    write_file(folder / "shapes.csv", batch_shapes_csv(layout, rows));
    write_file(folder / "results.npz", batch_npz(source.sweep, layout, rows));
    write_file(folder / "results.csv", batch_csv(source.sweep, layout, rows));
}

void add_answer(Json& summary, const BatchSource& source, const std::vector<BatchRow>& rows)
{
    const BatchLayout layout = source.layout();
    const std::vector<RunRows> runs = rows_by_run(layout, rows);
    const auto stopped = static_cast<std::size_t>(
        std::count_if(runs.begin(), runs.end(), [](const RunRows& of) { return of.row->status == RunStatus::Stopped; }));
    const BatchAnswer answer = answer_of(layout, rows);
    summary["runs"] = source.sweep.run_count();
    summary["done"] = runs.size() - stopped;
    summary["stopped"] = stopped;
    Json branches = Json::object(), left = Json::object();
    for (const auto& [branch, count] : answer.ends.branches) branches[std::to_string(branch)] = count;
    for (const auto& [inlet, count] : answer.ends.left) left[std::to_string(inlet)] = count;
    summary["branches"] = std::move(branches);
    summary["left_through"] = std::move(left);
    if (layout.task) {
        Json ranking = Json::array();
        for (const BatchAnswer::Ranked& one : answer.ranking)
            ranking.push_back({{"run", one.run},
                               {"label", label_of(source.sweep, one.run)},
                               {"until_patch_force_max_n", one.value},
                               {"band_n", std::isfinite(one.band) ? Json(one.band) : Json()}});
        summary["task"] = {{"target", layout.target}, {"reached", answer.reached}, {"passed", answer.passed}, {"force_patch_m", layout.patch}, {"ranking", std::move(ranking)}};
    }
    summary["answer"] = answer_line(source.sweep, layout, answer);
    constexpr std::size_t wall_band = column_index("wall_move_max_band_m");
    if (std::any_of(rows.begin(), rows.end(), [](const BatchRow& row) { return row.numbers[wall_band] > 0; }))
        summary["wall_bands"] = layout.bands ? "of control mesh, linear theory, nodes and step"
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
    return Batch(source, sweep_text, 0, source.item_count(), folder, options).go(called);
}

BatchPart run_batch_part(const BatchSource& source, const std::string& sweep_text, std::size_t begin, std::size_t end,
                         const Folder& folder, const RunOptions& options)
{
    const auto called = Clock::now();
    const StopSignal listening;
    const FileLock lock = FileLock::of_folder(folder);
    check_batch_folder(folder, options.use, source, sweep_text);
    Batch batch(source, sweep_text, begin, end, folder, options);
    BatchPart part;
    part.outcome = batch.go(called);
    part.rows = batch.rows();
    part.step_s = batch.step_seconds();
    return part;
}

void remove_batch(const Folder& folder)
{
    remove_old_run(folder);
    remove_kept(folder);
    for (const char* name : batch_files) (void)folder.remove(name);
}

}  // namespace seldinger::apps
