// A run that was stopped, by whatever, and resumed ends with the same bits as one that was left alone.

#include "apps/app_fixture.h"

namespace seldinger::test::test_resume {

namespace {

void same_run(const fs::path& a, const fs::path& b)
{
    CHECK(summary_of(a)["state_hash"] == summary_of(b)["state_hash"]);
    CHECK(summary_of(a)["status"] == "done");
    CHECK(timeless_trace(a) == timeless_trace(b));
    for (const char* file : {"wire.csv", "contacts.csv", "wire.pvd", "wire.npz", "contacts.pvd", "scene.toml"}) {
        CAPTURE(file);
        CHECK(slurp(a / file) == slurp(b / file));
    }
    for (const char* key :
         {"steps", "contacts_max", "friction_max_n", "overlap_max_m", "newton_max", "energy_j", "hand_force_n"}) {
        CAPTURE(key);
        CHECK(summary_of(a)[key] == summary_of(b)[key]);
    }
}

}  // namespace

TEST_SUITE("apps/resume")
{
    TEST_CASE("property: SIGINT is exit 130, SIGTERM 75, SIGKILL whatever it is: resumed, all end with the same bits")
    {
        const ScratchFolder folder;
        const fs::path scene = folder.write("t.toml", tube_scene(4.0));
        run_ok(folder, "run t.toml -o whole");

        const fs::path stopped = folder.path / "stopped";
        REQUIRE(run_and_signal(scene, stopped, 60, SIGINT) == 130);
        CHECK(summary_of(stopped)["status"] == "interrupted");
        const long at = summary_of(stopped)["steps"].get<long>();
        CHECK(at >= 300);
        CHECK(at < 4000);
        REQUIRE(run_and_signal(scene, stopped, at / 5 + 30, SIGTERM, true) == 75);
        CHECK(summary_of(stopped)["status"] == "time-limit");
        const AppResult end = run_ok(folder, "run t.toml -o stopped --resume");
        CHECK(summary_of(stopped)["resumes"] == 2);
        CHECK_MESSAGE(end.out.find("on, where the run was resumed") != std::string::npos,
                      end.out);  // which steps the bands are of
        same_run(stopped, folder.path / "whole");

        const fs::path killed = folder.path / "killed";
        REQUIRE(run_and_signal(scene, killed, 100, SIGKILL) == -SIGKILL);
        CHECK_FALSE(fs::exists(killed / "summary.json"));
        // DIR's own scene will do
        run_ok(folder, "run -o killed --resume");
        const AppResult nothing = run_app(folder, "run -o killed");
        CHECK(nothing.code == 2);
        CHECK_MESSAGE(nothing.err.find("SCENE is required") != std::string::npos, nothing.err);
        same_run(killed, folder.path / "whole");

        // a run that is done is not run again
        const std::string summary = slurp(killed / "summary.json");
        const AppResult again = run_ok(folder, "run t.toml -o killed --resume --json");
        CHECK(again.out == summary);
    }

    TEST_CASE("property: with a short --time-limit and --resume in turn, a run comes to its end")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.05, 7)}};
        run_ok(folder, "run s.toml -o whole");
        // a limit that is over at once lets one step through; nine of them end between two rows of the trace
        constexpr int stops = 9;
        for (int k = 1; k <= stops; ++k) {
            const AppResult part = run_app(folder, "run s.toml -o parts --time-limit 1e-6 --resume --quiet");
            REQUIRE(part.code == 75);
            REQUIRE(part.error_lines() == 1);
            REQUIRE(has(part.err, "--resume"));
            CHECK(summary_of(folder.path / "parts")["steps"] == k);
        }
        run_ok(folder, "run s.toml -o parts --resume --quiet");
        CHECK(summary_of(folder.path / "parts")["resumes"] == stops);
        CHECK(summary_of(folder.path / "parts")["state_hash"] == summary_of(folder.path / "whole")["state_hash"]);
        CHECK(timeless_trace(folder.path / "parts") == timeless_trace(folder.path / "whole"));
        CHECK(slurp(folder.path / "parts/wire.pvd") == slurp(folder.path / "whole/wire.pvd"));
    }

    TEST_CASE("property: a settled start is settled once")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.05)}};
        const std::string set = " --set scene.start=settled ";
        run_ok(folder, "run s.toml -o whole" + set);
        REQUIRE(run_app(folder, "run s.toml -o parts --time-limit 1e-6 --quiet" + set).code == 75);
        run_ok(folder, "run s.toml -o parts --resume --quiet" + set);
        REQUIRE(summary_of(folder.path / "parts")["resumes"] == 1);
        CHECK(summary_of(folder.path / "parts")["state_hash"] == summary_of(folder.path / "whole")["state_hash"]);
        CHECK(timeless_trace(folder.path / "parts") == timeless_trace(folder.path / "whole"));
    }

    TEST_CASE("property: a damaged checkpoint, a shortened trace and a changed vessel are told, not resumed")
    {
        const ScratchFolder folder{{"s.toml", free_scene(30.0, 1)}};
        REQUIRE(run_app(folder, "run s.toml -o D --time-limit 1e-6").code == 75);
        const std::string checkpoint = slurp(folder.path / "D/checkpoint.bin");
        const auto refuses = [&](const std::string& names) { check_refused(folder, "run s.toml -o D --resume", 3, names); };
        std::string damaged = checkpoint;
        damaged[damaged.size() / 2] ^= 1;
        folder.write("D/checkpoint.bin", damaged);
        refuses("checkpoint.bin");
        folder.write("D/checkpoint.bin", checkpoint.substr(0, checkpoint.size() / 2));
        refuses("checkpoint.bin");
        folder.write("D/checkpoint.bin", checkpoint);
        const std::string trace = slurp(folder.path / "D/trace.csv");
        folder.write("D/trace.csv", trace.substr(0, trace.size() / 2));
        refuses("trace.csv");
        folder.write("D/trace.csv", trace);
        run_ok(folder, "run s.toml -o D --resume");
    }
}

}  // namespace seldinger::test::test_resume
