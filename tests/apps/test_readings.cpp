// What a run says of its readings: the band of its step, exits, a last step that is shorter, friction that was raised.
#include "apps/app_fixture.h"
#include "support/approx.h"

#include <cmath>

namespace seldinger::test::test_readings {

namespace {

/// A wire fed through a tube of 4 cm that is open at both ends.
const std::string through =
    "[scene]\nduration_s = 0.5\ndt_s = 0.003\nrecord_every = 5\ngravity = [0.0, 0.0, -9.81]\n"
    "[wire]\nlength_m = 0.12\nradius_m = 0.0004\ndensity = 7900.0\nbend_nm2 = 1e-4\ntwist_nm2 = 8e-5\nstretch_n = 1e4\nnodes = "
    "41\n"
    "[vessel]\nshape = \"tube\"\naxis = [1.0, 0.0, 0.0]\nradius_m = 0.004\nlength_m = 0.04\ntriangles = 2000\n"
    "[feed]\npoint = [0.002, 0.0, -0.003]\ndirection = [1.0, 0.0, -0.04]\n"
    "keys = [{ t_s = 0.0, advance_m = 0.005 }, { t_s = 0.5, advance_m = 0.055 }]\n";

}  // namespace

TEST_SUITE("apps/readings")
{
    TEST_CASE("a run names its band, its exits and the whole of its duration; the estimate leaves its bits alone")
    {
        const ScratchFolder folder{{"t.toml", through}};
        const AppResult with = run_ok(folder, "run t.toml -o A --error-estimate on");
        run_ok(folder, "run t.toml -o B --error-estimate off --quiet");
        const auto a = nlohmann::json::parse(slurp(folder.path / "A/summary.json"));
        const auto b = nlohmann::json::parse(slurp(folder.path / "B/summary.json"));
        CHECK(a["state_hash"] == b["state_hash"]);
        CHECK_FALSE(b.contains("error_estimate"));
        CHECK(a["error_estimate"]["windows"].get<int>() >= 1);
        CHECK(has(with.out, "± mostly by the "));
        // a band is the root of the sum of squares of its shares, and names the largest
        for (const char* reading :
             {"hand_force_n", "hand_force_peak_n", "friction_n", "friction_peak_n", "patch_force_max_n", "hand_work_j"}) {
            CAPTURE(reading);
            const auto& band = a["error_estimate"][reading];
            const double step = band["step"].get<double>(), nodes = band["nodes"].get<double>(),
                         facets = band["facets"].get<double>();
            REQUIRE(band["band"].get<double>() > 0);
            CHECK(band["band"].get<double>() == about(1.1 * std::hypot(step, 1.5 * nodes, facets)).epsilon(1e-9));
            CHECK(nodes > 0);
            CHECK(facets > 0);
            const std::string largest = band["largest_source"].get<std::string>();  // as it counts in the band
            CHECK(band[largest].get<double>() * (largest == "nodes" ? 1.5 : 1.0) == std::max({step, 1.5 * nodes, facets}));
        }
        CHECK(a["error_estimate"]["hand_work_j"]["value"] == a["hand_work_j"]);
        CHECK(a["error_estimate"]["patch_force_max_n"]["value"] == a["patch_force_max_n"]);
        // means over 20 ms in both runs, with and without bands
        CHECK(a["end_mean_s"].get<double>() == about(0.02).epsilon(1e-9));
        CHECK(a["error_estimate"]["end_mean_s"] == a["end_mean_s"]);
        CHECK(a["error_estimate"]["hand_force_n"]["value"].get<double>() ==
              about(a["hand_force_mean_n"].get<double>()).epsilon(1e-12));
        CHECK(a["error_estimate"]["friction_n"]["value"].get<double>() ==
              about(a["friction_mean_n"].get<double>()).epsilon(1e-12));
        CHECK(b["hand_force_mean_n"] == a["hand_force_mean_n"]);
        // 500 ms in steps of 3 ms: 166 of them, and one of 2 ms
        CHECK(a["steps"].get<int>() == 167);
        CHECK(a["simulated_s"].get<double>() == about(0.5).epsilon(1e-12));
        CHECK(a["inserted_m"].get<double>() == about(0.05).epsilon(1e-9));
        // the tip goes from 7 mm to 57 mm of a tube of 40 mm
        REQUIRE(a["left_through"].size() == 1);
        CHECK(a["left_through"][0]["centre_m"][0].get<double>() == about(0.04).epsilon(1e-6));
        CHECK(a["left_through"][0]["left_s"].get<double>() == about(0.33).epsilon(0.02));
        CHECK(has(with.out, "left through inlet"));
        CHECK(a["outside_max_m"].get<double>() == 0);
        CHECK(a["contact_regions_max"].get<int>() >= 1);
        CHECK(a["force_per_length_max_n_per_m"].get<double>() > 0);
    }

    TEST_CASE("property: of a batch, the table and the last line say which tip left through which inlet")
    {
        const ScratchFolder folder{{"t.toml", through}};
        folder.write("v.toml", "[vary]\n\"scene.duration_s\" = [0.3, 0.5]\n");  // 30 and 50 mm beyond 7 mm of 40 mm
        const AppResult result = run_ok(folder, "batch t.toml --vary v.toml -o out");
        CHECK(result.out.ends_with("tips ended in branch 1 (1 run), left the vessel through inlet 2 (1 run)\n"));
        const auto summary = nlohmann::json::parse(slurp(folder.path / "out/summary.json"));
        CHECK(summary["branches"] == nlohmann::json{{"1", 1}});
        CHECK(summary["left_through"] == nlohmann::json{{"2", 1}});
        CHECK(has(run_app(folder, "vessel t.toml").out, "inlet 2: [0.04"));
    }

    TEST_CASE("property: a tip on the closed end of a mesh is a warning with place and time; one that stops before it is none")
    {
        const ScratchFolder folder;
        // a tube of 4 cm along x, open at 0 and closed by a fan at its end
        constexpr int around = 24, along = 20;
        std::string obj;
        for (int i = 0; i <= along; ++i)
            for (int k = 0; k < around; ++k)
                obj += fmt::format("v {} {} {}\n", 40.0 * i / along, 4 * std::cos(2 * M_PI * k / around),
                                   4 * std::sin(2 * M_PI * k / around));
        obj += "v 40 0 0\n";
        for (int k = 0; k < around; ++k) {
            const int next = (k + 1) % around;
            for (int i = 0; i < along; ++i)
                obj += fmt::format("f {} {} {} {}\n", 1 + i * around + k, 1 + (i + 1) * around + k, 1 + (i + 1) * around + next,
                                   1 + i * around + next);
            obj += fmt::format("f {} {} {}\n", 1 + along * around + k, 1 + (along + 1) * around, 1 + along * around + next);
        }
        folder.write("capped.obj", obj);
        const auto scene = [](double depth) {
            return fmt::format(
                "[scene]\nduration_s = 0.4\ndt_s = 0.002\nrecord_every = 5\n"
                "[wire]\nlength_m = 0.08\nradius_m = 0.0004\ndensity = 7900.0\nbend_nm2 = 1e-4\ntwist_nm2 = 8e-5\nstretch_n = "
                "1e4\nnodes = 41\n"
                "[vessel]\nmesh = \"capped.obj\"\nunits = \"mm\"\n[feed]\ninlet = \"auto\"\n"
                "keys = [{{ t_s = 0.0, advance_m = 0.02 }}, {{ t_s = 0.4, advance_m = {} }}]\n",
                depth);
        };
        folder.write("into.toml", scene(0.042));
        folder.write("before.toml", scene(0.036));
        const AppResult into = run_ok(folder, "run into.toml -o A"), before = run_app(folder, "run before.toml -o B");
        REQUIRE(before.code == 0);
        CAPTURE(into.out);
        // 55 mm/s from 20 mm: the tip is at 40 mm after 0.364 s, its surface a radius earlier; rows are 10 ms apart
        const std::size_t said = into.out.find("the tip pressed on a closed end of the vessel from 0.3");
        CHECK(said != std::string::npos);
        CHECK_FALSE(has(before.out, "closed end"));
        const auto warnings = nlohmann::json::parse(slurp(folder.path / "A/summary.json"))["warnings"].dump();
        CHECK(has(warnings, "Cut the mesh open there"));
    }

    TEST_CASE("friction: a mu_static below mu_sliding is refused where it is given, raised and told where it is not")
    {
        const ScratchFolder folder{{"t.toml", through}};
        const AppResult refused = check_refused(
            folder, "run t.toml -o A --set contact.mu_static=0.1 --set contact.mu_sliding=0.3", 2, "contact.mu_static");
        CHECK(has(refused.err, "0.3"));
        const AppResult told = run_ok(folder, "run t.toml -o A --set contact.mu_sliding=0.3 --set scene.duration_s=0.03");
        CHECK(told.out.find("contact.mu_static is 0.3 (raised from 0.12") != std::string::npos);
    }

    TEST_CASE("vessel: text and JSON are in metres and say so; files say their unit")
    {
        const ScratchFolder folder{{"t.toml", through}};
        const AppResult text = run_ok(folder, "vessel t.toml -o V"), json = run_app(folder, "vessel t.toml -o W --json");
        REQUIRE(json.code == 0);
        const auto report = nlohmann::json::parse(json.out);
        CHECK(report["length_unit"] == "m");
        CHECK(report["files_unit"] == "mm");
        CHECK(has(text.out, "(in mm)"));
        CHECK(has(text.out, "radius 0.00400 m"));
        CHECK(has(slurp(folder.path / "V/vessel.stl").substr(0, 80), "UNITS=mm"));
    }
}

}  // namespace seldinger::test::test_readings
