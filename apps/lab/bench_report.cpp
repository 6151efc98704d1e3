// Rows and columns of device.csv, kernels.csv and scenes.csv, and the share of its roof that each kernel reaches.
#include "lab/bench_report.h"

#include "commit.h"
#include "core/file_io.h"
#include "io/json_text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace seldinger::apps {
namespace {

using Json = nlohmann::ordered_json;

// A table is a list of rows, a row a list of named cells: the same for CSV and JSON.
using Table = std::vector<Json>;

std::string compiler()
{
#if defined(__clang__)
    return "clang " __clang_version__;
#else
    return "g++ " __VERSION__;
#endif
}

double rounded(double x)  // four digits: no timing has more
{
    if (!std::isfinite(x) || x == 0) return 0;
    const double unit = std::pow(10.0, std::floor(std::log10(std::fabs(x))) - 3);
    return std::stod(fmt::format("{:.4g}", std::round(x / unit) * unit));
}

Json origin(const BenchResults& r)
{
    return {
        {"date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())))},
        {"commit", SELDINGER_COMMIT},
        {"compiler", compiler()},
        {"device", r.device.name},
        {"driver", r.device.platform + ", " + r.device.version + ", " + r.device.driver}};
}

Table device_table(const BenchResults& r)
{
    Table table;
    for (const device::Peaks& p : r.peaks) {
        Json row = origin(r);
        row.update({{"lane", p.queue},
                    {"compute_units", r.device.compute_units},
                    {"gb_per_s", rounded(p.bandwidth / 1e9)},
                    {"cached_gb_per_s", rounded(p.cached_bandwidth / 1e9)},
                    {"gflop_per_s_float", rounded(p.flops_float / 1e9)},
                    {"width_float", p.width_float},
                    {"gflop_per_s_float_scalar", rounded(p.scalar_float / 1e9)},
                    {"gflop_per_s_double", rounded(p.flops_double / 1e9)},
                    {"width_double", p.width_double},
                    {"gflop_per_s_double_scalar", rounded(p.scalar_double / 1e9)},
                    {"launch_us", rounded(1e6 * p.launch)},
                    {"chained_us", rounded(1e6 * p.chained)},
                    {"round_trip_us", rounded(1e6 * p.round_trip)}});
        table.push_back(row);
    }
    return table;
}

Table kernel_table(const BenchResults& r)
{
    Table table;
    for (const kernel_bench::KernelTiming& t : r.kernels) {
        Json row = origin(r);
        row.update({{"kernel", t.kernel},
                    {"precision", t.float32 ? "float32" : "float64"},
                    {"lane", t.queue},
                    {"items", t.items},
                    {"time_us", rounded(1e6 * t.time)},
                    {"ns_per_item", rounded(1e9 * t.time / static_cast<double>(t.items))},
                    {"mpairs_per_s", rounded(t.pairs / t.time / 1e6)},
                    {"gflop_per_s", rounded(t.flops / t.time / 1e9)},
                    {"gb_per_s", rounded(t.bytes / t.time / 1e9)},
                    {"flop_per_byte", rounded(t.flops / t.bytes)},
                    {"share_of_roof", rounded(share_of_peak(t, r.peaks))}});
        table.push_back(row);
    }
    return table;
}

Table scene_table(const BenchResults& r)
{
    Table table;
    for (const SceneTiming& s : r.scenes) {
        Json row = origin(r);
        row.update({{"scene", s.scene},
                    {"steps", s.steps},
                    {"triangles", s.triangles},
                    {"nodes", s.nodes},
                    {"contacts_max", s.contacts_max},
                    {"load_s", rounded(s.load)},
                    {"steps_per_s", rounded(s.rate)},
                    {"lowest", rounded(s.lowest)},
                    {"highest", rounded(s.highest)},
                    {"detect_ms", rounded(1e3 * s.stages.detect)},
                    {"evaluate_ms", rounded(1e3 * s.stages.evaluate)},
                    {"reduce_ms", rounded(1e3 * s.stages.reduce)},
                    {"solve_ms", rounded(1e3 * s.stages.solve)},
                    {"wall_ms", 0.0},
                    {"adapt_ms", rounded(1e3 * s.stages.adapt)},
                    {"other_ms", rounded(1e3 * std::max(0.0, s.other))},
                    {"newton_per_step", rounded(s.newton)},
                    {"launches_per_step", rounded(s.launches)},
                    {"reads_per_step", rounded(s.reads)},
                    {"writes_per_step", rounded(s.writes)},
                    {"buffers_made", s.buffers},
                    {"programs_built", s.programs},
                    {"state_hash", s.state_hash}});
        table.push_back(row);
    }
    return table;
}

std::string cell(const Json& value)
{
    if (!value.is_string()) return value.dump();
    std::string text = value.get<std::string>();
    if (text.find_first_of(",\"") == std::string::npos) return text;
    for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2) text.insert(at, 1, '"');
    return '"' + text + '"';
}

std::string csv(const Table& table)
{
    std::string text;
    for (std::size_t k = 0; k <= table.size() && !table.empty(); ++k) {
        std::string line;
        for (const auto& [name, value] : table[k == 0 ? 0 : k - 1].items())
            line += (line.empty() ? "" : ",") + (k == 0 ? name : cell(value));
        text += line + "\n";
    }
    return text;
}

const device::Peaks& peaks_of(const std::string& lane, const std::vector<device::Peaks>& peaks)
{
    const auto found = std::find_if(peaks.begin(), peaks.end(), [&](const device::Peaks& p) { return p.queue == lane; });
    return found != peaks.end() ? *found : peaks.front();
}

}  // namespace

double share_of_peak(const kernel_bench::KernelTiming& t, const std::vector<device::Peaks>& peaks)
{
    const device::Peaks& p = peaks_of(t.queue, peaks);
    // the time that the launch would take at the higher of the two limits, over its measured time
    return std::max(t.flops / (t.float32 ? p.flops_float : p.flops_double), t.bytes / std::max(p.cached_bandwidth, p.bandwidth)) /
           t.time;
}

void write_bench(const BenchResults& results, const std::filesystem::path& dir)
{
    make_folder(dir);
    write_file(dir / "device.csv", csv(device_table(results)));
    write_file(dir / "kernels.csv", csv(kernel_table(results)));
    write_file(dir / "scenes.csv", csv(scene_table(results)));
}

std::string bench_json(const BenchResults& r)
{
    Json out = origin(r);
    out["version"] = version();
    out["device_index"] = r.device.index;
    out["device_type"] = r.device.type;
    out["fp64"] = r.device.fp64;
    const auto same = origin(r);
    const auto bare = [&](Table table) {  // what is the same in all rows stands above them
        Json list = Json::array();
        for (Json& row : table) {
            for (const auto& [name, value] : same.items()) row.erase(name);
            list.push_back(row);
        }
        return list;
    };
    out["lanes"] = bare(device_table(r));
    out["kernels"] = bare(kernel_table(r));
    out["scenes"] = bare(scene_table(r));
    out["skipped"] = Json::array();
    for (const auto& skipped : r.skipped) out["skipped"].push_back({{"scene", skipped.scene}, {"reason", skipped.reason}});
    return json_text(out, 2) + "\n";
}

std::string bench_summary(const BenchResults& r)
{
    std::string text = fmt::format("{} ({}, {}): commit {}\n\n", r.device.name, r.device.type, r.chosen, SELDINGER_COMMIT);
    for (const device::Peaks& p : r.peaks) {
        text += fmt::format("{:6} {:.1f} GB/s from memory, {:.1f} from cache; {:.1f} GFLOP/s in float ({} wide; {:.1f} scalar)",
                            p.queue, p.bandwidth / 1e9, p.cached_bandwidth / 1e9, p.flops_float / 1e9, p.width_float,
                            p.scalar_float / 1e9);
        if (p.flops_double > 0)
            text += fmt::format(", {:.1f} in double ({} wide; {:.1f} scalar)", p.flops_double / 1e9, p.width_double,
                                p.scalar_double / 1e9);
        text += fmt::format("; a launch {:.2f} us, one more in a chain {:.2f}, write + launch + read {:.2f}\n", 1e6 * p.launch,
                            1e6 * p.chained, 1e6 * p.round_trip);
    }
    text += fmt::format("\n{:20} {:8} {:6} {:>7} {:>11} {:>9} {:>10} {:>9} {:>8} {:>7}\n", "kernel", "reals", "lane", "items",
                        "us", "ns/item", "Mpairs/s", "GFLOP/s", "GB/s", "roof");
    for (const kernel_bench::KernelTiming& t : r.kernels)
        text += fmt::format("{:20} {:8} {:6} {:7} {:11.2f} {:9.1f} {:10.2f} {:9.3f} {:8.2f} {:6.1f}%\n", t.kernel,
                            t.float32 ? "float32" : "float64", t.queue, t.items, 1e6 * t.time,
                            1e9 * t.time / static_cast<double>(t.items), t.pairs / t.time / 1e6, t.flops / t.time / 1e9,
                            t.bytes / t.time / 1e9, 100 * share_of_peak(t, r.peaks));
    if (!r.scenes.empty())
        text += fmt::format("\n{:20} {:>9} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6}\n", "scene", "triangles",
                            "nodes", "steps/s", "detect", "evaluate", "reduce", "solve", "adapt", "other", "launches", "reads");
    for (const SceneTiming& s : r.scenes)
        text += fmt::format("{:20} {:9} {:6} {:8.0f} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:8.4f} {:8.2f} {:6.2f}\n", s.scene,
                            s.triangles, s.nodes, s.rate, 1e3 * s.stages.detect, 1e3 * s.stages.evaluate, 1e3 * s.stages.reduce,
                            1e3 * s.stages.solve, 1e3 * s.stages.adapt, 1e3 * std::max(0.0, s.other), s.launches, s.reads);
    if (!r.scenes.empty()) text += "stages in ms per step; launches and read-backs per step\n";
    for (const auto& skipped : r.skipped) text += fmt::format("left out: {}: {}\n", skipped.scene, skipped.reason);
    return text;
}

}  // namespace seldinger::apps
