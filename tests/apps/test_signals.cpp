// SIGINT and SIGTERM at moments when no loop looks: while a vessel is made ready, a batch is planned, kernels are built.

#include "apps/background_app.h"

#include <tuple>

namespace seldinger::test::test_signals {

namespace {

/// Ended at once: the exit code of the signal, one line, and no word of a saved run.
void ended(BackgroundApp& app, int signal, const fs::path& dir)
{
    app.send(signal);
    const AppResult result = app.result();
    CAPTURE(result.err);
    CHECK(result.code == (signal == SIGINT ? 130 : 75));
    CHECK(result.error_lines() == 1);
    CHECK_FALSE(fs::exists(dir / "summary.json"));
}

bool has_file(const fs::path& dir)
{
    std::error_code ignored;
    for (const auto& entry : fs::recursive_directory_iterator(dir, ignored))
        if (entry.is_regular_file(ignored)) return true;
    return false;
}

}  // namespace

TEST_SUITE("apps/signals")
{
    TEST_CASE("property: a run that loads its vessel ends at the signal, and runs when it is called again")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        for (const int signal : {SIGINT, SIGTERM}) {
            // a surface of two million triangles is seconds of work
            const std::string dir = signal == SIGINT ? "D" : "E";
            BackgroundApp app(folder.path,
                              {"run", "t.toml", "--set", "vessel.triangles=2000000", "-o", dir, "--quiet", "--resume"});
            REQUIRE(app.wait_until([&] { return fs::exists(folder.path / dir / ".lock"); }));
            ended(app, signal, folder.path / dir);
        }
        run_ok(folder, "run t.toml -o D --resume --quiet");
    }

    TEST_CASE("property: a batch that plans ends at the signal")
    {
        const ScratchFolder folder;
        folder.write("s.toml", free_scene(0.05));
        folder.write("v.toml", "[vary]\n\"wire.bend_nm2\" = { min = 1e-5, max = 2e-5, n = 200000 }\n");
        BackgroundApp app(folder.path, {"batch", "s.toml", "--vary", "v.toml", "-o", "D", "--quiet"});
        REQUIRE(app.wait_until([&] { return fs::exists(folder.path / "D/.lock"); }));
        ended(app, SIGTERM, folder.path / "D");
    }

    TEST_CASE("property: a signal while kernels are built is obeyed then, by every command, and the next run builds them")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        const std::vector<std::tuple<std::vector<std::string>, int>> commands = {
            {{"run", "t.toml", "-o", "D", "--quiet"}, SIGTERM},
            {{"plan", "t.toml", "--tolerance", "1mm", "-o", "P/p.toml", "--quiet"}, SIGINT},
            {{"chart", "--quick", "--scenes", "t.toml", "-o", "C", "--quiet"}, SIGTERM},
        };
        for (const auto& [arguments, signal] : commands) {
            const fs::path cache = folder.path / ("cache-" + arguments[0]);
            fs::create_directory(cache);
            BackgroundApp app(folder.path, arguments, {"POCL_CACHE_DIR=" + cache.string()});
            if (!app.wait_until([&] { return has_file(cache); })) {
                MESSAGE("no compiler's cache is seen here");
                return;
            }
            const std::string command = arguments[0];
            INFO(command);
            ended(app, signal, folder.path / "D");
        }
        run_ok(folder, "run t.toml -o D --overwrite --quiet", "env POCL_CACHE_DIR=cache-run");
    }

    TEST_CASE("property: a command without a loop ends with 128 + the signal")
    {
        const ScratchFolder folder{{"t.toml", tube_scene(0.02)}};
        std::string mesh = slurp(folder.path / "t.toml");
        mesh.replace(mesh.find("triangles = 2000"), 16, "triangles = 2000000");
        folder.write("big.toml", mesh);
        BackgroundApp app(folder.path, {"check", "big.toml"});
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        REQUIRE(app.running());
        app.send(SIGTERM);
        CHECK(app.result().code == 143);
    }
}

}  // namespace seldinger::test::test_signals
