// [task] in runs, batches and farms: one reading of the target, the same alone, in a batch, after stops and in a farm.

#include "apps/app_fixture.h"
#include "support/approx.h"

#include <cmath>
#include <map>

namespace seldinger::test::test_task {

namespace {

// the tip slides along the floor of the tube: 30 mm from the inlet it is at the target, which the slower one does not reach in
// time
const std::string task = "[task]\ntarget = { name = \"the middle\", point = [0.03, 0.0, -0.005], radius_m = 0.002 }\n";
const std::string sweep = "[vary]\n\"scene.duration_s\" = [0.35, 0.2]\n\"wire.bend_nm2\" = [1e-5, 4e-5]\n";

/// Goes on with what `command` began, each time a little longer, whatever the machine has to do beside. @return calls that it
/// took
int taken_up_again(const ScratchFolder& folder, const std::string& command)
{
    AppResult part = run_app(folder, command + " --time-limit 1e-6");
    double limit = 0.05;
    int calls = 1;
    for (; part.code == 75 && calls < 60; ++calls, limit *= 1.3)
        part = run_app(folder, fmt::format("{} --resume --time-limit {}", command, limit));
    CAPTURE(part.err);
    CHECK(part.code == 0);
    return calls;
}

}  // namespace

TEST_SUITE("apps/task")
{
    TEST_CASE("property: a run says when the target was reached and what was the most until then, as its trace has it")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.5) + task}};
        const AppResult result = run_ok(folder, "run t.toml -o R --set scene.record_every=1");
        const auto summary = summary_of(folder.path / "R");
        CHECK(summary["branch"] == 1);
        CHECK(summary["branches"] == 1);
        const auto& said = summary["task"];
        REQUIRE(said["reached"] == true);
        CHECK(said["target"] == "the middle");
        CHECK(said["verdict"] == "passed");
        // by hand: rows until the tip is within 2 mm of the point
        double patch = 0, hand = 0, at_s = -1, at_m = 0;
        for (const Row& row : table_rows(folder.path / "R/trace.csv")) {
            patch = std::max(patch, std::stod(row.at("patch_force_max_n")));
            hand = std::max(hand, std::abs(std::stod(row.at("hand_force_n"))));
            const double off = std::hypot(std::stod(row.at("tip_x_m")) - 0.03, std::stod(row.at("tip_y_m")),
                                          std::stod(row.at("tip_z_m")) + 0.005);
            if (off > 0.002) continue;
            at_s = std::stod(row.at("time_s")), at_m = std::stod(row.at("inserted_m"));
            break;
        }
        REQUIRE(at_s > 0.1);
        CHECK(patch > 0);
        CHECK(said["reached_at_s"] == at_s);
        CHECK(said["reached_at_m"] == at_m);
        CHECK(said["until_patch_force_max_n"] == patch);
        CHECK(said["until_hand_force_max_n"] == hand);
        CHECK(summary["simulated_s"].get<double>() > at_s + 0.05);
        CHECK(result.out.ends_with(
            fmt::format("reached the middle at {:.4g} mm, {:.4g} s; until then at most {} on 5 mm of wall\n", 1e3 * at_m, at_s,
                        patch < 0.02 ? fmt::format("{:.3g} mN", 1e3 * patch) : fmt::format("{:.3g} N", patch))));

        // the same run, ended there
        run_ok(folder, "run t.toml -o E --quiet --set scene.until=reached");
        CHECK(summary_of(folder.path / "E")["simulated_s"] == at_s);
        CHECK(summary_of(folder.path / "E")["task"]["until_patch_force_max_n"] == patch);
        CHECK(summary_of(folder.path / "E")["status"] == "done");
    }

    TEST_CASE("property: a run without a task has the bits of one with it, and says in which branch its tip ended")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.2)}, {"task.toml", tube_scene(0.2) + task}};
        const AppResult plain = run_ok(folder, "run t.toml -o P");
        run_ok(folder, "run task.toml -o T --quiet");
        CHECK(summary_of(folder.path / "P")["state_hash"] == summary_of(folder.path / "T")["state_hash"]);
        CHECK_FALSE(summary_of(folder.path / "P").contains("task"));
        CHECK(summary_of(folder.path / "P")["branch"] == 1);
        CHECK(has(plain.out, "tip in branch 1 of 1"));
    }

    TEST_CASE(
        "property: a batch's rows, bands and answer are those of the runs alone; stops and farms leave the bytes as they are")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.3) + task}, {"v.toml", sweep}};
        const AppResult batch = run_ok(folder, "batch t.toml --vary v.toml -o B --bands");
        const auto rows = table_rows(folder.path / "B/results.csv");
        REQUIRE(rows.size() == 4);
        std::vector<double> peaks;
        for (const Row& row : rows) {
            const std::string set = fmt::format("--set scene.duration_s={} --set wire.bend_nm2={} ", row.at("scene.duration_s"),
                                                row.at("wire.bend_nm2"));
            CAPTURE(set);
            run_ok(folder, "run t.toml -o R --overwrite --quiet " + set);
            run_ok(folder, "run t.toml -o H --overwrite --quiet --set scene.dt_s=0.0005 --set scene.record_every=10 " + set);
            const auto alone = summary_of(folder.path / "R"), half = summary_of(folder.path / "H");
            CHECK(row.at("state_hash") == alone["state_hash"]);
            CHECK((row.at("reached") == "1") == alone["task"]["reached"].get<bool>());
            CHECK(std::stoi(row.at("branch")) == alone["branch"]);
            CHECK(std::stod(row.at("hand_force_max_n")) == alone["hand_force_max_n"]);
            CHECK(std::stod(row.at("until_patch_force_max_n")) == alone["task"]["until_patch_force_max_n"]);
            CHECK(std::stod(row.at("hand_force_n_band")) ==
                  about(3 * std::abs(alone["hand_force_n"].get<double>() - half["hand_force_n"].get<double>())).epsilon(1e-12));
            if (row.at("reached") == "1") {
                CHECK(std::stod(row.at("reached_at_m")) == alone["task"]["reached_at_m"]);
                peaks.push_back(std::stod(row.at("until_patch_force_max_n")));
            } else CHECK(row.at("reached_at_m").empty());
        }
        REQUIRE(peaks.size() == 2);
        const auto summary = summary_of(folder.path / "B");
        CHECK(summary["runs"] == 4);
        CHECK(summary["done"] == 4);
        CHECK(summary["task"]["ranking"][0]["until_patch_force_max_n"] == *std::min_element(peaks.begin(), peaks.end()));
        const std::string answer = summary["answer"];
        CHECK(answer.starts_with(
            "2 of 4 reached the middle, the others ended in branch 1 (2 runs); least peak on 5 mm of wall: run "));
        CHECK(answer.find(" (scene.duration_s=") != std::string::npos);
        CHECK(has(answer, " ± "));
        CHECK(batch.out.ends_with(answer + "\n"));

        const auto shapes = table_rows(folder.path / "B/shapes.csv");
        REQUIRE(shapes.size() == 4 * 64);
        for (std::size_t k = 0; k < 4; ++k)  // the first station is the tip
            for (const char* c : {"x", "y", "z"})
                CHECK(std::stod(shapes[64 * k].at(fmt::format("{}_m", c))) ==
                      about(std::stod(rows[k].at(fmt::format("tip_{}_m", c)))).epsilon(1e-6));

        const std::string csv = slurp(folder.path / "B/results.csv"), npz = slurp(folder.path / "B/results.npz"),
                          units = slurp(folder.path / "B/results-units.csv");
        CHECK(taken_up_again(folder, "batch t.toml --vary v.toml -o P --quiet --bands") > 2);
        CHECK(slurp(folder.path / "P/results.csv") == csv);
        CHECK(slurp(folder.path / "P/shapes.csv") == slurp(folder.path / "B/shapes.csv"));
        for (const int tasks : {1, 3, 8}) {  // eight: the runs and those with half the step apart
            CAPTURE(tasks);
            const std::string dir = fmt::format("F{}", tasks);
            run_ok(folder, fmt::format("farm t.toml --vary v.toml -o {} --tasks {} --bands", dir, tasks));
            const AppResult merged = run_ok(folder, "farm merge " + dir);
            CHECK(slurp(folder.path / dir / "results.csv") == csv);
            CHECK(slurp(folder.path / dir / "results.npz") == npz);
            CHECK(slurp(folder.path / dir / "results-units.csv") == units);
            CHECK(slurp(folder.path / dir / "shapes.csv") == slurp(folder.path / "B/shapes.csv"));
            CHECK(merged.out.ends_with(answer + "\n"));
        }
    }

    TEST_CASE("property: a run taken up again in mid-task has the task of one in one piece")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.5) + task}};
        run_ok(folder, "run t.toml -o one --quiet");
        CHECK(taken_up_again(folder, "run t.toml -o parts --quiet") > 2);
        CHECK(summary_of(folder.path / "parts")["task"] == summary_of(folder.path / "one")["task"]);
    }

    TEST_CASE("property: the questions of docs/answers.md are scenes that can be asked as they stand")
    {
        const ScratchFolder folder;
        const fs::path examples = fs::path(SEL_SOURCE_DIR) / "examples/answers";
        for (const std::string name : {"which-wire", "which-angle", "catheter-or-none"}) {
            CAPTURE(name);
            // half a second of each run: every value of the sweep makes a world that steps
            const AppResult asked = run_app(
                folder,
                fmt::format("batch '{}.toml' --vary '{}-sweep.toml' -o {} --set scene.duration_s=0.5 --set scene.until=time",
                            (examples / name).string(), (examples / name).string(), name));
            CAPTURE(asked.err);
            CHECK(asked.code == 0);
            CHECK(has(asked.out, "reached left subclavian"));
            CHECK(summary_of(folder.path / name)["task"]["reached"] == 0);
        }
    }

    TEST_CASE(
        "property: a branch is reached in the first step whose tip is in it, so far behind its mouth; a force that still rises "
        "is said to")
    {
        const ScratchFolder folder;
        const std::string target = "[task]\ntarget = { branch = 1, beyond_m = 0.03 }\n";  // a tube's branch is all of it
        folder.write("t.toml", tube_scene(0.5) + target);
        const AppResult result = run_ok(folder, "run t.toml -o R --set scene.record_every=1 --set scene.until=reached");
        const auto summary = summary_of(folder.path / "R");
        const double step = 0.001,
                     speed = 0.08;  // of the hub [m/s]; the tip goes as fast but for the slack that the tube takes up
        CHECK(summary["branch"] == 1);
        CHECK(summary["branch_depth_m"].get<double>() >= 0.03);
        CHECK(summary["branch_depth_m"].get<double>() < 0.03 + 3 * speed * step);
        CHECK(summary["task"]["distance_m"] == 0);
        double patch = 0, at_s = 0;
        for (const Row& row : table_rows(folder.path / "R/trace.csv"))
            if (std::stod(row.at("patch_force_max_n")) > patch)
                patch = std::stod(row.at("patch_force_max_n")), at_s = std::stod(row.at("time_s"));
        CHECK(summary["task"]["until_patch_force_max_s"] == at_s);
        const bool rising = at_s > summary["task"]["reached_at_s"].get<double>() - 0.02;
        CHECK((result.out.find(", still rising") != std::string::npos) == rising);
    }

    TEST_CASE("property: until = reached without a target, and a branch that there is not, are refused with what to do")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.1)}};
        check_refused(folder, "run t.toml -o R --set scene.until=reached", 2, "[task] target");
        folder.write("b.toml", tube_scene(0.1) + "[task]\ntarget = { branch = 2 }\n");
        for (const std::string command : {"run b.toml -o R", "batch b.toml --vary v.toml -o B"}) {
            folder.write("v.toml", "[vary]\n\"wire.bend_nm2\" = [1e-5]\n");
            check_refused(folder, command, 2, "got 2; expected 1 to 1");
        }
    }
}

}  // namespace seldinger::test::test_task
