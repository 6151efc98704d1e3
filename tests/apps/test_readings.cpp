// What a run says of its readings: the band of its step, exits, a last step that is shorter, friction that was raised.
#include "apps/app_fixture.h"

namespace test_readings {

using namespace seldinger::test;

namespace {

/// A wire fed through a tube of 4 cm that is open at both ends.
const std::string through =
    "[scene]\nduration_s = 0.5\ndt_s = 0.003\nrecord_every = 5\ngravity = [0.0, 0.0, -9.81]\n"
    "[wire]\nlength_m = 0.12\nradius_m = 0.0004\ndensity = 7900.0\nbend_nm2 = 1e-4\ntwist_nm2 = 8e-5\nstretch_n = 1e4\nnodes = 41\n"
    "[vessel]\nshape = \"tube\"\naxis = [1.0, 0.0, 0.0]\nradius_m = 0.004\nlength_m = 0.04\ntriangles = 2000\n"
    "[feed]\npoint = [0.002, 0.0, -0.003]\ndirection = [1.0, 0.0, -0.04]\n"
    "keys = [{ t_s = 0.0, advance_m = 0.005 }, { t_s = 0.5, advance_m = 0.055 }]\n";

}  // namespace

TEST_SUITE("apps/readings")
{
    TEST_CASE("a run names its band, its exits and the whole of its duration; the estimate leaves its bits alone")
    {
        const ScratchFolder folder;
        folder.write("t.toml", through);
        const AppResult with = run_app(folder, "run t.toml -o A --error-estimate on");
        REQUIRE(with.code == 0);
        REQUIRE(run_app(folder, "run t.toml -o B --error-estimate off --quiet").code == 0);
        const auto a = nlohmann::json::parse(slurp(folder.path / "A/summary.json"));
        const auto b = nlohmann::json::parse(slurp(folder.path / "B/summary.json"));
        CHECK(a["state_hash"] == b["state_hash"]);
        CHECK_FALSE(b.contains("error_estimate"));
        CHECK(a["error_estimate"]["windows"].get<int>() >= 1);
        CHECK(with.out.find("error of the step") != std::string::npos);
        // 500 ms in steps of 3 ms: 166 of them, and one of 2 ms
        CHECK(a["steps"].get<int>() == 167);
        CHECK(a["simulated_s"].get<double>() == doctest::Approx(0.5).epsilon(1e-12));
        CHECK(a["inserted_m"].get<double>() == doctest::Approx(0.05).epsilon(1e-9));
        // the tip goes from 7 mm to 57 mm of a tube of 40 mm
        REQUIRE(a["left_through"].size() == 1);
        CHECK(a["left_through"][0]["centre_m"][0].get<double>() == doctest::Approx(0.04).epsilon(1e-6));
        CHECK(a["left_through"][0]["left_s"].get<double>() == doctest::Approx(0.33).epsilon(0.02));
        CHECK(with.out.find("left through opening") != std::string::npos);
        CHECK(a["outside_max_m"].get<double>() == 0);
        CHECK(a["contact_regions_max"].get<int>() >= 1);
        CHECK(a["force_per_length_max_n_per_m"].get<double>() > 0);
    }

    TEST_CASE("friction: a mu_static below mu_sliding is refused where it is given, raised and told where it is not")
    {
        const ScratchFolder folder;
        folder.write("t.toml", through);
        const AppResult refused = run_app(folder, "run t.toml -o A --set contact.mu_static=0.1 --set contact.mu_sliding=0.3");
        CHECK(refused.code == 2);
        CHECK(refused.err.find("contact.mu_static") != std::string::npos);
        CHECK(refused.err.find("0.3") != std::string::npos);
        const AppResult told = run_app(folder, "run t.toml -o A --set contact.mu_sliding=0.3 --set scene.duration_s=0.03");
        REQUIRE(told.code == 0);
        CHECK(told.out.find("contact.mu_static is 0.3 (raised from 0.12") != std::string::npos);
    }

    TEST_CASE("vessel: text and JSON are in metres and say so; files say their unit")
    {
        const ScratchFolder folder;
        folder.write("t.toml", through);
        const AppResult text = run_app(folder, "vessel t.toml -o V"), json = run_app(folder, "vessel t.toml -o W --json");
        REQUIRE(text.code == 0);
        REQUIRE(json.code == 0);
        const auto report = nlohmann::json::parse(json.out);
        CHECK(report["length_unit"] == "m");
        CHECK(report["files_unit"] == "mm");
        CHECK(text.out.find("(in mm)") != std::string::npos);
        CHECK(text.out.find("radius 0.00400 m") != std::string::npos);
        CHECK(slurp(folder.path / "V/vessel.stl").substr(0, 80).find("UNITS=mm") != std::string::npos);
    }
}

}  // namespace test_readings
