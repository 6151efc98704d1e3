// How runs are sampled, averaged, stopped and judged: on scripted readings, and on a real wire where the answer is known.

#include "models/scripted_simulation.h"
#include "support/approx.h"
#include "support/scenes.h"

#include <cmath>

namespace seldinger::test::test_run_model {

TEST_SUITE("models/run_model")
{
    TEST_CASE("analytic: samples lie on the grid for any step; forces are means over the 20 ms before")
    {
        const auto ramp = [](double t) {
            Moment m;
            m.readings.hand_force = m.readings.friction = t;
            m.readings.inserted = 0.01 * t;
            m.shape[0] = {t, 0, 0};
            m.forces = {{0.05, t}};
            return m;
        };
        for (const double dt : {0.0005, 0.001, 0.007, 1.0 / 60, 1.0 / 30}) {
            CAPTURE(dt);
            const StudyScene scene = scripted_scene();
            RunPlan plan;
            plan.interval = 0.1;
            const ModelRun run = run_model(scene, scripted_model(dt), plan, scripted(ramp));
            REQUIRE(run.complete);
            REQUIRE(run.trajectory.samples.size() == 10);
            const double steps = std::ceil(0.1 / dt - 1e-9), h = 0.1 / steps;
            // steps in a mean, of which the first lies in it with a part; at least one
            const double in_mean = std::max(1.0, 0.02 / h), whole = std::ceil(in_mean - 1e-9) - 1;
            const double earlier = (whole * (whole - 1) / 2 + (in_mean - whole) * whole) / in_mean;  // than the sample, in steps
            for (std::size_t k = 0; k < 10; ++k) {
                const Sample& s = run.trajectory.samples[k];
                const double t = 0.1 * static_cast<double>(k + 1);
                CHECK(s.t == about(t).epsilon(1e-12));
                CHECK(s.shape[0].x() == about(t).epsilon(1e-9));
                CHECK(s.inserted == about(0.01 * t).epsilon(1e-9));
                CHECK(s.hand_force == about(t - h * earlier).epsilon(1e-9));
                CHECK(s.friction == s.hand_force);
                CHECK(s.contact_up_to.back() <= t + 1e-12);  // of up to four looks in the same 20 ms
                CHECK(s.contact_up_to.back() >= t - 0.02);
            }
        }
    }

    TEST_CASE("property: a run over its limit, or told to stop, ends early and says so")
    {
        const StudyScene scene = scripted_scene();
        RunPlan plan{.interval = 0.1, .wall_limit = 0};
        const ModelRun slow = run_model(scene, scripted_model(), plan, scripted([](double) { return Moment{}; }));
        CHECK(slow.over_limit);
        CHECK_FALSE(slow.complete);
        plan.wall_limit = 1e9;
        int asked = 0;
        plan.stop = [&asked] { return ++asked > 3; };
        const ModelRun stopped = run_model(scene, scripted_model(), plan, scripted([](double) { return Moment{}; }));
        CHECK(stopped.stopped);
        CHECK_FALSE(stopped.complete);
        CHECK(stopped.trajectory.samples.size() == 3);
    }

    TEST_CASE("property: repeats are timed, their median lies between their ends")
    {
        const StudyScene scene = scripted_scene();
        RunPlan plan;
        plan.repeats = 3;
        const ModelRun run = run_model(scene, scripted_model(), plan, scripted([](double) { return Moment{}; }));
        CHECK(run.cost.repeats == 3);
        CHECK(run.cost.lowest <= run.cost.wall);
        CHECK(run.cost.wall <= run.cost.highest);
    }

    TEST_CASE("analytic: a wire that falls freely is sampled where it is, in a real world, under two models")
    {
        const std::string text = scene_text(0.2) + wire_text(0.1, 1e-5, 1e-5, 11) + placed_along_x;
        const StudyScene scene = load_study_scene(read_scene_text(text, "falling.toml"));
        RunPlan plan;
        plan.interval = 0.05;
        for (const int nodes : {5, 40}) {
            Model model{.nodes = nodes, .dt = 0.005};
            const ModelRun run = run_model(scene, model, plan);
            REQUIRE(run.complete);
            CHECK(run.nodes == nodes);
            CHECK(run.verdict.held());
            for (const Sample& s : run.trajectory.samples) {
                CHECK(static_cast<int>(s.shape.size()) == nodes);
                // backward Euler falls by g h^2 n (n + 1) / 2 = g t (t + h) / 2
                CHECK(s.shape.front().z() == about(-9.81 * s.t * (s.t + 0.005) / 2).epsilon(1e-9));
            }
        }
    }
}

TEST_SUITE("models/run_watch")
{
    TEST_CASE("property: a run that fails ends at once, with its outcome and time; overlap beyond the wire's radius is one")
    {
        const auto run = [](const std::function<void(Moment&, double)>& change) {
            return run_model(scripted_scene(), scripted_model(), {}, scripted([change](double t) {
                                 Moment m;
                                 m.readings.hand_force = 0.2;
                                 change(m, t);
                                 return m;
                             }));
        };
        const ModelRun lost = run([](Moment& m, double t) {
            if (t > 0.4995) m.readings.hand_force = std::nan("");
        });
        CHECK(lost.verdict.outcome == Outcome::BlowUp);
        CHECK_FALSE(lost.complete);
        CHECK(lost.failed_at == about(0.5).epsilon(1e-6));
        const ModelRun stuck = run([](Moment& m, double t) {
            if (t > 0.2495) m.report.flags = StepNotConverged;
        });
        CHECK(stuck.verdict.outcome == Outcome::GaveUp);
        CHECK(stuck.failed_at == about(0.25).epsilon(1e-6));
        CHECK(run([](Moment& m, double) { m.readings.overlap = 3.9e-4; }).verdict.held());
        const ModelRun deep = run([](Moment& m, double) { m.readings.overlap = 4.1e-4; });
        CHECK(deep.verdict.outcome == Outcome::Overlap);
        CHECK(deep.complete);
    }

    TEST_CASE("analytic: a load's and a moving hold's work is counted: a wire thrown by them has not made its energy")
    {
        // 1 N along x moves the tip by 1 cm; its 10 mJ are kinetic energy
        const auto thrown = [](double t) {
            Moment m;
            m.shape = {{0.1 + 0.01 * t * t, 0, 0}, {0, 0, 0}};
            m.readings.kinetic = 0.01 * t * t;
            return m;
        };
        StudyScene scene = scripted_scene();
        scene.scene.feed.on = false;
        scene.scene.loads = {{.at = {WirePoint::Kind::Tip}, .force = {1, 0, 0}}};
        CHECK(run_model(scene, scripted_model(), {}, scripted(thrown)).verdict.held());
        scene.scene.loads.front().force = {0.5, 0, 0};
        CHECK(run_model(scene, scripted_model(), {}, scripted(thrown)).verdict.outcome == Outcome::BlowUp);

        // the same by a base that is pulled along with 1 N
        const auto pulled = [](double t) {
            Moment m;
            m.shape = {{0.1 + 0.01 * t, 0, 0}, {0.01 * t, 0, 0}};
            m.readings.base_force = {1, 0, 0};
            m.readings.kinetic = 0.01 * t;
            return m;
        };
        scene.scene.loads.clear();
        CHECK(run_model(scene, scripted_model(), {}, scripted(pulled)).verdict.held());
    }

    // C phi^2 / 2L = 1.25 mJ in a wire turned by 5 rad (half of what makes it buckle): slower than torsion waves by a hundred
    // times, so that the motion is nothing beside
    TEST_CASE("analytic: the work of turning a held base is counted, in a real world")
    {
        const std::string text = scene_text(0.2, 1e-3, "gravity = [0.0, 0.0, 0.0]\n") + wire_text(0.1, 1e-5, 1e-5, 11) +
                                 placed_along_x + held_base + "turn = [[0.0, 0.0], [0.2, 5.0]]\n" +
                                 "[[hold]]\nat = \"tip\"\nposition = true\ndirection = true\nspin = true\n";
        const ModelRun run = run_model(load_study_scene(read_scene_text(text, "turned.toml")), {}, {});
        CHECK(run.verdict.held());
        CHECK(run.verdict.readings.energy_made < 0.01 * 1.25e-3);
    }
}

}  // namespace seldinger::test::test_run_model
