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
        const ScratchFolder folder{{"free.toml", free_scene()}};
        const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
            check_refused(folder, "stability " + arguments, code, words);
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
        const ScratchFolder folder{{"free.toml", free_scene()}};
        const AppResult first = run_ok(folder, swept("free.toml"));
        CHECK(has(first.out, "14/14"));
        CHECK(has(first.out, "the scene has no vessel"));
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
        CHECK(has(far.out, "never touches the wall"));
        // a thousand tons at the tip of a wire of half a millimetre
        folder.write("torn.toml", free_scene() + "[[load]]\nat = \"tip\"\nforce_n = [0.0, 1.0e7, 0.0]\n");
        const AppResult torn =
            run_undrawn(folder, swept("torn.toml", "--vary wire.bend_nm2=1e-5,1e-4 --methods default explicit -o E"));
        CHECK(torn.code == 0);
        CHECK(has(torn.out, "no method holds in any cell"));
        CHECK(has(torn.out, "seldinger check"));
    }

    TEST_CASE("property: a cell that its budget cuts short is unfinished, is said to be, and is run again when there is more")
    {
        const ScratchFolder folder{{"free.toml", free_scene(2.0)}};
        const std::string sweep = "--vary wire.bend_nm2=1e-4 --methods default -o D";
        const AppResult cut = run_undrawn(folder, swept("free.toml", sweep + " --cell-budget 1e-6"));
        CHECK(cut.code == 0);
        CHECK(has(cut.out, "0/7"));
        CHECK(has(cut.out, "7 cells were not finished"));
        CHECK(has(slurp(folder.path / "D" / "stability.csv"), "unfinished"));
        const AppResult more = run_undrawn(folder, swept("free.toml", sweep + " --cell-budget 1e5"));
        CHECK(has(more.out, "7/7"));
        CHECK_FALSE(has(more.out, "not finished"));
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
        CHECK(has(cut.err, "the same command continues"));
        CHECK(rows_of(folder) >= 1);
        CHECK(fs::exists(folder.path / "D" / "maps.json"));
    }
}

}  // namespace seldinger::test::test_stability_command
