// A chart's reference: whether refinements converge, how far, and that finished ones are not run again.

#include "models/refinement.h"
#include "models/scripted_simulation.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"

#include <cmath>
#include <limits>

namespace seldinger::test::test_reference {

namespace {

// a clamped wire that swings down under its weight, by backward Euler: first order in the step
StudyScene swing()
{
    const std::string text = scene_text(0.1, 0.002) + wire_text(0.1, 1e-4, 1e-4, 11) + placed_along_x + held_base;
    return load_study_scene(read_scene_text(text, "swing.toml"));
}

Refinement from(int nodes, double dt, int levels)
{
    Refinement how;
    how.coarsest.nodes = nodes;
    how.coarsest.dt = dt;
    how.coarsest.tolerance = 1e-9;
    how.most_levels = levels;
    return how;
}

constexpr PerObservable as_good_as_can_be{};

/// A chart's refinement, with a folder of its own unless one is given.
struct Refining {
    Refining(const StudyScene& scene, Refinement levels, const RunPlan& plan, std::vector<Baseline> baselines = {},
             const std::filesystem::path& folder = {})
        : how(std::move(levels)),
          store(folder.empty() ? own.path() : folder),
          refiner(scene, how.levels(), plan, store, "reference", {}, std::move(baselines))
    {
    }
    const Reference& to(const PerObservable& wanted) { return refine_to(refiner, how, wanted); }

    TemporaryFolder own;
    Refinement how;
    RunStore store;
    Refiner refiner;
};

}  // namespace

TEST_SUITE("models/reference")
{
    TEST_CASE(
        "property: a smooth scene converges at the integrator's order, and its uncertainty bounds the finest run's own error")
    {
        const StudyScene scene = swing();
        RunPlan plan;
        plan.interval = 0.02;
        Refining refining(scene, from(11, 5e-4, 4), plan);
        const Reference& reference = refining.to(as_good_as_can_be);
        REQUIRE(reference.levels.size() == 4);
        REQUIRE(reference.moved.size() == 3);
        CHECK(reference.usable(Observable::Tip));
        const double order = std::log2(at(reference.moved[1], Observable::Tip) / at(reference.moved[2], Observable::Tip));
        CHECK(order == about(1.0).epsilon(0.15));  // of successive differences
        // one more halving moves the tip by less than the uncertainty
        const ModelRun finer = run_model(scene, from(11, 5e-4, 4).model(4), plan);
        const Errors left = trajectory_errors(reference.values, finer.trajectory);
        CHECK(at(left.rms, Observable::Tip) < at(reference.uncertainty, Observable::Tip));
    }

    TEST_CASE("property: the control mesh of an elastic wall is refined with the wire, as far as its least edge")
    {
        Refinement how = from(11, 5e-4, 4);
        CHECK_FALSE(how.model(2).wall_edge);
        how.coarsest.wall_edge = 9e-3;
        how.least_wall_edge = 3e-3;
        CHECK(how.model(0).wall_edge == 9e-3);
        CHECK(*how.model(2).wall_edge == about(4e-3).epsilon(1e-12));
        CHECK(how.model(3).wall_edge == 3e-3);
        CHECK(how.model(3).nodes == 81);
    }

    TEST_CASE("property: refinement ends when it is good enough, and finished levels are taken from the folder")
    {
        const TemporaryFolder folder;
        const StudyScene scene = swing();
        RunPlan plan;
        plan.interval = 0.02;
        Refinement how = from(6, 2e-3, 5);
        how.least_levels = 2;
        PerObservable rough;
        rough.fill(std::numeric_limits<double>::infinity());
        at(rough, Observable::Tip) = 1.0;
        {
            Refining refining(scene, how, plan, {}, folder.path());
            CHECK(refining.to(rough).levels.size() == 2);
            CHECK(refining.to(as_good_as_can_be).levels.size() == 5);
        }
        plan.stop = [] { return true; };  // whatever is run now is stopped at once
        Refining again(scene, how, plan, {}, folder.path());
        const Reference& reference = again.to(as_good_as_can_be);
        CHECK(reference.levels.size() == 5);
        CHECK_FALSE(reference.stopped);
        CHECK(reference.usable(Observable::Tip));
    }

    TEST_CASE("property: a scene whose answer jumps with every refinement is found out, and the search ends early")
    {
        int runs = 0;
        Baseline jumping;
        jumping.name = "scripted";
        jumping.why_not = [](const Scene&) { return std::string(); };
        jumping.make = [&runs](const StudyScene&, const Model& model) {
            ++runs;
            const double side = std::lround(std::log2(1e-3 / *model.dt)) % 2 ? 0.01 : -0.01;  // left or right at a fork
            return std::make_unique<ScriptedSimulation>([side](double) {
                Moment m;
                m.shape[0].y() = side;
                return m;
            });
        };
        const StudyScene scene = scripted_scene(0.1);
        Refinement how = from(11, 1e-3, 6);
        how.coarsest.baseline = "scripted";
        PerObservable wanted;
        wanted.fill(std::numeric_limits<double>::infinity());
        at(wanted, Observable::Tip) = 0;
        Refining refining(scene, how, {}, {jumping});
        const Reference& reference = refining.to(wanted);
        CHECK(reference.convergence[0] == Convergence::NotFalling);
        CHECK_FALSE(reference.usable(Observable::Tip));
        CHECK(at(reference.uncertainty, Observable::Tip) == about(0.02).epsilon(1e-9));
        CHECK(runs == 3);
    }

    TEST_CASE(
        "property: a snap whose moment shifts with every refinement widens the band but does not hide that the rest converges")
    {
        Baseline snapping;
        snapping.name = "scripted";
        snapping.why_not = [](const Scene&) { return std::string(); };
        snapping.make = [](const StudyScene&, const Model& model) {
            const double dt = *model.dt,
                         snap = std::lround(std::log2(1e-3 / dt)) % 2 ? 0.049 : 0.051;  // about the sample at 0.05
            return std::make_unique<ScriptedSimulation>([dt, snap](double t) {
                Moment m;
                m.shape[0].y() = (t < snap ? 0.0 : 0.01) + 0.01 * dt / 1e-3;
                return m;
            });
        };
        const StudyScene scene = scripted_scene(0.1);
        Refinement how = from(11, 1e-3, 4);
        how.coarsest.baseline = "scripted";
        RunPlan plan;
        plan.interval = 0.01;
        Refining refining(scene, how, plan, {snapping});
        const Reference& reference = refining.to(as_good_as_can_be);
        CHECK(reference.usable(Observable::Tip));
        CHECK(at(reference.moved_median.back(), Observable::Tip) == about(0.01 / 8).epsilon(1e-9));
        // one of ten samples is wrong by 0.01, against which the step's own error can act
        CHECK(at(reference.uncertainty, Observable::Tip) > (0.01 - 0.01 / 8) / std::sqrt(10.0));
    }
}

}  // namespace seldinger::test::test_reference
