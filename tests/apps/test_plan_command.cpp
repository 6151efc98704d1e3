// seldinger plan: its files, its refusals, and Ctrl-C half-way.

#include "apps/app_fixture.h"

#include "scene/scene.h"

#include <algorithm>

namespace seldinger::test::test_plan_command {

namespace {

/// A short tube scene whose wire is on the wall within its two samples.
std::string touching_scene() { return tube_scene(0.07); }

/// The same with an elastic wall.
std::string soft_scene(double youngs, double support)
{
    std::string text = touching_scene();
    const std::string rigid = "youngs_pa = 1e6\n";
    return text.replace(text.find(rigid), rigid.size(),
                        fmt::format("wall = \"elastic\"\nyoungs_pa = {:e}\nsupport_pa_m = {:e}\nthickness_m = 5e-4\n"
                                    "wall_edge_m = 0.002\n",
                                    youngs, support));
}

nlohmann::json plan_of(const AppResult& result)
{
    CAPTURE(result.err);
    REQUIRE(!result.out.empty());
    return nlohmann::json::parse(result.out);
}

/// A line of stderr that says `what`.
void one_line(const AppResult& result, int code, const std::string& what)
{
    CAPTURE(result.err);
    CHECK(result.code == code);
    CHECK(result.error_lines() == 1);
    CHECK(has(result.err, what));
}

/// A budget that never ends, so that the search does not depend on the machine's speed.
AppResult run_plan(const ScratchFolder& folder, const std::string& arguments)
{
    return run_app(folder, "plan " + arguments + " --budget 1e5");
}

}  // namespace

TEST_SUITE("apps/plan")
{
    TEST_CASE("property: a plan is exit 0, its scene runs, and what is promised of it is within the tolerance")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 1mm --json");
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result);
        CHECK(plan["status"] == "planned");
        CHECK(plan["chosen"]["error_high_m"].get<double>() <= 1e-3);
        CHECK(plan["chosen"]["error_low_m"].get<double>() < plan["chosen"]["error_m"].get<double>());
        CHECK(plan["reference"]["uncertainty_m"].get<double>() <= 0.5e-3);
        CHECK(plan["left_out"].size() >= 2);
        run_ok(folder, "run planned.toml -o out");
        // the chosen model and its goal; nodes are a number or "adaptive", by which is cheaper here
        CHECK(has(slurp(folder.path / "planned.toml"), "nodes = " + plan["chosen"]["nodes"].dump() + "\n"));
        CHECK(has(slurp(folder.path / "out" / "summary.json"), "by seldinger plan for shape within 1 mm rms"));
    }

    TEST_CASE("property: with --enough the first model that is quick enough is taken: as good as promised, in fewer trials")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        const auto whole = plan_of(run_plan(folder, "t.toml --tolerance 1mm --rate 1000 -o whole.toml --json"));
        const AppResult result = run_plan(folder, "t.toml --tolerance 1mm --rate 1000 --enough 1 --json");
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result);
        CHECK(plan["status"] == "planned");
        CHECK(plan["chosen"]["error_high_m"].get<double>() <= 1e-3);
        CHECK(plan["reference"]["uncertainty_m"].get<double>() <= 0.5e-3);
        CHECK(plan["left_out"].empty());
        CHECK(seldinger::read_scene(folder.path / "planned.toml").dt <= 1e-3 * (1 + 1e-9));
        CHECK(plan["pilots"].get<int>() < whole["pilots"].get<int>() / 2);
        // the kept runs serve: the same model at once
        const AppResult again = run_plan(folder, "t.toml --tolerance 1mm --rate 1000 --enough 1 --json");
        CHECK(plan_of(again)["chosen"]["error_m"] == plan["chosen"]["error_m"]);
        one_line(run_plan(folder, "t.toml --tolerance 1mm --enough 0.5"), 2, "--rate");
    }

    TEST_CASE(
        "property: peaks that are asked for are within, their uncertainty included, and are told; what is not known is refused")
    {
        const ScratchFolder folder{{"t.toml", touching_scene()}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 2mm --peak-force-tolerance 20% --json");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result);
        for (const char* peak : {"hand_force_n", "friction_n"}) {
            CAPTURE(peak);
            const double right = plan["reference"]["peaks"][peak].get<double>();
            CHECK(plan["chosen"]["peak_error"][peak].get<double>() + plan["reference"]["peak_uncertainty"][peak].get<double>() <=
                  0.2 * std::max(right, 1e-3));
        }
        CHECK(plan["reference"]["peaks"]["force_per_length_n_per_m"].get<double>() > 0);
        CHECK(has(slurp(folder.path / "planned.toml"), "peaks of force within 20 %"));
        one_line(run_plan(folder, "t.toml --tolerance 2mm --peak-force-tolerance 5"), 2, "has no unit");
    }

    // what a plan costs is measured, so which of two models is cheaper is not for this test (tests/plan/test_plan_search.cpp)
    TEST_CASE("property: whatever the tolerance, what is planned meets it, and the reference is known to half of it")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        for (const double tolerance : {10e-3, 1e-3, 0.3e-3}) {
            CAPTURE(tolerance);
            const AppResult result = run_plan(folder, fmt::format("t.toml --json --tolerance {}mm", 1e3 * tolerance));
            REQUIRE(result.code == 0);
            const auto plan = plan_of(result);
            CHECK(plan["chosen"]["error_high_m"].get<double>() <= tolerance);
            CHECK(plan["reference"]["uncertainty_m"].get<double>() <= tolerance / 2);
        }
    }

    TEST_CASE("property: the scene of a plan in another folder finds its mesh, and runs")
    {
        const ScratchFolder folder{{"t.toml", touching_scene()}};
        run_ok(folder, "vessel t.toml -o mesh");
        std::string text = touching_scene();
        const auto from = text.find("shape = \"tube\""), to = text.find("[contact]");
        text.replace(from, to - from, "mesh = \"mesh/vessel.stl\"\nunits = \"mm\"\n");
        folder.write("m.toml", text);
        const AppResult result = run_plan(folder, "m.toml --tolerance 2mm --json -o deep/er/p.toml");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        CHECK(plan_of(result)["touches"] == true);
        CHECK(seldinger::read_scene(folder.path / "deep/er/p.toml").vessel.mesh.lexically_normal() ==
              seldinger::read_scene(folder.path / "m.toml").vessel.mesh.lexically_normal());
        CHECK(has(slurp(folder.path / "deep/er/p.toml"), "../../mesh/vessel.stl"));
        run_ok(folder, "run deep/er/p.toml -o out");
    }

    TEST_CASE("property: where an elastic wall hardly moves it is planned rigid, with the reason, and that scene runs")
    {
        const ScratchFolder folder{{"t.toml", soft_scene(1e6, 1e6)}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 0.5mm --json");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result), wall = plan["wall"];
        CHECK(wall["chosen"] == "rigid");
        CHECK(plan["chosen"]["wall"] == "rigid");
        CHECK(wall["move_m"].get<double>() > 0);
        CHECK(wall["move_m"].get<double>() < 0.5e-3);
        CHECK(wall["reason"].get<std::string>().find("rigid: the wall would move") == 0);
        CHECK(has(wall["reason"].get<std::string>(), "below the tolerance; an elastic one is"));
        CHECK(wall["other_known"] == true);
        CHECK(has(plan["left_out"].dump(), "the elastic wall"));
        CHECK_FALSE(seldinger::read_scene(folder.path / "planned.toml").vessel.elastic);
        run_ok(folder, "run planned.toml -o out");
    }

    TEST_CASE("property: where it is too soft for that it is planned elastic, and what a rigid one is wrong by is said")
    {
        const ScratchFolder folder{{"t.toml", soft_scene(1e5, 1e5)}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 0.1mm --json");
        CAPTURE(result.err);
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result), wall = plan["wall"];
        CHECK(wall["chosen"] == "elastic");
        CHECK(plan["chosen"]["error_high_m"].get<double>() <= 0.1e-3);
        const auto reason = wall["reason"].get<std::string>();
        CHECK(reason.find("elastic, edge ") == 0);
        // which nodes and steps are chosen is a matter of timing, and at some of them a rigid wall ends the run
        if (wall["other_known"] == true) {
            CHECK(wall["other_error_m"].get<double>() > 0.1e-3);  // run to its end, however wrong
            CHECK(has(reason, "a rigid wall changes the tip by"));
        } else {
            CHECK(has(reason, "with a rigid wall the run does not finish"));
        }
        const auto& left_out = plan["left_out"];
        const auto rigid =
            std::find_if(left_out.begin(), left_out.end(), [](const auto& o) { return o["what"] == "a rigid wall instead"; });
        REQUIRE(rigid != left_out.end());
        CHECK((*rigid)["holds"] == wall["other_known"]);
        CHECK(seldinger::read_scene(folder.path / "planned.toml").vessel.elastic);
        run_ok(folder, "run planned.toml -o out");
        CHECK(summary_of(folder.path / "out")["wall_vertices"].get<int>() > 0);
    }

    TEST_CASE(
        "property: a tolerance below what the reference is known to is exit 6, says to what it is known, and leaves the "
        "reference as a scene")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}, {"planned.toml", "what an earlier plan left"}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 0.01um --json");
        one_line(result, 6, "the reference is known to");
        CHECK(has(result.err, "ask for"));
        CHECK(plan_of(result)["status"] == "below-reference");
        CHECK_FALSE(fs::exists(folder.path / "planned.toml"));
        run_ok(folder, "check planned.accurate.toml");
    }

    TEST_CASE("property: a rate that no model reaches is exit 6 with the nearest on each side beside it, and both run")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        const AppResult result = run_plan(folder, "t.toml --tolerance 1mm --rate 1e8 --json");
        one_line(result, 6, "no model reaches 1e+08 steps a second here");
        const auto plan = plan_of(result);
        CHECK(plan["status"] == "not-both");
        CHECK(plan["accurate"]["error_high_m"].get<double>() <= 1e-3);
        CHECK(plan["fast"]["steps_per_second"].get<double>() < 1e8);
        CHECK_FALSE(fs::exists(folder.path / "planned.toml"));
        for (const char* side : {"accurate", "fast"}) run_ok(folder, fmt::format("run planned.{}.toml -o {}", side, side));
    }

    TEST_CASE("property: a scene that never touches its wall is planned, and that this says nothing of contact is noted")
    {
        const ScratchFolder folder;
        std::string text = touching_scene();
        text.replace(text.find("[scene]"), 7, "[scene]\ngravity = [0.0, 0.0, 0.0]");
        text.replace(text.find("[0.0, 0.0, -0.0035]"), 19, "[0.0, 0.0, 0.0]");
        text.replace(text.find("[1.0, 0.0, -0.2]"), 16, "[1.0, 0.0, 0.0]");
        folder.write("t.toml", text);
        const AppResult result = run_plan(folder, "t.toml --tolerance 1mm --json");
        REQUIRE(result.code == 0);
        const auto plan = plan_of(result);
        CHECK(plan["touches"] == false);
        CHECK(has(plan["notes"].dump(), "never touches the wall"));
        CHECK(plan["chosen"]["detection"] == "swept");  // what cannot be told is not left out
    }

    TEST_CASE("property: a scene that breaks off in every model is exit 4, in one line that names the first and the last")
    {
        const ScratchFolder folder;
        std::string text = free_scene(0.1);
        text.replace(text.find("position = true"), 15, "position = true\nvelocity_m_s = [0.0, 0.0, 1e160]");
        folder.write("t.toml", text);
        const AppResult result = run_plan(folder, "t.toml --tolerance 1mm");
        one_line(result, 4, "no model completes this scene: 17 nodes");
        CHECK(has(result.err, "blow-up"));
        CHECK(has(result.err, "411 nodes"));
        CHECK_FALSE(fs::exists(folder.path / "planned.toml"));
    }

    TEST_CASE("property: goals that are no goals are exit 2 before anything is run")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        for (const char* goals :
             {"", "--tolerance 0.2", "--tolerance -1mm", "--tolerance 1mm --rate 0", "--tolerance 1mm --force-tolerance half",
              "--tolerance 1mm -o t.toml", "--tolerance 1mm --budget 0"}) {
            CAPTURE(goals);
            const AppResult result = run_app(folder, std::string("plan t.toml ") + goals);
            CHECK(result.code == 2);
            CHECK(result.error_lines() == 1);
        }
        CHECK(run_app(folder, "plan none.toml --tolerance 1mm").code == 3);
        CHECK_FALSE(fs::exists(folder.path / "planned.pilots"));
    }

    TEST_CASE(
        "property: Ctrl-C ends a plan with exit 130; the same command goes on with the trials that are there and comes to an end")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.5)}};
        const fs::path table = folder.path / "p.pilots" / "runs.csv";
        const std::vector<std::string> arguments = {"plan", "t.toml", "--tolerance", "0.5mm", "-o", "p.toml", "--quiet"};
        const AppResult cut = run_and_signal(folder.path, arguments, table, 2, SIGINT);
        CAPTURE(cut.err);
        REQUIRE(cut.code == 130);
        CHECK(cut.error_lines() == 1);
        CHECK_FALSE(fs::exists(folder.path / "p.toml"));
        const std::string before = slurp(table);
        const AppResult again = run_plan(folder, "t.toml --tolerance 0.5mm -o p.toml");
        CAPTURE(again.err);
        REQUIRE(again.code == 0);
        const std::string after = slurp(table);
        CHECK(after.size() > before.size());
        CHECK(after.substr(0, before.size()) == before);  // none of it was run again
        run_ok(folder, "check p.toml");
    }
}

}  // namespace seldinger::test::test_plan_command
