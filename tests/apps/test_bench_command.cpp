// seldinger bench: its files and refusals.

#include "apps/app_fixture.h"

namespace test_bench_command {

using namespace seldinger::test;

TEST_SUITE("apps/bench")
{
    TEST_CASE(
        "property: --quick --json measures every kernel in both precisions and a scene; a folder of results is not written over")
    {
        const ScratchFolder folder;
        const fs::path scene = folder.write("tube.toml", tube_scene(0.05));
        const std::string command = "bench --quick --json -o D --scenes " + scene.string();
        const AppResult done = run_app(folder, command);
        REQUIRE(done.code == 0);
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
        const AppResult again = run_app(folder, command);
        CHECK(again.code == 2);
        CHECK(again.error_lines() == 1);
        CHECK(again.err.find("--overwrite") != std::string::npos);
        CHECK(slurp(folder.path / "D" / "kernels.csv") == before);
    }

    TEST_CASE("property: a wrong command line is refused in one line before anything is measured")
    {
        const ScratchFolder folder;
        const AppResult device = run_app(folder, "bench --device 99");
        CHECK(device.code == 5);
        CHECK(device.error_lines() == 1);
        CHECK(device.err.find("--device 99") != std::string::npos);
        CHECK(run_app(folder, "bench --device -1").code == 2);
        CHECK(run_app(folder, "bench --repeat 0").code == 2);
        CHECK(run_app(folder, "bench --qick").code == 2);
        const AppResult missing = run_app(folder, "bench --quick --scenes none.toml -o D");
        CHECK(missing.code == 3);
        CHECK(missing.error_lines() == 1);
        CHECK_FALSE(fs::exists(folder.path / "D"));
    }
}

}  // namespace test_bench_command
