// seldinger chart: a wrong command line, and Ctrl-C half-way.

#include "apps/app_fixture.h"

namespace seldinger::test::test_chart_command {

TEST_SUITE("apps/chart")
{
    TEST_CASE("property: an unknown scene is exit 2 in one line, a missing file exit 3")
    {
        const ScratchFolder folder;
        check_refused(folder, "chart --quick --scenes experiment3", 2, "the nearest is \"experiment1\"");
        CHECK(run_app(folder, "chart --scenes none.toml").code == 3);
        CHECK(run_app(folder, "chart --qick").code == 2);
        CHECK_FALSE(fs::exists(folder.path / "chart"));
    }

    TEST_CASE("property: Ctrl-C ends a chart with exit 130 and one line that says how to go on; what was done is kept")
    {
        const ScratchFolder folder;
        // hours of it: the signal comes long before the end, whatever the machine
        const AppResult cut = run_and_signal(folder.path, {"chart", "--scenes", "heavy-swing,elastica", "-o", "D"},
                                             folder.path / "D" / "runs.csv", 2, SIGINT);
        CHECK(cut.code == 130);
        CHECK(cut.error_lines() == 1);
        CHECK(has(cut.err, "the same command continues"));
        CHECK(cut.out.empty());
    }

    TEST_CASE("property: what was planned is charted beside the models, and is as far off as the plan said")
    {
        const ScratchFolder folder{{"t.toml", free_scene(0.1)}};
        const AppResult planned = run_ok(folder, "plan t.toml --tolerance 1mm --budget 1e5 --json -o p.toml");
        const auto plan = nlohmann::json::parse(planned.out);
        // processor time: what else the machine does takes none of it. A run of this scene takes milliseconds
        run_ok(folder,
               "chart --quick --scenes t.toml --planned p.toml --processor-time --run-limit 0.2 "
               "--reference-limit 1 -o D --quiet");
        const auto rows = csv_rows(folder.path / "D" / "chart.csv");
        const auto column = [&](const char* name) { return std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin(); };
        REQUIRE(rows.size() > 10);
        CHECK(rows[1][column("family")] == "planned");  // first: an interrupted chart has it
        const auto& nodes = plan["chosen"]["nodes"];  // or "adaptive", where that is cheaper
        CHECK(has(rows[1][column("settings")], nodes.is_number() ? "wire.nodes=" + nodes.dump() : "adaptive"));
        // two references stand between the two: the one of the plan, and the one of the chart
        double of_chart = 0;
        for (const auto& row : csv_rows(folder.path / "D" / "references.csv"))
            if (row[1] == "shape") of_chart = std::stod(row[6]);
        const double of_plan = plan["reference"]["uncertainty_m"].get<double>();
        CHECK(std::abs(std::stod(rows[1][column("shape_rms_m")]) - plan["chosen"]["error_m"].get<double>()) <=
              of_plan + 2 * of_chart);
        if (std::system("/usr/bin/python3 -c 'import matplotlib' 2> /dev/null") == 0)
            CHECK(std::filesystem::exists(folder.path / "D" / "chart.png"));
        // only for the scene that it was planned for
        folder.write("other.toml", free_scene(0.2));
        check_refused(folder, "chart --scenes other.toml --planned p.toml", 2, "is not");
        CHECK(run_app(folder, "chart --planned p.toml").code == 2);
    }
}

}  // namespace seldinger::test::test_chart_command
