// seldinger stability: a wrong command line, scenes that say nothing, Ctrl-C half-way, going on.

#include "apps/app_fixture.h"

namespace seldinger::test::test_stability_command {

namespace {

/// Seven steps for each value in a fraction of a second.
std::string swept(const std::string& scene, const std::string& more = "--vary wire.bend_nm2=1e-5,1e-4 --methods default -o D")
{
    return "stability " + scene + " " + more;
}

/// Without the picture, which takes longer to draw than the cells to run.
AppResult run_undrawn(const ScratchFolder& folder, const std::string& arguments)
{
    return run_app(folder, arguments, "env SELDINGER_ASSETS=.");
}

long rows_of(const ScratchFolder& folder) { return static_cast<long>(csv_rows(folder.path / "D" / "stability.csv").size()) - 1; }

}  // namespace

TEST_SUITE("apps/stability")
{
    TEST_CASE("property: a wrong row, map, method, sweep or scene is one line that says what is expected")
    {
        const ScratchFolder folder;
        folder.write("free.toml", free_scene());
        const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
            CAPTURE(arguments);
            const AppResult result = run_app(folder, "stability " + arguments);
            CHECK(result.code == code);
            CHECK(result.error_lines() == 1);
            CHECK(result.err.find(words) != std::string::npos);
        };
        refused("--row F22", 2, "expected F1 to F21");
        refused("--maps stifness", 2, "expected one of: axial; stiffness");
        refused("--methods fast", 2, "expected one of: published");
        refused("--vary wire.bend_nm2=1", 2, "goes with a SCENE.toml");
        refused("free.toml", 2, "--vary vessel.youngs_pa=1e5,1e6,1e7");
        refused("free.toml --vary wire.bend_nm2=2,1", 2, "numbers, rising");
        refused("free.toml --vary wire.bend_nm2=1,x", 2, "numbers, rising");
        refused("free.toml --vary wire.bend=1", 2, "unknown key");
        refused("free.toml --row F3 --vary wire.bend_nm2=1", 2, "which is one map");
        folder.write("instant.toml", free_scene(0.01));
        refused("instant.toml --vary wire.bend_nm2=1", 2, "scene.duration_s");
        refused("none.toml --vary wire.bend_nm2=1", 3, "none.toml");
        refused("--cell-budget 0", 2, "cell-budget");
        CHECK_FALSE(fs::exists(folder.path / "stability"));
    }

    TEST_CASE("property: cells that are there are not run again; more of the selection is added to them")
    {
        const ScratchFolder folder;
        folder.write("free.toml", free_scene());
        const AppResult first = run_app(folder, swept("free.toml"));
        CHECK(first.code == 0);
        CHECK(first.out.find("14/14") != std::string::npos);
        CHECK(first.out.find("the scene has no vessel") != std::string::npos);
        CHECK(fs::exists(folder.path / "D" / "stability.png"));
        const std::string table = slurp(folder.path / "D" / "stability.csv");
        REQUIRE(rows_of(folder) == 14);
        CHECK(run_undrawn(folder, swept("free.toml")).code == 0);
        CHECK(slurp(folder.path / "D" / "stability.csv") == table);
        CHECK(run_undrawn(folder, swept("free.toml", "--vary wire.bend_nm2=1e-5,1e-4,1e-3 --methods default -o D")).code == 0);
        CHECK(rows_of(folder) == 21);
        CHECK(slurp(folder.path / "D" / "stability.csv").starts_with(table));
    }

    TEST_CASE("property: a scene that never touches the wall, and one in which nothing holds, are said to be so")
    {
        const ScratchFolder folder;
        std::string scene = tube_scene(0.05);
        scene.replace(scene.find("0.084"), 5, "0.008");  // fed by 0.2 mm of the millimetre to the floor
        folder.write("short.toml", scene);
        const AppResult far = run_undrawn(folder, swept("short.toml"));
        CHECK(far.code == 0);
        CHECK(far.out.find("never touches the wall") != std::string::npos);
        // a thousand tons at the tip of a wire of half a millimetre
        folder.write("torn.toml", free_scene() + "[[load]]\nat = \"tip\"\nforce_n = [0.0, 1.0e7, 0.0]\n");
        const AppResult torn =
            run_undrawn(folder, swept("torn.toml", "--vary wire.bend_nm2=1e-5,1e-4 --methods default explicit -o E"));
        CHECK(torn.code == 0);
        CHECK(torn.out.find("no method holds in any cell") != std::string::npos);
        CHECK(torn.out.find("seldinger check") != std::string::npos);
    }

    TEST_CASE("property: a cell that its budget cuts short is unfinished, is said to be, and is run again when there is more")
    {
        const ScratchFolder folder;
        folder.write("free.toml", free_scene(2.0));
        const std::string sweep = "--vary wire.bend_nm2=1e-4 --methods default -o D";
        const AppResult cut = run_undrawn(folder, swept("free.toml", sweep + " --cell-budget 1e-6"));
        CHECK(cut.code == 0);
        CHECK(cut.out.find("0/7") != std::string::npos);
        CHECK(cut.out.find("7 cells were not finished") != std::string::npos);
        CHECK(slurp(folder.path / "D" / "stability.csv").find("unfinished") != std::string::npos);
        const AppResult more = run_undrawn(folder, swept("free.toml", sweep + " --cell-budget 1e5"));
        CHECK(more.out.find("7/7") != std::string::npos);
        CHECK(more.out.find("not finished") == std::string::npos);
    }

    TEST_CASE("property: Ctrl-C ends it with exit 130 and one line that says how to go on; what was done is kept")
    {
        const ScratchFolder folder;
        // minutes of it: the signal comes long before the end, whatever the machine
        const AppResult cut =
            run_and_signal(folder.path, {"stability", "--row", "F3", "-o", "D"}, folder.path / "D" / "stability.csv", 1, SIGINT);
        CAPTURE(cut.err);
        CHECK(cut.code == 130);
        CHECK(cut.error_lines() == 1);
        CHECK(cut.err.find("the same command continues") != std::string::npos);
        CHECK(rows_of(folder) >= 1);
        CHECK(fs::exists(folder.path / "D" / "maps.json"));
    }
}

}  // namespace seldinger::test::test_stability_command
