// Output of a chart: two tables for programs, a summary for people.
#include "lab/chart.h"

#include "models/result_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace seldinger {
namespace {

std::string flag(bool value) { return value ? "1" : "0"; }

/// Errors and forces in the unit in which one thinks of them.
std::string pretty(double value, Observable which)
{
    const bool length = which == Observable::Tip || which == Observable::Shape;
    if (!std::isfinite(value)) return "-";
    if (value < 1e-3) return fmt::format("{:.3g} {}", 1e6 * value, length ? "um" : "uN");
    return fmt::format("{:.3g} {}", 1e3 * value, length ? "mm" : "mN");
}

std::string summary_of(const SceneChart& chart, Observable which)
{
    const auto k = static_cast<std::size_t>(which);
    const Reference& reference = chart.reference;
    std::string text = fmt::format("  {}: ", observable_words[k].says);
    if (reference.usable(which) && !chart.charts(which)) return text + "nothing to chart: zero throughout\n";
    if (!reference.usable(which)) {
        const bool moved = !reference.moved.empty();
        return text +
               fmt::format(
                   "not charted: the reference {}{}\n", word_of(reference.convergence[k]),
                   moved ? fmt::format(" (the last refinement moved it by {})", pretty(reference.uncertainty[k], which)) : "");
    }
    text += fmt::format("reference {}, uncertain by {}\n", word_of(reference.convergence[k]),
                        pretty(reference.uncertainty[k], which));
    std::vector<const ChartPoint*> front, published;
    for (const ChartPoint& point : chart.points) {
        if (point.front[k]) front.push_back(&point);
        if (point.model.published) published.push_back(&point);
    }
    const bool clock = chart.processor_time;
    const auto cheaper = [clock](const ChartPoint* a, const ChartPoint* b) { return a->cost(clock) < b->cost(clock); };
    std::sort(front.begin(), front.end(), cheaper);
    std::sort(published.begin(), published.end(), cheaper);
    for (const ChartPoint* point : front)
        text += fmt::format("    {:9.3g} s/s  {:>10}{}  {}\n", point->cost(clock), pretty(point->errors.rms[k], which),
                            point->resolved[k] ? " " : "~", point->model.model.name);
    for (const ChartPoint* point : published) {
        if (!point->run.complete) continue;  // it has no error; chart_summary() says what became of it
        text += fmt::format("    {:9.3g} s/s  {:>10}   {} ({})", point->cost(clock), pretty(point->errors.rms[k], which),
                            point->model.model.name, name(point->run.outcome));
        const Standing stands = standing(chart, *point, which);
        if (std::isfinite(stands.cost_ratio))
            text += fmt::format(", {:.3g} x the cost of the front at its error", stands.cost_ratio);
        if (std::isfinite(stands.error_ratio))
            text += fmt::format(", {:.3g} x the error of the front at its cost", stands.error_ratio);
        text += "\n";
    }
    return text;
}

/// Models that share a reason share a line.
std::string left_out(const SceneChart& chart)
{
    std::map<std::string, std::string> names;
    for (const ChartModel& model : chart.refused) {
        std::string& list = names[model.refused];
        list += (list.empty() ? "" : ", ") + model.model.name;
    }
    std::string text;
    for (const auto& [reason, list] : names) text += fmt::format("  left out: {}: {}\n", list, reason);
    return text;
}

}  // namespace

std::string chart_csv(const ChartResult& result)
{
    ResultTable::Row header = {"scene",       "title",        "model",     "family",      "published",
                               "settings",    "outcome",      "complete",  "failed_at_s", "wall_s_per_s",
                               "wall_lowest", "wall_highest", "repeats",   "cpu_s_per_s", "cpu_lowest",
                               "cpu_highest", "clock",        "nodes",     "contacts",    "steps",
                               "simulated_s", "jitter",       "overlap_m", "outside_m",   "mean_iterations"};
    for (const ObservableWord& word : observable_words)
        for (const char* what : {"rms", "worst"}) header.push_back(fmt::format("{}_{}_{}", word.word, what, word.unit));
    for (const ObservableWord& word : observable_words)
        for (const char* what : {"front", "resolved"}) header.push_back(fmt::format("{}_{}", word.word, what));
    std::string text = csv_line(header);
    for (const SceneChart& chart : result.scenes)
        for (const ChartPoint& point : chart.points) {
            const RunRecord& run = point.run;
            ResultTable::Row row = {chart.benchmark.name,
                                    chart.title,
                                    point.model.model.name,
                                    point.model.family,
                                    flag(point.model.published),
                                    point.settings,
                                    name(run.outcome),
                                    flag(run.complete),
                                    csv_number(run.failed_at),
                                    csv_number(run.cost.wall),
                                    csv_number(run.cost.lowest),
                                    csv_number(run.cost.highest),
                                    csv_number(run.cost.repeats),
                                    csv_number(run.cost.cpu),
                                    csv_number(run.cost.cpu_lowest),
                                    csv_number(run.cost.cpu_highest),
                                    chart.processor_time ? "cpu" : "wall",
                                    csv_number(run.nodes),
                                    csv_number(run.contacts),
                                    csv_number(static_cast<double>(run.readings.steps)),
                                    csv_number(run.simulated),
                                    csv_number(run.readings.jitter),
                                    csv_number(run.readings.overlap),
                                    csv_number(run.readings.outside),
                                    csv_number(run.readings.mean_iterations)};
            for (int k = 0; k < observable_count; ++k) {
                const bool has = run.complete && chart.reference.known[k];
                row.push_back(has ? csv_number(point.errors.rms[k]) : "");
                row.push_back(has ? csv_number(point.errors.worst[k]) : "");
            }
            for (int k = 0; k < observable_count; ++k)
                row.push_back(flag(point.front[k])), row.push_back(flag(point.resolved[k]));
            text += csv_line(row);
        }
    return text;
}

std::string references_csv(const ChartResult& result)
{
    // says and moved: the old names of axis_label and refinement_changes, until 0.3.0
    std::string text = csv_line({"scene", "observable", "unit", "says", "charted", "convergence", "uncertainty", "scale",
                                 "levels", "moved", "note", "axis_label", "refinement_changes"});
    for (const SceneChart& chart : result.scenes) {
        if (!chart.finished) continue;
        for (const Observable which : chart.benchmark.charted) {
            const auto k = static_cast<std::size_t>(which);
            std::string moved;
            for (const PerObservable& values : chart.reference.moved) moved += (moved.empty() ? "" : " ") + csv_number(values[k]);
            text += csv_line(
                {chart.benchmark.name, std::string(observable_words[k].word), std::string(observable_words[k].unit),
                 std::string(observable_words[k].says), flag(chart.charts(which)),
                 std::string(at(chart.scale, which) > 0 ? word_of(chart.reference.convergence[k]) : "is zero throughout"),
                 csv_number(chart.reference.uncertainty[k]), csv_number(chart.scale[k]),
                 csv_number(static_cast<double>(chart.reference.levels.size())), moved, chart.reference.note,
                 std::string(observable_words[k].says), moved});
        }
    }
    return text;
}

std::string chart_summary(const ChartResult& result)
{
    std::string text;
    for (const SceneChart& chart : result.scenes) {
        if (!chart.finished) continue;
        text += fmt::format("{}: {} models; reference: {}\n", chart.benchmark.name, chart.points.size(), chart.reference.note);
        for (const Observable which : chart.benchmark.charted) text += summary_of(chart, which);
        for (const ChartPoint& point : chart.points) {
            if (point.sound()) continue;
            if (point.run.over_limit)
                text += fmt::format("  {}: stopped at {:.3g} simulated s, too expensive\n", point.model.model.name,
                                    point.run.simulated);
            else
                text += fmt::format("  {}: {}{}\n", point.model.model.name, name(point.run.outcome),
                                    point.run.complete ? "" : fmt::format(" at {:.3g} s", point.run.failed_at));
        }
        text += left_out(chart);
    }
    return text;
}

}  // namespace seldinger
