// What the system does not give: streams that are closed or full, threads, places to write.

#include "apps/app_fixture.h"

namespace seldinger::test::test_surroundings {

namespace {

/// Exit code, or minus the signal, of `seldinger arguments` with these redirections, in `folder`.
int code_of(const ScratchFolder& folder, const std::string& arguments, const std::string& redirections)
{
    const int status =
        std::system(fmt::format("cd '{}' && exec '{}' {} {}", folder.path.string(), app_path(), arguments, redirections).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

}  // namespace

TEST_SUITE("apps/surroundings")
{
    TEST_CASE("regression: where stderr takes nothing, an error is its exit code and a note is lost")
    {
        const ScratchFolder folder;
        // a coefficient of friction that is raised is a note
        folder.write("s.toml", free_scene() + "[contact]\nmu_sliding = 0.3\n");
        for (const char* nowhere : {"2>/dev/full", "2>&-"}) {
            if (nowhere[2] == '/' && !fs::exists("/dev/full")) continue;
            CAPTURE(nowhere);
            CHECK(code_of(folder, "check none.toml", nowhere) == 3);
            CHECK(code_of(folder, "check s.toml --set wire.nodes=1", nowhere) == 2);
            CHECK(code_of(folder, "run s.toml -o D --overwrite", nowhere) == 0);
        }
    }

    TEST_CASE("regression: no file of a run is opened in the place of a closed stream")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        REQUIRE(code_of(folder, "run s.toml -o A --quiet", "") == 0);
        CHECK(code_of(folder, "run s.toml -o B --json", "<&- >&- 2>&-") == 3);  // its result had no stdout
        for (const char* file : {"wire.csv", "scene.toml", "contacts.csv", "wire.pvd"})
            CHECK(slurp(folder.path / "A" / file) == slurp(folder.path / "B" / file));
        CHECK(csv_rows(folder.path / "B/trace.csv").size() ==
              csv_rows(folder.path / "A/trace.csv").size());  // the steps' times differ
        CHECK(summary_of(folder.path / "B")["state_hash"] == summary_of(folder.path / "A")["state_hash"]);
    }

    TEST_CASE("property: a folder that is gone, or a place for temporary files that is none, is no reason to crash")
    {
        const ScratchFolder folder{{"s.toml", free_scene()}};
        run_ok(folder, "run s.toml -o T --quiet", "TMPDIR=/nowhere");
        const std::string scene = (folder.path / "s.toml").string();
        const auto from_nowhere = [&](const std::string& arguments) {
            const std::string words =
                fmt::format("mkdir '{0}/gone' && cd '{0}/gone' && rmdir '{0}/gone' && '{1}' {2} >'{0}/out' 2>'{0}/err'",
                            folder.path.string(), app_path(), arguments);
            const int status = std::system(words.c_str());
            const std::string said = slurp(folder.path / "err");
            CAPTURE(said);
            CHECK(std::count(said.begin(), said.end(), '\n') <= 1);
            return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
        };
        CHECK(from_nowhere("check '" + scene + "'") == 0);
        CHECK(from_nowhere("check s.toml") == 3);
        CHECK(from_nowhere("run '" + scene + "'") == 3);
        CHECK(from_nowhere("run '" + scene + "' -o '" + (folder.path / "C").string() + "' --quiet") == 0);
    }

    TEST_CASE("regression: a run folder whose names lead round in a circle, to devices or out of it is refused in one line")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        run_ok(folder, "run t.toml -o R --quiet --set output.wire_every=10 --set output.contacts_every=10");
        // a program under ./dev sanitize reserves addresses without memory behind them
        const std::string bounds = std::getenv("ASAN_OPTIONS") ? "timeout 60" : "ulimit -v 4000000 && timeout 60";
        const auto refused = [&](const std::string& command, const std::string& says) {
            check_refused(folder, command, 3, says, bounds);
        };
        const auto linked = [&](const std::string& name, const char* target) {
            fs::remove_all(folder.path / "Q");
            fs::copy(folder.path / "R", folder.path / "Q", fs::copy_options::recursive);
            fs::remove(folder.path / "Q" / name);
            fs::create_symlink(target, folder.path / "Q" / name);
        };
        for (const char* name : {"wire.pvd", "summary.json", "trace.csv"}) {
            linked(name, name);
            refused("report Q", name);
        }
        linked("wire.pvd", "wire.pvd");
        refused("render Q", "wire.pvd");
        if (fs::exists("/dev/zero"))
            for (const char* name : {"trace.csv", "wire.pvd"}) {  // has no end
                linked(name, "/dev/zero");
                refused("render Q", name);
            }
        linked("summary.json", "summary.json");
        fs::remove(folder.path / "Q/summary.json");
        folder.write("Q/summary.json", "{\"a\":" + std::string(200'000, '[') + std::string(200'000, ']') + "}");
        refused("report Q", "is nested deeper than 32 levels");
        const std::string list = slurp(folder.path / "R/wire.pvd"), first = "file=\"wire_000000.vtp\"";
        REQUIRE(has(list, first));
        std::string away = list, twice = list;
        away.replace(away.find(first), first.size(), "file=\"../R/wire_000000.vtp\"");
        twice.replace(twice.find(first), first.size(), "file=\"wire_000010.vtp\"");
        folder.write("R/wire.pvd", away);
        refused("render R", "expected files beside it");
        folder.write("R/wire.pvd", twice);
        refused("render R", "twice");
    }
}

}  // namespace seldinger::test::test_surroundings
