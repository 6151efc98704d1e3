// Keys of finished runs (scene, plan, model), their rows in a table and their trajectories in files.
#include "models/run_store.h"

#include "core/error.h"
#include "core/fnv1a.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <cmath>
#include <type_traits>

namespace seldinger {
namespace {

constexpr std::size_t key_columns = 4;

/// Columns after the keys and the outcome, in their order.
template <class Record, class Each>
void walk(Record& r, Each each)
{
    each("complete", r.complete), each("over_limit", r.over_limit);
    each("failed_at_s", r.failed_at), each("simulated_s", r.simulated), each("wall_limit_s", r.wall_limit);
    each("wall_s_per_s", r.cost.wall), each("wall_lowest", r.cost.lowest), each("wall_highest", r.cost.highest);
    each("repeats", r.cost.repeats);
    each("cpu_s_per_s", r.cost.cpu), each("cpu_lowest", r.cost.cpu_lowest), each("cpu_highest", r.cost.cpu_highest);
    each("nodes", r.nodes), each("contacts", r.contacts), each("steps", r.readings.steps);
    each("jitter", r.readings.jitter), each("overlap_m", r.readings.overlap), each("outside_m", r.readings.outside);
    each("mean_iterations", r.readings.mean_iterations);
    each("wall_move_m", r.wall_move), each("wall_far_steps", r.wall_far_steps);
}

std::vector<std::string> columns()
{
    std::vector<std::string> names = {"scene", "scene_key", "model", "settings", "outcome"};
    const RunRecord any;
    walk(any, [&names](const char* name, const auto&) { names.emplace_back(name); });
    return names;
}

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
    row.emplace_back(name(r.outcome));
    walk(r, [&row](const char*, auto value) { row.push_back(csv_number(static_cast<double>(value))); });
    return row;
}

RunRecord record_of(const ResultTable::Row& row)
{
    RunRecord r;
    r.outcome = outcome_named(row[key_columns]);
    walk(r, [&row, k = key_columns](const char*, auto& value) mutable {
        const std::string& text = row[++k];
        using Value = std::remove_reference_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>) value = number_in(text) > 0;
        else if constexpr (std::is_integral_v<Value>) value = count_in(text);
        else value = number_in(text);
    });
    if (std::isnan(r.wall_limit)) r.wall_limit = std::numeric_limits<double>::infinity();
    return r;
}

}  // namespace

RunStore::RunStore(std::filesystem::path folder)
    : folder_((make_folder(folder), std::move(folder))), table_(folder_ / "runs.csv", columns(), key_columns)
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
        const RunRecord record = record_of(*row);
        if (!record.over_limit || record.wall_limit >= plan.wall_limit) {
            if (trajectory) *trajectory = std::move(kept);
            return record;
        }
    }
    ModelRun run = run_model(scene, model, plan, baselines);
    if (run.stopped) return std::nullopt;
    save_trajectory(make_own_folder(folder_ / scene_name) / name, run.trajectory);
    table_.append(row_of(keys, run));  // last: a row stands for a run whose trajectory is there
    if (trajectory) *trajectory = std::move(run.trajectory);
    return run;
}

std::string scene_key(const Scene& scene, const RunPlan& plan)
{
    return hex(fmt::format("{}\n{} {} {}{}\n{}", version(), plan.until, plan.interval, plan.average, plan.peaks ? " peaks" : "",
                           write_scene(scene, scene.source.parent_path())));
}

}  // namespace seldinger
