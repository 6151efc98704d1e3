// Counts and ranks a batch's runs, and says so in one line.
#include "batch/batch_answer.h"

#include "bands/error_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr std::size_t most_named = 2;  // runs that the best is not told apart from

double number(const BatchRow& row, std::string_view column) { return row.numbers[column_index(column)]; }

/// "ended in branch 3 (1 run), left the vessel through inlet 2 (1 run)"; empty where no centreline tells them apart.
std::string ends_line(const BatchAnswer::Ends& ends)
{
    std::string text;
    const auto runs = [](std::size_t count) { return fmt::format("({} run{})", count, count == 1 ? "" : "s"); };
    const auto is_named = [](const auto& place) { return !place.first.second.empty() && place.first.second != "0"; };
    const bool known = std::any_of(ends.places.begin(), ends.places.end(), is_named) || ends.branches.size() > 1 ||
                       (ends.branches.size() == 1 && ends.branches.begin()->first > 0) || !ends.left.empty();
    if (!known) return text;
    for (const auto& [place, count] : ends.places) {
        const auto& [branch, path] = place;
        const bool before = branch == 0 && (path.empty() || path == "0");
        text += fmt::format("{}{} {}", text.empty() ? "ended " : ", ",
                            before ? "before any branch" : "in " + Stretch{path, "", branch, -1, 0, {}}.words(), runs(count));
    }
    for (const auto& [inlet, count] : ends.left)
        text += fmt::format("{}left the vessel through inlet {} {}", text.empty() ? "" : ", ", inlet, runs(count));
    return text;
}

/// Whether the bands of the two overlap.
bool is_apart(const BatchAnswer::Ranked& a, const BatchAnswer::Ranked& b)
{
    return !(std::abs(a.value - b.value) <= a.band + b.band);
}

/// A target a little farther in has another order, where a force still rises at this one.
std::string rising_line(const Sweep& sweep, const BatchAnswer& answer)
{
    if (answer.rising.size() > most_named && answer.rising.size() == answer.ranking.size())
        return "; still rising at the target: all of them";
    std::string text;
    for (std::size_t k = 0; k < std::min(most_named, answer.rising.size()); ++k)
        text += (k == 0 ? "; still rising at the target: " : ", ") + run_name(sweep, answer.rising[k]);
    if (answer.rising.size() > most_named) text += fmt::format(" and {} more", answer.rising.size() - most_named);
    return text;
}

std::string best_line(const Sweep& sweep, const BatchLayout& layout, const BatchAnswer& answer)
{
    const BatchAnswer::Ranked& best = answer.ranking.front();
    std::string text = fmt::format("; least peak on {:.3g} mm of wall: {}, {}", 1e3 * layout.patch, run_name(sweep, best.run),
                                   newtons(best.value, best.band));
    std::size_t close = 0;
    for (std::size_t k = 1; k < answer.ranking.size() && !is_apart(best, answer.ranking[k]); ++k, ++close) {
        if (close >= most_named) continue;
        const BatchAnswer::Ranked& other = answer.ranking[k];
        text += fmt::format("{}{}, {}", close == 0 ? "; not told apart from " : ", ", run_name(sweep, other.run),
                            newtons(other.value, other.band));
    }
    if (close > most_named) text += fmt::format(" and {} more", close - most_named);
    return text + rising_line(sweep, answer);
}

}  // namespace

void BatchAnswer::Ends::take_in(const BatchRow& row)
{
    const int inlet = static_cast<int>(number(row, "left_through"));
    if (inlet > 0) ++left[inlet];
    else {
        const int branch = static_cast<int>(number(row, "branch"));
        ++branches[branch];
        ++places[{branch, row.branch_path}];
    }
}

BatchAnswer answer_of(const BatchLayout& layout, const std::vector<BatchRow>& rows)
{
    constexpr std::size_t peak = column_index("until_patch_force_max_n");
    BatchAnswer answer;
    for (const RunRows& of : rows_by_run(layout, rows)) {
        ++answer.runs;
        if (of.row->status != RunStatus::Done) continue;
        answer.ends.take_in(*of.row);
        if (!layout.task) continue;
        if (!(number(*of.row, "reached") > 0)) answer.missed.take_in(*of.row);
        if (const double distance = number(*of.row, "distance_m"); !answer.nearest || distance < answer.nearest_distance)
            answer.nearest = static_cast<std::size_t>(of.row->run), answer.nearest_distance = distance;
        answer.reached += number(*of.row, "reached") > 0;
        if (!(number(*of.row, "passed") > 0)) continue;
        ++answer.passed;
        if (is_rising(number(*of.row, "until_patch_force_max_s"), number(*of.row, "reached_at_s")))
            answer.rising.push_back(static_cast<std::size_t>(of.row->run));
        answer.ranking.push_back({static_cast<std::size_t>(of.row->run), of.row->numbers[peak], band_of(of, peak)});
    }
    if (answer.reached > 0) answer.nearest.reset();
    std::stable_sort(answer.ranking.begin(), answer.ranking.end(),
                     [](const auto& a, const auto& b) { return a.value < b.value; });
    return answer;
}

std::string answer_line(const Sweep& sweep, const BatchLayout& layout, const BatchAnswer& answer)
{
    if (!layout.task) {
        const std::string ends = ends_line(answer.ends);
        return ends.empty() ? "" : "tips " + ends;
    }
    std::string text = fmt::format("{} of {} reached {}", answer.reached, answer.runs, layout.target);
    if (layout.limits && answer.reached > 0) text += fmt::format(", {} within the limits", answer.passed);
    if (const std::string ends = ends_line(answer.missed); !ends.empty())
        text += fmt::format("{} {}", answer.reached > 0 ? ", the others" : "; they", ends);
    if (answer.nearest)
        text += fmt::format("; nearest at the end: {}, {:.3g} mm from it", run_name(sweep, *answer.nearest),
                            1e3 * answer.nearest_distance);
    if (answer.ranking.empty()) return text;
    return text + best_line(sweep, layout, answer) +
           (layout.bands ? " (± by the step; `run` adds nodes and facets)" : " (--bands computes its band)");
}

}  // namespace seldinger
