// How far a reference is trusted: Richardson's bound, and when movements fall.

#include "models/refinement.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

#include <cmath>
#include <filesystem>
#include <vector>

namespace seldinger::test::test_refinement {

TEST_SUITE("models/refinement")
{
    TEST_CASE("analytic: the bound covers the error that is left of a series that falls with order 1/2 to 4")
    {
        for (const double order : {0.5, 1.0, 1.5, 2.0, 4.0}) {
            CAPTURE(order);
            const auto error = [order](int level) { return 1e-3 * std::pow(2.0, -order * level); };
            std::vector<double> moved;
            for (int level = 0; level < 5; ++level) {
                moved.push_back(error(level) - error(level + 1));
                const double left = error_left(moved), truth = error(level + 1);
                if (level == 0 && order < 0.4) continue;
                CHECK(left >= 0.999 * truth);
                // not needlessly: exact where the order is 1 or less, and never beyond the last movement where it is more
                if (level > 0 && order <= 1) CHECK(left <= 1.001 * truth);
                if (level > 0 && order > 1) CHECK(left <= 1.001 * moved.back());
            }
        }
    }

    TEST_CASE("property: without a second movement, or with movements that do not fall, the bound is four movements")
    {
        CHECK(error_left({1e-4}) == about(4e-4).epsilon(1e-9));
        CHECK(error_left({1e-4, 1e-4}) == about(4e-4).epsilon(1e-9));
        CHECK(error_left({1e-4, 3e-4}) == about(12e-4).epsilon(1e-9));
        CHECK(std::isinf(error_left({})));
        CHECK(error_left({1e-4, 0}) == 0);
    }

    // at 16.7 ms the trapezoid rule makes energy in this swing, and steps are halved for it; at 4 ms it does not
    TEST_CASE("property: a coarse level whose steps are halved does not cost the reference its order in time")
    {
        const TemporaryFolder folder;
        const StudyScene scene =
            load_study_scene(read_scene(std::filesystem::path(SEL_SOURCE_DIR) / "assets/scenes/study/heavy-swing.toml"));
        RunPlan plan{.until = 1, .interval = 1.0 / 30};
        ReferenceGoals goals{.shape = 1e-3, .force = INFINITY};
        goals.affordable = [](double) { return true; };
        RunStore store(folder.path());
        const Reference reference = refine_scene(scene, plan, goals, store, "reference", {});
        CHECK(reference.converges);
        CHECK(reference.model.trapezoid == true);
        CHECK(at(reference.uncertainty, Observable::Shape) <= 1e-3);
    }

    TEST_CASE("analytic: sequences that fall, that do not, and that have arrived")
    {
        CHECK(judge_movements({}, 0) == Convergence::Unknown);
        CHECK(judge_movements({1}, 0) == Convergence::Unknown);        // one movement says nothing
        CHECK(judge_movements({1e-9}, 1e-8) == Convergence::Falling);  // but that it has arrived
        CHECK(judge_movements({1e-9, 9e-9}, 1e-8) == Convergence::Falling);
        CHECK(judge_movements({4, 2, 1}, 0) == Convergence::Falling);
        CHECK(judge_movements({4, 1, 1.2}, 0) == Convergence::Falling);  // one unlucky pair
        CHECK(judge_movements({4, 2, 2.5}, 0) == Convergence::Falling);
        CHECK(judge_movements({4, 2, 2.6}, 0) == Convergence::NotFalling);
        CHECK(judge_movements({4, 3.9, 3.8}, 0) == Convergence::NotFalling);  // creeps
        CHECK(judge_movements({1, 2, 4}, 0) == Convergence::NotFalling);
        CHECK(judge_movements({1, 0.9}, 0) == Convergence::NotFalling);
    }
}

}  // namespace seldinger::test::test_refinement
