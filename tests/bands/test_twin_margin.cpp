// How wide the bands of a run's own error estimate are: Roache's factor on what a second run with a shorter step differs by.
#include "bands/step_twin.h"

#include "setup/joint_readings.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace seldinger::test::test_twin_margin {

namespace {

/// Fed into a bend and round its beginning, in fewer steps than a window has: the twin of the only window is a whole run.
Scene short_run(double dt, double duration)
{
    return read_scene_text(
        fmt::format("[scene]\nduration_s = {}\ndt_s = {}\n"
                    "[wire]\nlength_m = 0.12\nradius_m = 0.0004445\ndensity = 7900.0\nbend_nm2 = 2e-4\ntwist_nm2 = 1.5e-4\n"
                    "stretch_n = 1e4\nnodes = 41\n"
                    "[vessel]\nshape = \"arc\"\nradius_m = 0.004\nbend_radius_m = 0.03\nangle_deg = 90.0\nlead_in_m = 0.01\n"
                    "lead_out_m = 0.03\ntriangles = 3000\n"
                    "[contact]\nmu_static = 0.25\nmu_sliding = 0.2\n"
                    "[feed]\ninlet = \"auto\"\nkeys = [{{ t_s = 0.0, advance_m = 0.0 }}, {{ t_s = 0.48, advance_m = 0.04 }}]\n",
                    duration, dt),
        "short.toml");
}

struct Ended {
    Vec3 tip;
    ErrorEstimate estimate;
    std::array<double, 3> hand;  // in the last steps [N]
};

Ended run(double dt, StepTwin::Finer finer, double duration = 0.48)
{
    const Scene scene = short_run(dt, duration);
    World world(make_setup(scene));
    const KeyFrames key_frames(scene);
    StepTwin twin(scene, world, 0);
    std::array<double, 3> hand{};
    for (long k = 0; k < scene.steps(); ++k) {
        REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
        twin.stepped(world, joint_readings(world, 0), k + 1);
        hand = {hand[1], hand[2], world.readings(0).hand_force};
    }
    return {world.rod(0).pos(0), twin.finish(finer), hand};
}

}  // namespace

TEST_SUITE("bands/step_twin")
{
    // Of a scheme of order 1 the error is r/(r - 1) |Q(h) - Q(h/r)|, times Roache's factor 1.5 for two steps of unproven order.
    TEST_CASE("analytic: the tip's band is three times what half the step moves the tip by; forces have no less")
    {
        const double dt = 0.016;
        const Ended whole = run(dt, StepTwin::Finer::Never), halved = run(dt / 2, StepTwin::Finer::Never);
        const ErrorEstimate& e = whole.estimate;
        REQUIRE(e.windows == 1);  // the only window, as the last and as that of the largest forces
        REQUIRE(e.failed == 0);
        const double moved = (whole.tip - halved.tip).norm();
        REQUIRE(moved > 1e-7);
        CHECK(e.tip == about(3 * moved).epsilon(1e-9));  // the same states, but for the rounding of two times
        for (const ErrorBand* band : {&e.hand, &e.hand_peak, &e.friction, &e.friction_peak}) {
            REQUIRE(band->parts == 2);
            CHECK(band->band >= 3 * std::abs(band->value - band->twin) * (1 - 1e-12));
        }
        const double differs = 3 * std::abs(e.hand_peak.value - e.hand_peak.twin);
        REQUIRE(differs > 0.03 * e.hand_peak.value);  // more than what a history leaves, 3 % of the value
        CHECK(e.hand_peak.step == about(differs).epsilon(1e-12));
        CHECK(e.hand_peak.band ==
              about(1.1 * std::hypot(e.hand_peak.step, 1.5 * e.hand_peak.nodes, e.hand_peak.facets)).epsilon(1e-12));
    }

    // 0.355 s are 28 steps of 12.5 ms and one of 5 ms. The force rises to the end, so that the largest mean over 20 ms is that of
    // the last 5 ms, the 12.5 ms before and 2.5 ms of the step before these.
    TEST_CASE("analytic: a largest mean is over 20 ms, whatever the lengths of steps")
    {
        const Ended ended = run(0.0125, StepTwin::Finer::Never, 0.355);
        const auto [oldest, before, last] = ended.hand;
        REQUIRE(last > 1.01 * before);
        REQUIRE(before > oldest);
        CHECK(ended.estimate.hand_peak.value == about((2.5 * oldest + 12.5 * before + 5 * last) / 20).epsilon(1e-12));
    }

    TEST_CASE("analytic: a band from steps of a sixteenth has the factor 1.5 x 16/15")
    {
        const ErrorEstimate e = run(0.012, StepTwin::Finer::Always).estimate;
        REQUIRE(e.finest == 16);
        for (const ErrorBand* band : {&e.hand_peak, &e.friction_peak}) {
            REQUIRE(band->parts == 16);
            REQUIRE(std::abs(band->value - band->twin) > 0);
            CHECK(band->band >= 1.6 * std::abs(band->value - band->twin) * (1 - 1e-12));
        }
    }
}

}  // namespace seldinger::test::test_twin_margin
