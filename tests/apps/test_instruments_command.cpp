// `seldinger instruments`, `run --wire`: the list, a run with another instrument, and refusals.
#include "app_fixture.h"
#include "scene/instruments.h"

namespace seldinger::test::test_instruments_command {

TEST_SUITE("apps/instruments_command")
{
    TEST_CASE("property: the list has a line for each instrument")
    {
        const ScratchFolder folder;
        const AppResult list = run_ok(folder, "instruments");
        CHECK(list.err.empty());
        for (const std::string& name : seldinger::instrument_names()) CHECK(has(list.out, "\n" + name + " "));
        CHECK(has(list.out, "0.035 in   0.889"));
        CHECK(has(list.out, "5.0 F      1.666   1.10"));
        CHECK(has(list.out, "5.0e-05 - 4.9e-03"));
        CHECK(std::count(list.out.begin(), list.out.end(), '\n') == static_cast<long>(seldinger::instrument_names().size()) + 2);
    }

    TEST_CASE("property: --wire is --set wire.preset, and what ran is written out in full")
    {
        const ScratchFolder folder{{"free.toml", free_scene(0.005, 1)}};
        run_ok(folder, "run free.toml -o a --quiet --wire coronary-soft-014");
        run_ok(folder, "run free.toml -o b --quiet --set wire.preset=coronary-soft-014");
        const std::string scene = slurp(folder.path / "a" / "scene.toml");
        CHECK(has(scene, "radius_m = 0.0001778\n"));
        CHECK_FALSE(has(scene, "preset"));
        CHECK(scene == slurp(folder.path / "b" / "scene.toml"));
        const auto summary = summary_of(folder.path / "a");
        CHECK(summary.at("state_hash") == summary_of(folder.path / "b").at("state_hash"));
        CHECK(has(summary.at("model").dump(), "coronary-soft-014"));
        // and the written scene runs to the same bits
        run_ok(folder, "run a/scene.toml -o c --quiet");
        CHECK(summary.at("state_hash") == summary_of(folder.path / "c").at("state_hash"));
    }

    TEST_CASE("bad input: one line and exit 2")
    {
        const ScratchFolder folder{{"free.toml", free_scene()}, {"loop.toml", "include = \"loop.toml\"\n" + free_scene()}};
        for (const char* arguments : {"run free.toml --wire lunderqist", "run free.toml --wire ''", "run free.toml --wire '[3'",
                                      "check loop.toml", "instruments extra"}) {
            CAPTURE(arguments);
            const AppResult result = run_app(folder, arguments);
            CHECK(result.code == 2);
            CHECK(result.error_lines() == 1);
        }
    }
}

}  // namespace seldinger::test::test_instruments_command
