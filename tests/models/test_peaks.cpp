// Peaks of a run: their tolerance, and their change by refinements.
#include "models/peaks.h"

#include "models/scripted_simulation.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

#include <cmath>

namespace seldinger::test::test_peaks {

TEST_SUITE("models/peaks")
{
    // a force of 5 N for 10 ms in the middle of an interval between samples: means before samples never see it
    TEST_CASE("analytic: a peak between two samples is one, as a mean over 20 ms, pulled or pushed, for any step")
    {
        const StudyScene scene = scripted_scene(0.4);
        RunPlan plan{.interval = 0.1, .peaks = true};
        const auto script = [](double t) {
            Moment now;
            now.readings.hand_force = t > 0.0400001 && t < 0.0500001 ? -5 : 1;
            now.readings.friction = t > 0.0400001 && t < 0.0500001 ? 3 : 0;
            return now;
        };
        for (const double dt : {1e-3, 2e-3, 5e-3}) {
            CAPTURE(dt);
            const ModelRun run = run_model(scene, scripted_model(dt), plan, scripted(script));
            REQUIRE(run.complete);
            CHECK(run.trajectory.samples.front().hand_force == about(1.0).epsilon(1e-12));
            CHECK(run.trajectory.peaks[0] == about(3.0).epsilon(1e-12));  // (5 + 1)/2
            CHECK(run.trajectory.peaks[1] == about(1.5).epsilon(1e-12));
        }
        plan.peaks = false;
        CHECK(run_model(scene, scripted_model(), plan, scripted(script)).trajectory.peaks == Peaks{});
    }

    TEST_CASE("property: peaks are kept with the trajectory")
    {
        const TemporaryFolder folder;
        Trajectory kept, read;
        kept.wire_length = 0.1;
        kept.peaks = {0.1, 0.02, 30};
        save_trajectory(folder.path() / "t", kept);
        REQUIRE(load_trajectory(folder.path() / "t", read));
        CHECK(read.peaks == kept.peaks);
    }

    TEST_CASE("analytic: a share is of each peak, 1 mN at least; newtons are those on one diameter of the wire")
    {
        const Peaks right = {0.2, 1e-5, 50};
        const Peaks share = PeakGoal{0.1, true, 1e-3}.allowed(right);
        CHECK(share[0] == about(0.02).epsilon(1e-12));
        CHECK(share[1] == about(1e-4).epsilon(1e-12));
        CHECK(share[2] == about(5.0).epsilon(1e-12));
        const Peaks newtons = PeakGoal{5e-3, false, 1e-3}.allowed(right);
        CHECK(newtons[0] == 5e-3);
        CHECK(newtons[2] == about(5.0).epsilon(1e-12));
    }

    TEST_CASE("property: a goal holds for all three or not at all, uncertainty included, and always where it was not asked")
    {
        const Peaks right = {1, 1, 100};
        const PeakGoal goal{0.1, true, 1e-3};
        CHECK(goal.holds({0.05, 0.05, 5}, {0.04, 0.04, 4}, right));
        CHECK_FALSE(goal.holds({0.05, 0.05, 5}, {0.06, 0.04, 4}, right));
        CHECK_FALSE(goal.holds({0.05, 0.05, 5}, {0.04, 0.04, 6}, right));
        CHECK_FALSE(goal.holds({0.05, 0.05, NAN}, {}, right));
        CHECK_FALSE(goal.holds({0.06, 0, 0}, {}, right, 0.5));
        CHECK(PeakGoal{}.holds({9, 9, 9}, {}, right));
    }

    TEST_CASE("regression: two levels that agree by chance do not make a peak known")
    {
        CHECK(peaks_left({{4, 0, 0}, {0, 0, 0}})[0] == about(2.0).epsilon(1e-12));  // half of 4, first order
        CHECK(peaks_left({{4, 0, 0}, {2, 0, 0}})[0] == about(2.0).epsilon(1e-12));
        CHECK(std::isinf(peaks_left({})[0]));
    }
}

}  // namespace seldinger::test::test_peaks
