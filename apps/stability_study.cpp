#include "stability_study.h"

#include "core/error.h"
#include "core/file_io.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <exception>
#include <mutex>
#include <thread>

namespace seldinger::apps {
namespace {

using Row = ResultTable::Row;

const std::vector<std::string> columns = {"map", "method", "dt_s", "value", "outcome", "failed_step", "steps", "simulated_s", "overlap_m",
                                          "overlap_limit_m", "outside_m", "jitter", "energy_made_j", "hand_force_n", "sub_steps",
                                          "newton_mean", "finished", "set"};
constexpr std::size_t key_columns = 4, outcome_column = 4, set_column = 17;

Row key_of(const StabilityMap& map, const Model& method, double dt, double value)
{
    return {map.name, method.name, csv_number(dt), csv_number(value)};
}

Row row_of(const StabilityMap& map, const Model& method, double dt, double value, const CellResult& cell, const std::filesystem::path& folder)
{
    Row row = key_of(map, method, dt, value);
    const Verdict& verdict = cell.verdict;
    const FailureReadings& r = verdict.readings;
    const auto count = [](long n) { return fmt::format("{}", n); };
    row.insert(row.end(), {name(verdict.outcome), count(verdict.held() ? -1 : verdict.first_step[static_cast<std::size_t>(verdict.outcome)]),
                           count(r.steps), csv_number(cell.simulated), csv_number(r.overlap), csv_number(cell.overlap_limit), csv_number(r.outside),
                           csv_number(r.jitter), csv_number(r.energy_made), csv_number(r.hand_force), count(r.sub_steps),
                           csv_number(r.mean_iterations), cell.over_limit ? "0" : "1"});
    std::string texts;
    std::vector<std::string> all = map.set(value, dt, 1, folder);
    all.push_back(fmt::format("scene.dt_s={}", dt));
    for (const std::string& text : all) texts += fmt::format("{}--set '{}'", texts.empty() ? "" : " ", text);
    row.push_back(texts.size() < 1000 ? texts : "");  // a load for every step is too long for a command line
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
        if (at == all.end()) throw Error(ExitCode::BadScene, fmt::format("--{}: \"{}\" is none; expected of: {}", what, wanted, known));
        found.push_back(*at);
    }
    return found;
}

/// The cells of one map and value, which share what a static load does there.
struct Strip {
    const StabilityMap* map;
    double value;
    std::vector<std::pair<const Model*, double>> cells;  // method, dt
};

class Workers {
public:
    Workers(const StabilityWork& work, const StabilityOptions& options)
        : options_(options), scenes_(options.dir / "scenes"), table_(open_stability_table(options.dir))
    {
        make_folder(scenes_);
        for (const StabilityMap& map : work.maps) {
            write_file(scenes_ / (map.name + ".toml"), map.scene);
            if (map.write_meshes) map.write_meshes(scenes_);
            std::vector<const Model*> here;
            for (const Model& method : work.methods)
                if (why_not_in(map, method, scenes_).empty()) here.push_back(&method);
            for (const double value : work.values(map)) {
                Strip strip{&map, value, {}};
                for (const Model* method : here)
                    for (const double dt : work.steps) {
                        ++progress_.asked;
                        if (!table_.find(key_of(map, *method, dt, value))) strip.cells.emplace_back(method, dt);
                    }
                progress_.left += static_cast<long>(strip.cells.size());
                if (!strip.cells.empty()) strips_.push_back(std::move(strip));
            }
        }
    }

    StabilityProgress run()
    {
        const int wanted = options_.jobs > 0 ? options_.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
        (void)list_devices();  // OpenCL starts up on one thread: its loader and PoCL are not safe in that
        std::vector<std::thread> threads;
        for (int k = 0; k < std::min<int>(wanted, static_cast<int>(strips_.size())); ++k) threads.emplace_back([this] { work_off(); });
        for (std::thread& thread : threads) thread.join();
        if (shown_) fmt::print(stderr, "\n");
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
        const double indentation = static_indentation(*strip.map, strip.value, scenes_);
        for (const auto& [method, dt] : strip.cells) {
            if (over()) return;
            const CellResult cell = run_stability_cell(*strip.map, *method, dt, strip.value, indentation, scenes_, options_.cell_limit);
            const std::scoped_lock lock(mutex_);
            table_.append(row_of(*strip.map, *method, dt, strip.value, cell, scenes_));
            --progress_.left;
            if (options_.quiet || isatty(STDERR_FILENO) == 0) continue;
            fmt::print(stderr, "\r{} of {} cells to go ({})        ", progress_.left, progress_.asked, strip.map->name);
            shown_ = true;
        }
    }

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
    long hold = 0, all = 0;
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
        }
    return count;
}

}  // namespace

StabilityWork select_work(const StabilityOptions& options)
{
    StabilityWork work;
    work.maps = named(stability_maps(), options.maps, "maps");
    work.methods = named(stability_methods(), options.methods, "methods");
    if (options.quick && options.methods.empty())
        std::erase_if(work.methods, [](const Model& m) {
            constexpr std::string_view quick[] = {"published", "linearised, swept", "explicit", "newton, capsule", "default"};
            return std::find(std::begin(quick), std::end(quick), m.name) == std::end(quick);
        });
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
    const StopSignal listening;
    return Workers(work, options).run();
}

std::string stability_summary(const StabilityWork& work, const ResultTable& table, const std::filesystem::path& dir)
{
    std::string text = fmt::format("{:<14}", "cells that hold");
    for (const Model& method : work.methods) text += fmt::format("  {}", method.name);
    text += "\n";
    std::string broken;
    for (const StabilityMap& map : work.maps) {
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
                broken += fmt::format("default does not hold: {} at {} s, {} = {}\n  seldinger run {} {}\n", (*row)[outcome_column], dt, map.axis,
                                      value, (dir / "scenes" / (map.name + ".toml")).string(), (*row)[set_column]);
            }
    }
    return text + broken;
}

std::string stability_json(const StabilityWork& work, const ResultTable& table, const std::filesystem::path& dir)
{
    nlohmann::ordered_json json;
    for (const StabilityMap& map : work.maps) {
        nlohmann::ordered_json entry = {{"name", map.name}, {"rows", map.rows}, {"title", map.title}, {"axis", map.axis}, {"logarithmic", map.logarithmic}};
        for (const Model& method : work.methods) {
            const Count count = count_cells(work, table, map, method);
            if (count.all) entry["methods"][method.name] = {{"hold", count.hold}, {"cells", count.all}};
            else entry["left_out"][method.name] = why_not_in(map, method, dir / "scenes");
        }
        json["maps"].push_back(std::move(entry));
    }
    return json.dump(2) + "\n";
}

}  // namespace seldinger::apps
