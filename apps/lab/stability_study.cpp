// Which cells of the stability maps are wanted and not yet in the table, the threads that run them, and the summary.
#include "lab/stability_study.h"

#include "core/error.h"
#include "core/file_io.h"
#include "io/json_text.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <thread>

namespace seldinger::apps {
namespace {

using Row = ResultTable::Row;

const std::vector<std::string> columns = {
    "map",         "method",          "dt_s",      "value",  "outcome",       "failed_step",   "steps",        "simulated_s",
    "overlap_m",   "overlap_limit_m", "outside_m", "jitter", "jitter_limit",  "energy_made_j", "hand_force_n", "sub_steps",
    "newton_mean", "touching_steps",  "budget_s",  "set",    "wall_far_steps"};
constexpr std::size_t key_columns = 4, outcome_column = 4, touching_column = 17, budget_column = 18, set_column = 19,
                      wall_far_column = 20;
constexpr std::string_view unfinished = "unfinished";

Row key_of(const StabilityMap& map, const Model& method, double dt, double value)
{
    return {map.name, method.name, csv_number(dt), csv_number(value)};
}

Row row_of(const StabilityMap& map, const Model& method, double dt, double value, const CellResult& cell,
           const std::filesystem::path& folder, double budget)
{
    Row row = key_of(map, method, dt, value);
    const Verdict& verdict = cell.verdict;
    const FailureReadings& r = verdict.readings;
    const auto count = [](long n) { return fmt::format("{}", n); };
    row.insert(
        row.end(),
        {cell.outcome(), count(verdict.held() ? -1 : verdict.first_step[static_cast<std::size_t>(verdict.outcome)]),
         count(r.steps), csv_number(cell.simulated), csv_number(r.overlap), csv_number(cell.overlap_limit), csv_number(r.outside),
         csv_number(r.jitter), csv_number(cell.jitter_limit), csv_number(r.energy_made), csv_number(r.hand_force),
         count(r.sub_steps), csv_number(r.mean_iterations), count(r.touching), csv_number(budget)});
    std::string texts;
    std::vector<std::string> all = map.set(value, dt, 1, folder);
    all.push_back(fmt::format("scene.dt_s={}", dt));
    for (const std::string& text : all) texts += fmt::format("{}--set '{}'", texts.empty() ? "" : " ", text);
    row.push_back(texts.size() < 1000 ? texts : "");  // a load for every step is too long for a command line
    row.push_back(count(cell.wall_far_steps));
    return row;
}

template <class Item>
std::vector<Item> named(const std::vector<Item>& all, const std::vector<std::string>& names, const char* what)
{
    if (names.empty()) return all;
    std::vector<Item> found;
    std::string known;
    for (const Item& item : all) known += (known.empty() ? "" : "; ") + item.name;
    for (const std::string& wanted : names) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const Item& item) { return item.name == wanted; });
        if (at == all.end())
            throw Error(ErrorKind::BadScene, fmt::format("--{}: got \"{}\"; expected one of: {}", what, wanted, known));
        found.push_back(*at);
    }
    return found;
}

/// Whether a cell's row stands: one that a budget cut short is run again when there is more of it.
bool stands(const Row* row, double budget)
{
    return row && ((*row)[outcome_column] != unfinished || number_in((*row)[budget_column]) >= budget);
}

/// "wire.bend_nm2=1e-5,1e-4"
std::pair<std::string, std::vector<double>> parse_vary(const std::string& text)
{
    const auto fail = [&] {
        throw Error(ErrorKind::BadScene, fmt::format("--vary: got \"{}\"; expected a key of the scene and numbers, rising, e.g. "
                                                    "\"vessel.youngs_pa=1e5,1e6,1e7\"",
                                                    text));
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || text.find('.') > equals) fail();
    std::vector<double> values;
    for (std::size_t from = equals + 1; from <= text.size();) {
        const std::size_t comma = std::min(text.find(',', from), text.size());
        const std::string part = text.substr(from, comma - from);
        char* end = nullptr;
        const double value = std::strtod(part.c_str(), &end);
        if (part.empty() || *end != '\0' || !std::isfinite(value) || (!values.empty() && value <= values.back())) fail();
        values.push_back(value);
        from = comma + 1;
    }
    return {text.substr(0, equals), values};
}

/// The maps that show one of the rows.
std::vector<StabilityMap> of_rows(const std::vector<StabilityMap>& all, const std::vector<std::string>& rows)
{
    if (rows.empty()) return all;
    const auto shows = [](const StabilityMap& map, const std::string& row) {
        return (" " + map.rows + " ").find(" " + row + " ") != std::string::npos;
    };
    std::vector<StabilityMap> found;
    for (const StabilityMap& map : all)
        if (std::any_of(rows.begin(), rows.end(), [&](const std::string& row) { return shows(map, row); })) found.push_back(map);
    for (const std::string& row : rows)
        if (std::none_of(all.begin(), all.end(), [&](const StabilityMap& map) { return shows(map, row); }))
            throw Error(ErrorKind::BadScene, fmt::format("--row: got \"{}\"; expected F1 to F21", row));
    return found;
}

/// The cells of one map and value, which share what a static load does there.
struct Strip {
    const StabilityMap* map;
    double value;
    std::vector<std::pair<const Model*, double>> cells;  // method, dt
};

/// stderr as it is now, put back at the end. PoCL points descriptor 2 elsewhere while it compiles, and back; two threads that do
/// so at once may leave it where it should not be.
class KeptStderr {
public:
    KeptStderr() : fd_(dup(STDERR_FILENO)), is_terminal_(isatty(STDERR_FILENO) != 0) {}
    ~KeptStderr()
    {
        if (fd_ < 0) return;
        dup2(fd_, STDERR_FILENO);
        close(fd_);
    }
    KeptStderr(const KeptStderr&) = delete;
    KeptStderr& operator=(const KeptStderr&) = delete;
    [[nodiscard]] bool is_terminal() const { return is_terminal_; }
    void show(const std::string& text) const { (void)!write(fd_, text.data(), text.size()); }

private:
    int fd_;
    bool is_terminal_;
};

class Workers {
public:
    Workers(const StabilityWork& work, const StabilityOptions& options)
        : options_(options), scenes_(options.dir / "scenes"), table_(open_stability_table(options.dir))
    {
        (void)make_own_folder(scenes_);
        for (const StabilityMap& map : work.maps) {
            if (map.source.empty()) write_file(scenes_ / (map.name + ".toml"), map.scene);
            if (map.write_meshes) map.write_meshes(scenes_);
            std::vector<const Model*> here;
            for (const Model& method : work.methods)
                if (why_not_in(map, method, scenes_).empty()) here.push_back(&method);
            for (const double value : work.values(map)) {
                Strip strip{&map, value, {}};
                for (const Model* method : here)
                    for (const double dt : work.steps) {
                        ++progress_.asked;
                        if (!stands(table_.find(key_of(map, *method, dt, value)), options.cell_limit))
                            strip.cells.emplace_back(method, dt);
                    }
                progress_.left += static_cast<long>(strip.cells.size());
                if (!strip.cells.empty()) strips_.push_back(std::move(strip));
            }
        }
    }

    StabilityProgress run()
    {
        const int wanted =
            options_.jobs > 0 ? options_.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
        (void)list_devices();  // OpenCL starts up on one thread: its loader and PoCL are not safe in that
        std::vector<std::thread> threads;
        for (int k = 0; k < std::min<int>(wanted, static_cast<int>(strips_.size())); ++k)
            threads.emplace_back([this] { work_off(); });
        for (std::thread& thread : threads) thread.join();
        if (shown_) stderr_.show("\n");
        if (failure_) std::rethrow_exception(failure_);
        progress_.interrupted = progress_.left > 0;
        return progress_;
    }

private:
    [[nodiscard]] bool over() { return stop_asked_for() != 0 || failed_; }

    void work_off()
    {
        try {
            for (std::size_t k = next_++; k < strips_.size() && !over(); k = next_++) run_strip(strips_[k]);
        } catch (...) {
            const std::scoped_lock lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            failed_ = true;
        }
    }

    void run_strip(const Strip& strip)
    {
        const auto stop = [this] { return over(); };
        const CellReference reference = cell_reference(*strip.map, strip.value, scenes_, stop);
        for (const auto& [method, dt] : strip.cells) {
            if (over()) return;
            const CellResult cell =
                run_stability_cell({*strip.map, *method, dt, strip.value, scenes_}, reference, options_.cell_limit, stop);
            if (cell.stopped) return;
            const std::scoped_lock lock(mutex_);
            table_.append(row_of(*strip.map, *method, dt, strip.value, cell, scenes_, options_.cell_limit));
            --progress_.left;
            if (options_.quiet || !stderr_.is_terminal()) continue;
            stderr_.show(fmt::format("\r{} of {} cells to go ({})        ", progress_.left, progress_.asked, strip.map->name));
            shown_ = true;
        }
    }

    KeptStderr stderr_;
    const StabilityOptions& options_;
    std::filesystem::path scenes_;
    ResultTable table_;
    std::vector<Strip> strips_;
    StabilityProgress progress_;
    std::atomic<std::size_t> next_ = 0;
    std::atomic<bool> failed_ = false;
    std::mutex mutex_;
    std::exception_ptr failure_;
    bool shown_ = false;
};

struct Count {
    long hold = 0, all = 0, unfinished = 0, touched = 0, far = 0;
};

Count count_cells(const StabilityWork& work, const ResultTable& table, const StabilityMap& map, const Model& method)
{
    Count count;
    for (const double value : work.values(map))
        for (const double dt : work.steps) {
            const Row* row = table.find(key_of(map, method, dt, value));
            if (!row) continue;
            ++count.all;
            count.hold += (*row)[outcome_column] == name(Outcome::Hold);
            count.unfinished += (*row)[outcome_column] == unfinished;
            count.touched += number_in((*row)[touching_column]) > 0;
            count.far += number_in((*row)[wall_far_column]) > 0;
        }
    return count;
}

/// What a map cannot say, one line each; empty when it says all.
std::vector<std::string> doubts(const StabilityWork& work, const ResultTable& table, const StabilityMap& map)
{
    Count all;
    for (const Model& method : work.methods) {
        const Count count = count_cells(work, table, map, method);
        all.hold += count.hold, all.all += count.all, all.unfinished += count.unfinished, all.touched += count.touched;
        all.far += count.far;
    }
    std::vector<std::string> lines;
    if (all.all == 0) return lines;
    if (map.touches && all.touched == 0)
        lines.push_back(
            fmt::format("{}: the wire never touches the wall, so the map says nothing about contact; feed it farther (feed.keys, "
                        "scene.duration_s)",
                        map.name));
    if (!map.touches && !map.source.empty())
        lines.push_back(fmt::format("{}: the scene has no vessel, so methods differ by their integrator alone", map.name));
    if (all.far > 0)
        lines.push_back(fmt::format(
            "{}: in {} cells the wall moved by more than 20 % of the lumen's radius, where contact with it is inexact (~)",
            map.name, all.far));
    if (all.unfinished > 0)
        lines.push_back(
            fmt::format("{}: {} cells were not finished within their budget and count as not held; run again with a larger "
                        "--cell-budget",
                        map.name, all.unfinished));
    else if (all.hold == 0)
        lines.push_back(
            fmt::format("{}: no method holds in any cell; look at the scene itself before the methods (seldinger check, then "
                        "seldinger run at the smallest step)",
                        map.name));
    return lines;
}

std::string map_scene(const StabilityMap& map, const std::filesystem::path& dir)
{
    return map.source.empty() ? (dir / "scenes" / (map.name + ".toml")).string() : map.source.string();
}

}  // namespace

StabilityWork select_work(const StabilityOptions& options)
{
    StabilityWork work;
    if (options.scene.empty()) {
        if (!options.vary.empty())
            throw Error(ErrorKind::BadScene, "--vary: goes with a SCENE.toml; the maps have their own values");
        work.maps = named(of_rows(stability_maps(), options.rows), options.maps, "maps");
    } else {
        if (!options.rows.empty() || !options.maps.empty())
            throw Error(ErrorKind::BadScene, "--row, --maps: not with a SCENE.toml, which is one map");
        if (options.vary.empty())
            throw Error(ErrorKind::BadScene, "--vary: is needed with a SCENE.toml, e.g. --vary vessel.youngs_pa=1e5,1e6,1e7");
        const auto [key, values] = parse_vary(options.vary);
        work.maps = {map_of_scene(options.scene, key, values)};
    }
    const bool all = options.methods == std::vector<std::string>{"all"};
    work.methods = named(stability_methods(), all ? std::vector<std::string>{} : options.methods, "methods");
    if (options.methods.empty()) std::erase_if(work.methods, [&](const Model& m) { return !is_shown(m, options.quick); });
    work.steps = stability_steps(options.quick);
    work.quick = options.quick;
    return work;
}

ResultTable open_stability_table(const std::filesystem::path& dir)
{
    make_folder(dir);
    return ResultTable(dir / stability_table_file, columns, key_columns);
}

StabilityProgress run_stability(const StabilityWork& work, const StabilityOptions& options)
{
    const StopSignal listening("the same command continues");
    return Workers(work, options).run();
}

std::string stability_summary(const StabilityWork& work, const ResultTable& table, const std::filesystem::path& dir)
{
    std::string text = fmt::format("{:<14}", "cells that hold");
    for (const Model& method : work.methods) text += fmt::format("  {}", method.name);
    text += "\n";
    std::string broken;
    for (const StabilityMap& map : work.maps) {
        for (const std::string& line : doubts(work, table, map)) broken += line + "\n";
        text += fmt::format("{:<15}", map.name);
        for (const Model& method : work.methods) {
            const Count count = count_cells(work, table, map, method);
            const std::string cell = count.all ? fmt::format("{}/{}", count.hold, count.all) : "-";
            text += fmt::format("  {:>{}}", cell, method.name.size());
        }
        text += "\n";
        for (const double value : work.values(map))
            for (const double dt : work.steps) {
                const Row* row = table.find(key_of(map, default_method(), dt, value));
                if (!row || (*row)[outcome_column] == name(Outcome::Hold)) continue;
                broken += fmt::format("default does not hold: {} at {} s, {} = {}\n  seldinger run {} {}\n",
                                      (*row)[outcome_column], dt, map.axis, value, map_scene(map, dir), (*row)[set_column]);
            }
    }
    return text + broken;
}

std::string stability_json(const StabilityWork& work, const ResultTable& table, const std::filesystem::path& dir)
{
    nlohmann::ordered_json json;
    for (const StabilityMap& map : work.maps) {
        nlohmann::ordered_json entry = {
            {"name", map.name}, {"rows", map.rows}, {"title", map.title}, {"axis", map.axis}, {"logarithmic", map.logarithmic}};
        for (const Model& method : work.methods) {
            const Count count = count_cells(work, table, map, method);
            if (count.all)
                entry["methods"][method.name] = {{"hold", count.hold}, {"cells", count.all}, {"unfinished", count.unfinished}};
            else entry["left_out"][method.name] = why_not_in(map, method, dir / "scenes");
        }
        const std::vector<std::string> lines = doubts(work, table, map);
        if (!lines.empty()) entry["doubts"] = lines;
        json["maps"].push_back(std::move(entry));
    }
    return json_text(json, 2) + "\n";
}

}  // namespace seldinger::apps
