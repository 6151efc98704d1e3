// seldinger bench: its files and refusals.

#include "apps/app_fixture.h"
#include "device/enumerate.h"
#include "engine.h"
#include "support/approx.h"
#include "support/skip.h"

namespace seldinger::test::test_bench_command {

TEST_SUITE("apps/bench")
{
    TEST_CASE(
        "property: --quick --json measures every kernel in both precisions and a scene; a folder of results is not written over")
    {
        const ScratchFolder folder;
        const fs::path scene = folder.write("tube.toml", tube_scene(0.05));
        const std::string command = "bench --quick --json -o D --scenes " + scene.string();
        const AppResult done = run_ok(folder, command);
        const auto json = nlohmann::json::parse(done.out);
        REQUIRE(json["lanes"].size() >= 1);
        for (const auto& lane : json["lanes"])
            for (const char* rate : {"gb_per_s", "cached_gb_per_s", "gflop_per_s_float", "launch_us", "round_trip_us"}) {
                CAPTURE(rate);
                CHECK(lane[rate].get<double>() > 0);
            }
        // ten kernels, two precisions where there is fp64, on each lane
        const std::size_t precisions = json["fp64"].get<bool>() ? 2 : 1;
        CHECK(json["kernels"].size() == 10 * precisions * json["lanes"].size());
        for (const auto& kernel : json["kernels"]) {
            CAPTURE(kernel.dump());
            CHECK(kernel["time_us"].get<double>() > 0);
            CHECK(kernel["gflop_per_s"].get<double>() > 0);
            CHECK(kernel["gb_per_s"].get<double>() > 0);
            CHECK(kernel["share_of_roof"].get<double>() > 0);
        }
        if (precisions == 2) {
            REQUIRE(json["scenes"].size() == 1);
            const auto& row = json["scenes"][0];
            CHECK(row["scene"] == "tube.toml");
            CHECK(row["steps"] == 50);  // the scene is shorter than what --quick takes
            CHECK(row["steps_per_s"].get<double>() > 0);
            CHECK(row["state_hash"].get<std::string>().size() == 16);
        }
        for (const char* file : {"device.csv", "kernels.csv"}) {
            const auto rows = csv_rows(folder.path / "D" / file);
            REQUIRE(rows.size() > 1);
            CHECK(rows[0][0] == "date");
            CHECK(rows[0][1] == "commit");
            for (const auto& row : rows) CHECK(row.size() >= 10);
        }
        const std::string before = slurp(folder.path / "D" / "kernels.csv");
        check_refused(folder, command, 2, "--overwrite");
        CHECK(slurp(folder.path / "D" / "kernels.csv") == before);
    }

    TEST_CASE("property: --gpu counts what each number of wires takes, and compares the device with the processor")
    {
        const std::vector<DeviceInfo> devices = list_devices();
        const auto basic = std::find_if(devices.begin(), devices.end(), [](const DeviceInfo& d) {
            return device::pocl_device(d.platform, d.name) == device::PoclDevice::Caller;
        });
        if (basic == devices.end()) return skip("needs PoCL's caller's-thread device beside the threaded one");
        const ScratchFolder folder;
        const std::string command = fmt::format("bench --gpu --quick --wires 1,3 --device {} --json -o D", basic->index);
        const AppResult done = run_ok(folder, command);
        const auto json = nlohmann::json::parse(done.out);
        CHECK(nlohmann::json::parse(slurp(folder.path / "D" / "gpu.json")) == json);
        CHECK(json["device"]["name"] == basic->name);
        CHECK(json["reference"]["name"] == devices[static_cast<std::size_t>(device::default_device())].name);
        REQUIRE(json["rows"].size() == 4);  // both precisions
        for (std::size_t at = 0; at < 4; ++at) {
            const auto& row = json["rows"][at];
            CAPTURE(row.dump());
            CHECK(row["wires"] == (at % 2 == 0 ? 1 : 3));
            CHECK(row["steps"] == 3);
            CHECK(row["state_hash"] == row["reference_hash"]);  // the same code on the same processor
            CHECK(row["largest_distance_m"] == 0.0);
            double launches = 0;
            for (const auto& kernel : row["kernels"]) {
                launches += kernel["launches_per_step"].get<double>();
                CHECK(kernel["us_per_launch"].get<double>() > 0);
            }
            // the second run, which is timed by events, launches what the first one did
            CHECK(launches == about(row["launches_per_step"].get<double>()));
        }
        // three times as many wires: the same launches, and three times as many bytes but for those of the launch itself; a
        // device that reads the host's own memory is written nothing
        const auto &one = json["rows"][0], &three = json["rows"][1];
        for (const char* bytes : {"bytes_to_device_per_step", "bytes_from_device_per_step"}) {
            CAPTURE(bytes);
            CHECK(three[bytes].get<double>() == about(3 * one[bytes].get<double>()).epsilon(0.1));
        }
        CHECK(three["kernels"][0]["items_per_launch"] == 3 * one["kernels"][0]["items_per_launch"].get<double>());
        check_refused(folder, command, 2, "--overwrite");
        CHECK(run_app(folder, "bench --gpu --wires 0").code == 2);
    }

    TEST_CASE("property: a wrong command line is refused in one line before anything is measured")
    {
        const ScratchFolder folder;
        const AppResult device = check_refused(folder, "bench --device 99", 5, "--device 99");
        CHECK(run_app(folder, "bench --device -1").code == 2);
        CHECK(run_app(folder, "bench --repeat 0").code == 2);
        CHECK(run_app(folder, "bench --qick").code == 2);
        const AppResult missing = run_app(folder, "bench --quick --scenes none.toml -o D");
        CHECK(missing.code == 3);
        CHECK(missing.error_lines() == 1);
        CHECK_FALSE(fs::exists(folder.path / "D"));
    }
}

}  // namespace seldinger::test::test_bench_command
