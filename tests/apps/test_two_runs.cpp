// Two commands that write into one folder: the second is refused, the first has the results that it has alone.

#include "apps/background_app.h"

#include <memory>

namespace seldinger::test::test_two_runs {

namespace {

/// One line that names the folder and its owner, exit 3.
void is_refused(const AppResult& second, const std::string& place, pid_t by)
{
    CAPTURE(second.err);
    CHECK(second.code == 3);
    CHECK(second.error_lines() == 1);
    CHECK(has(second.err, place));
    CHECK(has(second.err, fmt::format("process {}", by)));
}

}  // namespace

TEST_SUITE("apps/two runs in one folder")
{
    TEST_CASE("property: a folder takes one run at a time, new, resumed or overwritten; who reads is free to")
    {
        const ScratchFolder folder{{"s.toml", free_scene(60.0, 1)}, {"short.toml", free_scene(0.05)}};
        BackgroundApp first(folder.path, {"run", "s.toml", "-o", "D", "--quiet"});
        REQUIRE(first.wait_for_rows(folder.path / "D/trace.csv", 5));
        for (const char* how : {"", " --resume", " --overwrite"}) {
            CAPTURE(how);
            is_refused(run_app(folder, std::string("run short.toml -o D --quiet") + how), "D", first.pid());
        }
        folder.write("v.toml", "[vary]\n\"scene.dt_s\" = [0.001, 0.002]\n");
        is_refused(run_app(folder, "batch short.toml --vary v.toml -o D --overwrite --quiet"), "D", first.pid());
        CHECK_FALSE(has(run_app(folder, "report D -o page.html").err, "another run"));
        first.send(SIGTERM);
        CHECK(first.result().code == 75);
        CHECK_FALSE(fs::exists(folder.path / "D/.lock"));
        CHECK(summary_of(folder.path / "D")["name"] == "falling");
        run_ok(folder, "run short.toml -o D --overwrite --quiet");
    }

    TEST_CASE("property: the lock lives through an overwriting run, and ends with a killed one")
    {
        const ScratchFolder folder{{"s.toml", free_scene(60.0, 1)}};
        REQUIRE(run_app(folder, "run s.toml -o D --time-limit 1e-6 --quiet").code == 75);
        {
            BackgroundApp first(folder.path, {"run", "s.toml", "-o", "D", "--quiet", "--overwrite"});
            REQUIRE(first.wait_for_rows(folder.path / "D/trace.csv", 5));
            is_refused(run_app(folder, "run s.toml -o D --overwrite --quiet"), "D", first.pid());
            first.send(SIGKILL);
            CHECK(first.result().code == -SIGKILL);
        }
        CHECK(run_app(folder, "run s.toml -o D --resume --time-limit 1e-6 --quiet").code == 75);
    }

    TEST_CASE("property: of runs that start together in a new folder one goes on")
    {
        const ScratchFolder folder{{"s.toml", free_scene(0.5, 1)}};
        run_ok(folder, "run s.toml -o whole --quiet");
        std::vector<std::unique_ptr<BackgroundApp>> all;
        for (int k = 0; k < 6; ++k) {
            const fs::path own = folder.path / fmt::format("from-{}", k);
            fs::create_directory(own);
            all.push_back(
                std::make_unique<BackgroundApp>(own, std::vector<std::string>{"run", "../s.toml", "-o", "../D", "--quiet"}));
        }
        int done = 0;
        for (auto& one : all) {
            const int code = one->result().code;
            CHECK((code == 0 || code == 3 || code == 2));  // 2: it came when the first had ended
            done += code == 0;
        }
        CHECK(done == 1);
        CHECK(summary_of(folder.path / "D")["state_hash"] == summary_of(folder.path / "whole")["state_hash"]);
    }

    TEST_CASE("property: a live session's record and a plan are locked as well")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(1.0)}};
        BackgroundApp first(folder.path, {"live", "t.toml", "--port", "0", "--udp", "0", "--record", "r.record", "--quiet"});
        REQUIRE(first.wait_until([&] { return fs::exists(folder.path / "r.record"); }));
        is_refused(run_app(folder, "live t.toml --port 0 --udp 0 --record r.record --duration 0.1 --quiet"), "r.record",
                   first.pid());
        first.send(SIGINT);
        CHECK(first.result().code == 130);
        CHECK_FALSE(fs::exists(folder.path / "r.record.lock"));
    }

    TEST_CASE("property: a run that is refused leaves no folder, and one leaves no half-written file of a killed one")
    {
        const ScratchFolder folder{{"s.toml", tube_scene(0.02)}};
        CHECK(run_app(folder, "run s.toml -o a/b/c --set vessel.shape=\"\" --set vessel.mesh=none.stl --set vessel.units=mm")
                  .code != 0);
        CHECK_FALSE(fs::exists(folder.path / "a"));
        fs::create_directory(folder.path / "D");
        folder.write("D/checkpoint.bin.999999999.tmp", "half");
        folder.write("D/wire_000010.vtp.999999998.tmp", "half");
        folder.write("D/mine.tmp", "of the user");
        folder.write(fmt::format("D/page.html.{}.tmp", getpid()), "being written by who lives");
        run_ok(folder, "run s.toml -o D --quiet");
        CHECK_FALSE(fs::exists(folder.path / "D/checkpoint.bin.999999999.tmp"));
        CHECK_FALSE(fs::exists(folder.path / "D/wire_000010.vtp.999999998.tmp"));
        CHECK(fs::exists(folder.path / "D/mine.tmp"));
        CHECK(fs::exists(folder.path / fmt::format("D/page.html.{}.tmp", getpid())));
    }
}

}  // namespace seldinger::test::test_two_runs
