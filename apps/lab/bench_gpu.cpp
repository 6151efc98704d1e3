// Many wires on a graphics card, against the default CPU device: the JSON object of `seldinger bench --gpu` and its table.
#include "lab/bench_gpu.h"

#include "assets.h"
#include "commit.h"
#include "core/error.h"
#include "device/device.h"
#include "device/enumerate.h"
#include "io/json_text.h"
#include "lab/fleet_bench.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace seldinger::apps {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* fleet_scene = "scenes/study/thousand.toml";

Json describe(int index)
{
    const device::DeviceDetails details = device::device_details(index);
    const DeviceInfo info = list_devices()[static_cast<std::size_t>(index)];
    return {{"index", index},
            {"name", info.name},
            {"vendor", details.vendor},
            {"platform", info.platform},
            {"type", info.type},
            {"version", info.version},
            {"driver", info.driver},
            {"fp64", info.fp64},
            {"compute_units", info.compute_units},
            {"memory_bytes", info.memory_bytes},
            {"local_memory_bytes", details.local_memory_bytes},
            {"clock_mhz", details.clock_mhz},
            {"timer_ns", details.timer_ns}};
}

Json kernels_of(const FleetTiming& fleet)
{
    const double steps = static_cast<double>(fleet.steps);
    Json kernels = Json::array();
    for (const device::KernelProfile& k : fleet.profile.kernels)
        kernels.push_back({{"kernel", k.kernel},
                           {"group", k.workgroup},
                           {"launches_per_step", static_cast<double>(k.launches) / steps},
                           {"items_per_launch", static_cast<double>(k.items) / static_cast<double>(k.launches)},
                           {"us_per_launch", 1e6 * k.seconds / static_cast<double>(k.launches)},
                           {"us_per_step", 1e6 * k.seconds / steps}});
    return kernels;
}

Json row_of(const FleetTiming& fleet, const char* precision)
{
    const double steps = static_cast<double>(fleet.steps);
    return {{"precision", precision},
            {"wires", fleet.wires},
            {"steps", fleet.steps},
            {"step_us", 1e6 * fleet.step},
            {"wire_steps_per_s", fleet.wires / fleet.step},
            {"newton_per_step", fleet.newton},
            {"detect_us", 1e6 * fleet.stages.detect},
            {"evaluate_us", 1e6 * fleet.stages.evaluate},
            {"reduce_us", 1e6 * fleet.stages.reduce},
            {"solve_us", 1e6 * fleet.stages.solve},
            {"adapt_us", 1e6 * fleet.stages.adapt},
            {"rest_us", 1e6 * (fleet.step - fleet.stages.in_all())},
            {"launches_per_step", fleet.launches},
            {"reads_per_step", fleet.reads},
            {"writes_per_step", fleet.writes},
            {"bytes_to_device_per_step", static_cast<double>(fleet.profile.bytes_written) / steps},
            {"bytes_from_device_per_step", static_cast<double>(fleet.profile.bytes_read) / steps},
            {"write_us", 1e6 * fleet.profile.write_seconds / steps},
            {"read_us", 1e6 * fleet.profile.read_seconds / steps},
            {"kernels", kernels_of(fleet)},
            {"state_hash", fleet.state_hash}};
}

std::optional<int> other_cpu(int device)
{
    const std::vector<DeviceInfo> list = list_devices();
    const int reference = device::default_device();
    if (reference == device || list[static_cast<std::size_t>(reference)].type != "CPU") return std::nullopt;
    return reference;
}

}  // namespace

std::string measure_gpu(const GpuBench& how, const std::function<void(const std::string&)>& show,
                        const std::function<bool()>& stop)
{
    const int device = how.device < 0 ? device::default_device() : how.device;
    const std::optional<int> reference = other_cpu(device);
    Json out = {{"scene", fleet_scene}, {"commit", SELDINGER_COMMIT}, {"device", describe(device)}};
    out["reference"] = reference ? describe(*reference) : Json();
    out["rows"] = Json::array();
    for (const char* precision : {"float64", "float32"}) {
        if (std::string(precision) == "float64" && !out["device"]["fp64"].get<bool>()) continue;
        const std::array<std::string, 1> overrides = {fmt::format("contact.precision=\"{}\"", precision)};
        const Scene scene = read_scene(assets_folder() / fleet_scene, overrides);
        for (const int wires : how.wires) {
            show(fmt::format("{} wires, {}", wires, precision));
            const FleetTiming fleet = time_fleet(scene, device, wires, how.steps, stop);
            Json row = row_of(fleet, precision);
            if (reference) {
                show(fmt::format("{} wires, {}, on the CPU", wires, precision));
                const FleetTiming on_cpu = time_fleet(scene, *reference, wires, how.steps, stop);
                row["reference_step_us"] = 1e6 * on_cpu.step;
                row["reference_hash"] = on_cpu.state_hash;
                row["largest_distance_m"] = distance_of(fleet, on_cpu);
            }
            out["rows"].push_back(row);
        }
    }
    return out.dump(1) + "\n";
}

std::string gpu_summary(const std::string& text)
{
    const Json json = Json::parse(text);
    std::string out = fmt::format("{} ({}), driver {}\n", json["device"]["name"].get<std::string>(),
                                  json["device"]["platform"].get<std::string>(), json["device"]["driver"].get<std::string>());
    out += fmt::format("{:>10} {:>6} {:>12} {:>12} {:>9} {:>10} {:>10} {:>12}\n", "precision", "wires", "us per step",
                       "on the CPU", "launches", "kB up", "kB down", "apart [m]");
    for (const Json& row : json["rows"]) {
        const bool compared = row.contains("reference_step_us");
        out += fmt::format("{:>10} {:>6} {:>12.0f} {:>12} {:>9.1f} {:>10.1f} {:>10.1f} {:>12}\n",
                           row["precision"].get<std::string>(), row["wires"].get<int>(), row["step_us"].get<double>(),
                           compared ? fmt::format("{:.0f}", row["reference_step_us"].get<double>()) : "-",
                           row["launches_per_step"].get<double>(), row["bytes_to_device_per_step"].get<double>() / 1e3,
                           row["bytes_from_device_per_step"].get<double>() / 1e3,
                           compared ? fmt::format("{:.1e}", row["largest_distance_m"].get<double>()) : "-");
    }
    return out;
}

}  // namespace seldinger::apps
