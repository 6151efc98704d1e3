// Keys of finished runs (scene, plan, model), their rows in a table and their trajectories in files.
#include "models/run_store.h"

#include "core/error.h"
#include "core/fnv1a.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

namespace seldinger {
namespace {

const std::vector<std::string> columns = {
    "scene",       "scene_key",   "model",           "settings",     "outcome",       "complete",     "over_limit",
    "failed_at_s", "simulated_s", "wall_limit_s",    "wall_s_per_s", "wall_lowest",   "wall_highest", "repeats",
    "cpu_s_per_s", "cpu_lowest",  "cpu_highest",     "nodes",        "contacts",      "steps",        "jitter",
    "overlap_m",   "outside_m",   "mean_iterations", "wall_move_m",  "wall_far_steps"};
constexpr std::size_t key_columns = 4;

std::string hex(const std::string& text) { return fmt::format("{:016x}", fnv1a(text.data(), text.size())); }

/// What the model is, whatever it is called.
std::string settings_of(const Model& model, const Scene& scene)
{
    std::string text = fmt::format("{}", fmt::join(set_texts(model, scene), " "));
    if (!model.baseline.empty()) text = model.baseline + (text.empty() ? "" : " ") + text;
    return text;
}

Outcome outcome_named(const std::string& word)
{
    for (const Outcome outcome : {Outcome::Hold, Outcome::Jitter, Outcome::Overlap, Outcome::Escape, Outcome::GaveUp})
        if (word == name(outcome)) return outcome;
    return Outcome::BlowUp;
}

ResultTable::Row row_of(const ResultTable::Row& keys, const RunRecord& r)
{
    ResultTable::Row row = keys;
    const auto put = [&row](double value) { row.push_back(csv_number(value)); };
    row.emplace_back(name(r.outcome));
    for (const double value : {r.complete ? 1.0 : 0.0,
                               r.over_limit ? 1.0 : 0.0,
                               r.failed_at,
                               r.simulated,
                               r.wall_limit,
                               r.cost.wall,
                               r.cost.lowest,
                               r.cost.highest,
                               static_cast<double>(r.cost.repeats),
                               r.cost.cpu,
                               r.cost.cpu_lowest,
                               r.cost.cpu_highest,
                               static_cast<double>(r.nodes),
                               static_cast<double>(r.contacts),
                               static_cast<double>(r.readings.steps),
                               r.readings.jitter,
                               r.readings.overlap,
                               r.readings.outside,
                               r.readings.mean_iterations,
                               r.wall_move,
                               static_cast<double>(r.wall_far_steps)})
        put(value);
    return row;
}

RunRecord record_of(const ResultTable::Row& row)
{
    RunRecord r;
    std::size_t k = key_columns;
    const auto next = [&] { return number_in(row[k++]); };
    r.outcome = outcome_named(row[k++]);
    r.complete = next() > 0, r.over_limit = next() > 0;
    r.failed_at = next(), r.simulated = next();
    r.wall_limit = row[k].empty() ? std::numeric_limits<double>::infinity() : number_in(row[k]), ++k;
    r.cost.wall = next(), r.cost.lowest = next(), r.cost.highest = next();
    r.cost.repeats = count_in(row[k++]), r.cost.cpu = next(), r.cost.cpu_lowest = next(), r.cost.cpu_highest = next();
    r.nodes = count_in(row[k++]), r.contacts = count_in(row[k++]), r.readings.steps = count_in(row[k++]);
    r.readings.jitter = next(), r.readings.overlap = next(), r.readings.outside = next(), r.readings.mean_iterations = next();
    r.wall_move = next(), r.wall_far_steps = count_in(row[k++]);
    return r;
}

RunRecord record_of(const ModelRun& run, const RunPlan& plan)
{
    RunRecord r;
    r.cost = run.cost;
    r.outcome = run.verdict.outcome;
    r.complete = run.complete, r.over_limit = run.over_limit;
    r.failed_at = run.failed_at, r.simulated = run.simulated, r.wall_limit = plan.wall_limit;
    r.nodes = run.nodes, r.contacts = run.contacts;
    r.wall_move = run.wall_move, r.wall_far_steps = run.wall_far_steps;
    r.readings = run.verdict.readings;
    return r;
}

}  // namespace

RunStore::RunStore(std::filesystem::path folder)
    : folder_((make_folder(folder), std::move(folder))), table_(folder_ / "runs.csv", columns, key_columns)
{
}

std::optional<RunRecord> RunStore::get(const std::string& scene_name, const StudyScene& scene, const Model& model,
                                       const RunPlan& plan, const std::vector<Baseline>& baselines, Trajectory* trajectory)
{
    const std::string settings = settings_of(model, scene.scene);
    const ResultTable::Row keys = {scene_name, scene_key(scene.scene, plan), label(model), settings};
    const auto name = fmt::format("{}-{}.trajectory", keys[1], hex(settings));
    const auto file = folder_ / scene_name / name;
    Trajectory kept;
    if (const ResultTable::Row* row = table_.find(keys); row && load_trajectory(file, kept)) {
        RunRecord record = record_of(*row);
        record.trajectory = file;
        if (!record.over_limit || record.wall_limit >= plan.wall_limit) {
            if (trajectory) *trajectory = std::move(kept);
            return record;
        }
    }
    const ModelRun run = run_model(scene, model, plan, baselines);
    if (run.stopped) return std::nullopt;
    ++fresh_;
    RunRecord record = record_of(run, plan);
    record.trajectory = file;
    save_trajectory(make_own_folder(folder_ / scene_name) / name, run.trajectory);
    table_.append(row_of(keys, record));  // last: a row stands for a run whose trajectory is there
    if (trajectory) *trajectory = run.trajectory;
    return record;
}

std::string scene_key(const Scene& scene, const RunPlan& plan)
{
    return hex(fmt::format("{}\n{} {} {}{}\n{}", version(), plan.until, plan.interval, plan.average, plan.peaks ? " peaks" : "",
                           write_scene(scene, scene.source.parent_path())));
}

}  // namespace seldinger
