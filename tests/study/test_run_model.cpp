// How runs are sampled, averaged, stopped and judged: on scripted readings, and on a real wire where the answer is known.

#include "study/scripted_simulation.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace seldinger;
using namespace seldinger::test;

TEST_SUITE("study/run_model")
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
        for (const double dt : {0.0005, 0.001, 0.007, 1.0 / 30}) {
            CAPTURE(dt);
            const StudyScene scene = scripted_scene();
            RunPlan plan;
            plan.interval = 0.1;
            const ModelRun run = run_model(scene, scripted_model(dt), plan, scripted(ramp));
            REQUIRE(run.complete);
            REQUIRE(run.trajectory.samples.size() == 10);
            const double steps = std::ceil(0.1 / dt - 1e-9), h = 0.1 / steps;
            const double averaged = std::max(1.0, std::round(0.02 / h));  // steps
            for (std::size_t k = 0; k < 10; ++k) {
                const Sample& s = run.trajectory.samples[k];
                const double t = 0.1 * static_cast<double>(k + 1);
                CHECK(s.t == about(t).epsilon(1e-12));
                CHECK(s.shape[0].x() == about(t).epsilon(1e-9));
                CHECK(s.inserted == about(0.01 * t).epsilon(1e-9));
                CHECK(s.hand_force == about(t - h * (averaged - 1) / 2).epsilon(1e-9));
                CHECK(s.friction == s.hand_force);
                CHECK(s.contact_up_to.back() <= t + 1e-12);  // of up to four looks in the same 20 ms
                CHECK(s.contact_up_to.back() >= t - 0.02);
            }
        }
    }

    TEST_CASE("property: a run over its limit, or told to stop, ends early and says so")
    {
        const StudyScene scene = scripted_scene();
        RunPlan plan;
        plan.interval = 0.1;
        plan.wall_limit = 0;
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
        const char* text = R"(
            [scene]
            duration_s = 0.2
            dt_s = 0.001
            gravity = [0.0, 0.0, -9.81]
            [wire]
            length_m = 0.1
            radius_m = 0.0004
            density = 7900.0
            bend_nm2 = 1e-5
            twist_nm2 = 1e-5
            stretch_n = 1e4
            nodes = 11
            place = { shape = "straight", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] })";
        const StudyScene scene = load_study_scene(read_scene_text(text, "falling.toml"));
        RunPlan plan;
        plan.interval = 0.05;
        for (const int nodes : {5, 40}) {
            Model model;
            model.nodes = nodes;
            model.dt = 0.005;
            const ModelRun run = run_model(scene, model, plan);
            REQUIRE(run.complete);
            CHECK(run.nodes == nodes);
            CHECK(run.behaviour.verdict == Verdict::Hold);
            for (const Sample& s : run.trajectory.samples) {
                CHECK(static_cast<int>(s.shape.size()) == nodes);
                // backward Euler falls by g h^2 n (n + 1) / 2 = g t (t + h) / 2
                CHECK(s.shape.front().z() == about(-9.81 * s.t * (s.t + 0.005) / 2).epsilon(1e-9));
            }
        }
    }
}

TEST_SUITE("study/behaviour")
{
    Behaviour behaviour_of(const std::function<Moment(double)>& script)
    {
        return run_model(scripted_scene(), scripted_model(), {}, scripted(script)).behaviour;
    }

    TEST_CASE("property: a steady run holds, whatever it does now and then")
    {
        const Behaviour b = behaviour_of([](double t) {
            Moment m;
            m.readings.hand_force =
                0.2 + 0.1 * t + (std::abs(t - 0.5) < 0.01 ? 0.3 : 0.0);  // pushes harder and harder, and once hits
            m.readings.kinetic = 1e-7;
            return m;
        });
        CHECK(b.verdict == Verdict::Hold);
        CHECK(b.jitter < 1e-6);
        CHECK(b.steps == 1000);
    }

    TEST_CASE("analytic: jitter is the step-to-step change of an alternating force over its mean, or over a millinewton")
    {
        const auto alternating = [](double mean, double amplitude) {
            return [=](double t) {
                Moment m;
                m.readings.hand_force = mean + amplitude * (std::lround(t / 1e-3) % 2 ? 1 : -1);
                return m;
            };
        };
        const Behaviour much = behaviour_of(alternating(0.2, 0.02)), little = behaviour_of(alternating(0.2, 0.005));
        CHECK(much.jitter == about(0.2).epsilon(1e-9));
        CHECK(much.verdict == Verdict::Jitter);
        CHECK(little.jitter == about(0.05).epsilon(1e-9));
        CHECK(little.verdict == Verdict::Hold);
        CHECK(behaviour_of(alternating(0, 1e-5)).jitter == about(0.02).epsilon(1e-9));
    }

    TEST_CASE("property: overlap, escape, blow-up and giving up are told apart, and the worst is named")
    {
        const auto with = [](auto change) {
            return [=](double t) {
                Moment m;
                m.readings.hand_force = 0.2;
                change(m, t);
                return m;
            };
        };
        CHECK(behaviour_of(with([](Moment& m, double) { m.readings.overlap = 3.9e-4; })).verdict == Verdict::Hold);
        CHECK(behaviour_of(with([](Moment& m, double t) { m.readings.overlap = t > 0.5 ? 4.1e-4 : 0; })).verdict ==
              Verdict::Overlap);
        CHECK(behaviour_of(with([](Moment& m, double t) {
                  m.readings.overlap = 1;
                  m.readings.outside = t > 0.5 ? 1e-6 : 0;
              })).verdict == Verdict::Escape);
        const Behaviour gone = behaviour_of(with([](Moment& m, double t) {
            if (t > 0.4995) m.readings.hand_force = std::nan("");
        }));
        CHECK(gone.verdict == Verdict::BlowUp);
        CHECK(gone.failed_at == about(0.5).epsilon(1e-6));
        CHECK(behaviour_of(with([](Moment& m, double t) {
                  if (t > 0.5) m.report.flags = StepNotConverged;
              })).verdict == Verdict::GaveUp);
    }

    TEST_CASE("analytic: energy out of nothing is a blow-up; as much as the hand gave is not")
    {
        // weight times length of this wire: 0.1 m x 3.97e-3 kg/m x 9.81 x 0.1 m = 3.9e-4 J, and hardly any from its feed speed
        const double lifted = 0.1 * 7900 * std::numbers::pi * 16e-8 * 9.81 * 0.1;
        const auto growing = [](double energy, double hand) {
            return [=](double t) {
                Moment m;
                m.readings.kinetic = energy * t;
                m.readings.hand_force = hand;
                m.readings.inserted = 0.01 * t;
                return m;
            };
        };
        CHECK(behaviour_of(growing(1.9 * lifted, 0)).verdict == Verdict::Hold);
        CHECK(behaviour_of(growing(2.1 * lifted, 0)).verdict == Verdict::BlowUp);
        // a hand that pushes with 1 N over 1 cm gives 10 mJ
        const Behaviour pushed = behaviour_of(growing(2.1 * lifted, 1));
        CHECK(pushed.verdict == Verdict::Hold);
        CHECK(pushed.energy_ratio ==
              about(2.1 * lifted / (lifted + 0.01)).epsilon(5e-3));  // work counts from the first step's end
    }
}
