// `seldinger vessel` and `check`.

#include "apps/app_fixture.h"
#include "support/approx.h"

#include <cmath>

namespace seldinger::test::test_vessel_command {

TEST_SUITE("apps/vessel")
{
    TEST_CASE("analytic: the report of a generated tube")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        const AppResult result = run_ok(folder, "vessel t.toml --json");
        const auto report = nlohmann::json::parse(result.out);
        for (const char* key : {"triangles_read", "triangles", "vertices", "repairs", "loops", "centreline", "inlets"})
            CHECK(report.contains(key));
        CHECK(report["triangles"].get<int>() > 1500);
        CHECK(report["triangles"].get<int>() < 2500);
        REQUIRE(report["loops"].size() == 2);
        CHECK(report["loops"][0]["radius"].get<double>() == about(0.005).epsilon(0.01));
        CHECK(std::abs(report["loops"][0]["inward"][0].get<double>()) == about(1));
        CHECK(report["centreline"]["length_m"].get<double>() == about(0.1));
        CHECK(report["centreline"]["radius"]["p50"].get<double>() == about(0.005));
        CHECK(report["centreline"]["ends"].size() == 2);
        CHECK(report["inlets"].size() == 2);
    }

    TEST_CASE("property: what -o writes can be read back and is the same vessel")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}};
        run_ok(folder, "vessel t.toml -o V");
        const auto made = nlohmann::json::parse(run_app(folder, "vessel t.toml --json").out);
        for (const char* name : {"vessel.stl", "vessel.vtp"}) {
            CAPTURE(name);
            const AppResult again = run_app(folder, fmt::format("vessel V/{} --units mm --json", name));
            REQUIRE(again.code == 0);
            const auto report = nlohmann::json::parse(again.out);
            CHECK(report["triangles"] == made["triangles"]);
            CHECK(report["vertices"] == made["vertices"]);
            CHECK(report["loops"].size() == 2);
            CHECK(report["repairs"]["flipped"] == 0);
            // extracted, not exact: within a tenth of the radius
            CHECK(report["centreline"]["radius"]["max"].get<double>() == about(0.005).epsilon(0.1));
        }
        CHECK(fs::exists(folder.path / "V/centreline.vtp"));
    }

    TEST_CASE("property: a centreline's file is taken with its unit and axes, by vessel and init as by a scene's keys")
    {
        const ScratchFolder folder;
        std::string scene = tube_scene();
        folder.write("t.toml", scene);
        run_ok(folder, "vessel t.toml -o V");
        const std::string line = slurp(folder.path / "V/centreline.vtp");
        // without a unit of its own the line takes the mesh's, whatever that is said to be
        run_ok(folder, "vessel V/vessel.stl --units m -o M --centreline V/centreline.vtp");
        const AppResult same = run_ok(folder, "vessel V/vessel.stl --centreline V/centreline.vtp");
        CHECK(has(same.out, "centreline 0.1000 m long"));
        // the mesh in millimetres, the line in centimetres with x and y turned round
        run_ok(folder, "vessel V/vessel.stl --units cm -o C");
        run_ok(folder, "vessel C/vessel.stl --units cm --centreline V/centreline.vtp --centreline-units cm");
        const AppResult refused = check_refused(folder, "vessel V/vessel.stl --centreline V/centreline.vtp --centreline-units m",
                                                2, "Fix: --centreline-units \"mm\"");
        CHECK_FALSE(has(refused.err, "vessel.centreline"));
        for (const char* command : {"vessel", "init"}) {
            CAPTURE(command);
            check_refused(folder, fmt::format("{} V/vessel.stl --centreline-space RAS", command), 2,
                          "Fix: give --centreline FILE");
            const std::string wrong = " V/vessel.stl --centreline V/centreline.vtp --centreline-space XYZ";
            CHECK(run_app(folder, command + wrong).code == 2);
        }
        run_ok(folder,
               "init V/vessel.stl -o s.toml --centreline V/centreline.vtp --centreline-units mm "
               "--centreline-space LPS");
        const std::string text = slurp(folder.path / "s.toml");
        for (const char* key : {"centreline = \"V/centreline.vtp\"", "centreline_units = \"mm\"", "centreline_space = \"LPS\""})
            CHECK(has(text, key));
        run_ok(folder, "check s.toml");
        check_refused(folder, "vessel t.toml --centreline V/centreline.vtp", 2, "--centreline: a scene states its own");
    }

    TEST_CASE("property: inlet = auto enters through an opening, and the run goes into the tube")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.05)}};
        std::string scene = tube_scene(0.05);
        const std::size_t at = scene.find("point = "), end = scene.find("keys = ");
        scene.replace(at, end - at, "inlet = \"auto\"\n");
        folder.write("auto.toml", scene);
        CHECK(has(run_app(folder, "check auto.toml").out, "ok"));
        run_ok(folder, "run auto.toml -o D");
        const auto wire = csv_rows(folder.path / "D/wire.csv");
        const double base = std::stod(wire.back()[1]), tip = std::stod(wire[1][1]);
        CHECK((std::abs(base) < 1e-9 || std::abs(base - 0.1) < 1e-9));  // the tube runs from x = 0 to x = 0.1
        CHECK(tip > 0);
        CHECK(tip < 0.1);
    }

    TEST_CASE("property: a scene's vessel has its unit already; a scene without one has nothing to inspect")
    {
        const ScratchFolder folder{{"t.toml", tube_scene()}, {"s.toml", free_scene()}};
        CHECK(run_app(folder, "vessel t.toml --units mm").code == 2);
        CHECK(run_app(folder, "vessel s.toml").code == 2);
    }
}

}  // namespace seldinger::test::test_vessel_command
