// Worlds of a batch that a limit may stop: the first runs are finished early, whatever a run takes.

#include "apps/app_fixture.h"
#include "batch/batch.h"
#include "support/scenes.h"

#include <cmath>
#include <numeric>

namespace seldinger::test::test_batch_ramp {

TEST_SUITE("batch/batch_ramp")
{
    TEST_CASE("property: worlds double from one run, in order and without a gap, up to the size that they have without a limit")
    {
        BatchSource source{free_scene(), "free.toml", {}, {}};
        source.sweep = read_sweep_text("[vary]\n\"wire.bend_nm2\" = {min = 1e-5, max = 1e-4, n = 400}\n", "sweep.toml", 0);
        const auto worlds = plan_worlds(source, 0, source.sweep.run_count(), true);
        std::vector<std::size_t> all;
        std::size_t size = 1;
        for (std::size_t w = 0; w < worlds.size(); ++w) {
            if (w + 1 < worlds.size()) CHECK(worlds[w].size() == size);
            // before a world begins, as many runs are finished as it holds, less one, except for the last size
            if (size < most_wires) CHECK(all.size() + 1 >= size);
            all.insert(all.end(), worlds[w].begin(), worlds[w].end());
            size = std::min(2 * size, most_wires);
        }
        std::vector<std::size_t> expected(400);
        std::iota(expected.begin(), expected.end(), std::size_t{0});
        CHECK(all == expected);
        CHECK(plan_worlds(source).front().size() == most_wires);
    }

    // steps of 1e-151 s: a path of four kilometres in one of them has energies that are no numbers, a wire that stays has none
    TEST_CASE("property: a run whose readings are no numbers is stopped, and the other of its world goes on")
    {
        BatchSource source{scene_text(3e-151, 1e-151) + wire_text(1e4, 1e-5, 8e-6, 21, 0.0004445) +
                               "[feed]\npoint = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n"
                               "keys = [{t_s = 0.0, advance_m = 5000.0}]\n",
                           "fast.toml",
                           {},
                           {}};
        source.sweep = read_sweep_text(
            "[vary]\n\"feed.keys\" = [[{t_s = 0.0, advance_m = 5000.0}], [{t_s = 0.0, advance_m = 5000.0}, {t_s = 1e-151, "
            "advance_m = "
            "9000.0}]]\n",
            "sweep.toml", 0);
        const auto worlds = plan_worlds(source);
        REQUIRE(worlds.size() == 1);
        BatchWorld world(source, worlds[0], {}, -1);
        std::vector<BatchRow> rows;
        unsigned said = 0;  // of the step that stopped it
        while (!world.finished())
            for (const BatchRow& row : world.step()) {
                if (row.run == 1) said = world.world().report(1).flags;
                rows.push_back(row);
            }
        REQUIRE(rows.size() == 2);
        CHECK(rows[0].run == 1);
        CHECK(rows[0].status == RunStatus::Stopped);
        CHECK((said & (StepNonFinite | StepEnergy)) != 0);
        CHECK(rows[1].status == RunStatus::Done);
        // a target that was not reached has no place and no time: empty in the table
        for (std::size_t c = 0; c < std::size(batch_columns); ++c)
            CHECK((batch_columns[c].of_task || std::isfinite(rows[1].numbers[c])));
        const std::string table = batch_csv(source.sweep, source.layout(), rows);
        for (const char* odd : {"inf", "nan"}) CHECK_FALSE(has(table, odd));
    }

    TEST_CASE("property: a limit leaves finished runs, and the rest comes with --resume, to the bits of a batch without one")
    {
        const ScratchFolder folder;
        folder.write("f.toml", free_scene(0.3));
        folder.write("v.toml", "[vary]\n\"wire.bend_nm2\" = {min = 1e-5, max = 1e-4, n = 40}\n");
        // limits that grow from less than a run takes: some call ends with runs done
        run_ok(folder, "batch f.toml --vary v.toml -o whole --quiet");
        int calls = 0;
        const auto done = [&] { return csv_rows(folder.path / "part" / "results.csv").size() - 1; };
        for (double limit = 0.02; calls < 200; ++calls, limit *= 1.2) {
            const AppResult part =
                run_app(folder, fmt::format("batch f.toml --vary v.toml -o part --quiet --resume --time-limit {}", limit));
            CAPTURE(part.err);
            REQUIRE((part.code == 75 || part.code == 0));
            if (done() > 0) break;
        }
        CHECK(done() > 0);
        run_ok(folder, "batch f.toml --vary v.toml -o part --quiet --resume");
        const auto hashes = [&](const char* dir) {
            std::vector<std::string> list;
            for (const auto& row : csv_rows(folder.path / dir / "results.csv")) list.push_back(row.front() + " " + row.back());
            return list;
        };
        CHECK(hashes("part") == hashes("whole"));
    }
}

}  // namespace seldinger::test::test_batch_ramp
