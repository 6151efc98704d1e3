// A batch as a program of its own has it (batch/run_batch.h).

#include "batch/run_batch.h"
#include "core/error.h"
#include "core/file_io.h"
#include "record/recording.h"
#include "session/session_fixture.h"
#include "support/temporary_folder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::test::test_run_batch {

TEST_SUITE("batch/run_batch")
{
    TEST_CASE("property: a run has the bits and the numbers that it has alone and in the table; the least force is first")
    {
        const TemporaryFolder folder;
        const std::filesystem::path file = folder.path() / "tube.toml";
        write_file(file, test::live_scene);
        const std::vector<std::string> overrides = {"scene.duration_s=0.5"};
        std::size_t told = 0;
        const BatchResult made =
            run_batch(file, "[vary]\n\"wire.bend_nm2\" = [4e-5, 1e-5]\n", overrides, [&](std::size_t ended) { told = ended; });
        REQUIRE(made.runs.size() == 2);
        CHECK(told <= 2);
        CHECK(made.runs[1].overrides.front().starts_with("wire.bend_nm2="));
        for (const BatchRun& run : made.runs) {
            CHECK(run.status == "done");
            const LoadedScene scene = load_scene(file, {overrides.front(), run.overrides.front()});
            World world(scene.setup);
            Control control;
            control.follow(0, scene.keys[0]);
            while (world.time() < scene.duration - 0.5 * scene.dt) REQUIRE(!step(world, control, scene.dt).failed());
            CHECK(world.state_hash() == run.state_hash);
            CHECK(world.readings(0).hand_force == run.numbers.at("hand_force_n"));
            CHECK(made.csv.find(run.state_hash) != std::string::npos);
        }
        REQUIRE(made.ranking.size() == 2);
        const auto force = [&](std::size_t k) { return made.runs[made.ranking[k]].numbers.at("until_patch_force_max_n"); };
        CHECK(force(0) <= force(1));
        CHECK(made.answer.starts_with("2 of 2 reached"));
    }

    TEST_CASE("property: a mistake comes before the first step, and what the progress throws ends the batch")
    {
        const TemporaryFolder folder;
        const std::filesystem::path file = folder.path() / "tube.toml";
        write_file(file, test::live_scene);
        CHECK_THROWS_WITH_AS((void)run_batch(file, "[vary]\n\"wire.knots\" = [1, 2]\n"), doctest::Contains("wire.knots"), Error);
        CHECK_THROWS_AS((void)run_batch(folder.path() / "none.toml", "[vary]\n\"wire.nodes\" = [41]\n"), Error);
        struct Enough {};
        const auto stop = [](std::size_t) { throw Enough{}; };
        CHECK_THROWS_AS((void)run_batch(file, "[vary]\n\"wire.nodes\" = [41]\n", {}, stop), Enough);
    }
}

}  // namespace seldinger::test::test_run_batch
