// The estimate that a run makes of its own step: it leaves the run alone, and its bands hold what a far shorter step finds.
#include "bands/twin_run.h"
#include "support/approx.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <numeric>
#include <string>
#include <vector>

namespace seldinger::test::test_step_twin {

namespace {

/// A wire fed round a bend: contact, friction, a hand that feels both.
Scene bend(double dt, double duration = 1.2)
{
    return read_scene_text(
        fmt::format("[scene]\nduration_s = {}\ndt_s = {}\n"
                    "[wire]\nlength_m = 0.12\nradius_m = 0.0004445\ndensity = 7900.0\nbend_nm2 = 2e-4\ntwist_nm2 = 1.5e-4\n"
                    "stretch_n = 1e4\nnodes = 41\n"
                    "[vessel]\nshape = \"arc\"\nradius_m = 0.004\nbend_radius_m = 0.03\nangle_deg = 90.0\nlead_in_m = 0.02\n"
                    "lead_out_m = 0.05\ntriangles = 6000\n"
                    "[contact]\nmu_static = 0.25\nmu_sliding = 0.2\n"
                    "[feed]\ninlet = \"auto\"\nkeys = [{{ t_s = 0.0, advance_m = 0.0 }}, {{ t_s = 1.2, advance_m = 0.07 }}]\n",
                    duration, dt),
        "bend.toml");
}

struct Told {
    std::string hash;
    double hand_peak = 0;
    ErrorEstimate estimate;
};

Told run(double dt, bool with_twin, StepTwin::Finer finer = StepTwin::Finer::Always, double spend = StepTwin::unlimited)
{
    const Scene scene = bend(dt);
    World world(make_setup(scene));
    const KeyFrames key_frames(scene);
    std::optional<StepTwin> twin;
    if (with_twin) twin.emplace(scene, world, 0, spend);
    Told told;
    std::vector<double> hand;
    for (long k = 0; k < scene.steps(); ++k) {
        REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
        const WireReadings now = joint_readings(world, 0);
        hand.push_back(std::abs(now.hand_force));
        if (twin) twin->stepped(world, now, k + 1);
    }
    if (twin) told.estimate = twin->finish(finer);
    // means over 20 ms, whatever window they lie in
    const auto wide = static_cast<std::size_t>(std::lround(0.02 / dt));
    for (std::size_t k = 0; k + wide <= hand.size(); ++k)
        told.hand_peak = std::max(told.hand_peak, std::accumulate(&hand[k], &hand[k] + wide, 0.0) / static_cast<double>(wide));
    told.hash = world.state_hash();
    return told;
}

}  // namespace

TEST_SUITE("bands/step_twin")
{
    TEST_CASE(
        "property: forces at the end are means over 20 ms, so that steps of 1 and 4 ms agree within what the force changes in "
        "that time")
    {
        struct AtEnd {
            ErrorEstimate estimate;
            double change = 0, change_of_50_steps = 0;  // of the hand force over its last 20 ms and 50 steps [N]
        };
        const auto at_end = [](double dt) {
            const Scene scene = bend(dt, 0.8);  // the tip is in the bend: the force rises
            World world(make_setup(scene));
            const KeyFrames key_frames(scene);
            StepTwin twin(scene, world, 0);
            std::vector<double> hand;
            for (long k = 0; k < scene.steps(); ++k) {
                REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
                const WireReadings now = joint_readings(world, 0);
                hand.push_back(now.hand_force);
                twin.stepped(world, now, k + 1);
            }
            const auto change = [&](double steps) {
                const auto [low, high] = std::minmax_element(hand.end() - std::lround(steps), hand.end());
                return *high - *low;
            };
            return AtEnd{twin.finish(StepTwin::Finer::Never), change(0.02 / dt), change(50)};
        };
        const AtEnd fine = at_end(1e-3), coarse = at_end(4e-3);
        CHECK(fine.estimate.end_seconds == test::about(0.02).epsilon(1e-9));
        CHECK(coarse.estimate.end_seconds == test::about(0.02).epsilon(1e-9));
        CAPTURE(fine.estimate.hand.value);
        CAPTURE(coarse.estimate.hand.value);
        CAPTURE(fine.change);
        REQUIRE(coarse.change_of_50_steps > 4 * fine.change);  // 200 ms at 4 ms: a mean of 50 steps is of another time
        CHECK(std::abs(fine.estimate.hand.value - coarse.estimate.hand.value) <= fine.change);
        CHECK(std::abs(fine.estimate.hand.value - coarse.estimate.hand.value) <= coarse.estimate.hand.band);
        CHECK(std::abs(fine.estimate.friction.value - coarse.estimate.friction.value) <= coarse.estimate.friction.band);
    }

    TEST_CASE("property: a run with a twin has the bits of one without")
    {
        const Told with = run(2e-3, true), without = run(2e-3, false);
        CHECK(with.hash == without.hash);
        CHECK(with.estimate.windows >= 2);
        CHECK(with.estimate.failed == 0);
        CHECK(with.estimate.hand_peak.value <= with.hand_peak * (1 + 1e-12));  // which may lie across two windows
        CHECK(with.estimate.hand_peak.value >= 0.9 * with.hand_peak);
    }

    TEST_CASE(
        "convergence: the largest hand force of a sixteenth of the step is inside the bands, which are no wider than a tenth")
    {
        const Told coarse = run(8e-3, true), fine = run(2e-3, true), true_one = run(5e-4, false);
        REQUIRE(true_one.hand_peak > 0.01);  // something is felt
        for (const Told* told : {&coarse, &fine}) {
            CAPTURE(told->hand_peak);
            CAPTURE(told->estimate.hand_peak.band);
            CHECK(std::abs(told->hand_peak - true_one.hand_peak) <= told->estimate.hand_peak.band);
        }
        // and it says something: a band that is as wide as the value would hold anything
        CHECK(coarse.estimate.hand_peak.band < 0.1 * coarse.hand_peak);
        CHECK(fine.estimate.hand_peak.band <= coarse.estimate.hand_peak.band * 1.1);
    }

    // 1,200 steps of 1 ms: three windows of 20 at half the step are 120, a tenth. Of 150 steps of 8 ms the end alone, 12 to 23 of
    // them at half the step or a quarter, is all.
    TEST_CASE("property: with a limit twins take that part of the run's steps, or the last window, and the bands hold")
    {
        const Told true_one = run(2.5e-4, false);
        for (const double dt : {8e-3, 1e-3}) {
            CAPTURE(dt);
            const Told limited = run(dt, true, StepTwin::Finer::WhereCheap, 0.1);
            const long steps = std::lround(1.2 / dt), last = std::max(12L, std::lround(0.02 / dt));
            CHECK(limited.hash == run(dt, false).hash);
            CHECK(limited.estimate.windows >= 1);
            CHECK(limited.estimate.steps <= std::max(steps / 10, 4 * 2 * last));
            CHECK(std::abs(limited.hand_peak - true_one.hand_peak) <= limited.estimate.hand_peak.band);
            CHECK(limited.estimate.hand_peak.resolved);
            CHECK(limited.estimate.hand_peak.band < 0.15 * limited.hand_peak);
        }
    }

    TEST_CASE(
        "property: the largest forces have a twin of a quarter of a millisecond, at most a sixteenth of the step, where asked "
        "for or cheap")
    {
        // 150 steps; 16 parts of 100 steps would be ten times as many
        CHECK(run(8e-3, true, StepTwin::Finer::Always).estimate.finest == 16);
        CHECK(run(8e-3, true, StepTwin::Finer::WhereCheap).estimate.finest == 2);
        CHECK(run(2e-3, true, StepTwin::Finer::Always).estimate.finest == 8);
        CHECK(run(2e-3, true, StepTwin::Finer::Never).estimate.finest == 2);
    }

    // A band by the step is 1.5 times what the run is believed to be off by, one by nodes sqrt(3) times. A warning says that this
    // is more than a third and 1 mN; not that the band is.
    TEST_CASE(
        "property: what is believed to be off by more than a third is said, the force on a patch too; what only the band's "
        "safety has there is not")
    {
        const auto said_of = [](ErrorBand ErrorEstimate::*reading, double value, double band) {
            ErrorEstimate estimate;
            ErrorBand& made = estimate.*reading;
            made.value = made.twin = value;
            made.step = made.band = band;
            made.resolved = made.is_resolved();
            return unresolved(estimate).size();
        };
        for (const auto reading : {&ErrorEstimate::hand, &ErrorEstimate::hand_peak, &ErrorEstimate::friction,
                                   &ErrorEstimate::friction_peak, &ErrorEstimate::patch}) {
            CHECK(said_of(reading, 0.1, 0.049) == 0);
            CHECK(said_of(reading, 0.1, 0.051) == 1);
            CHECK(said_of(reading, 1e-3, 1.4e-3) == 0);
            CHECK(said_of(reading, 1e-3, 1.6e-3) == 1);
        }
    }

    // A mode that relaxes in tau is off by h t/(2 tau^2) exp(-t/tau) of its end by backward Euler: after 0.4 s and tissue of
    // 0.02 s, 1e-6 at 1 ms
    TEST_CASE("analytic: of a wall at rest under its load, the step's share of the displacement is none")
    {
        const Scene scene = read_scene_text(
            "[scene]\nduration_s = 0.4\ndt_s = 1e-3\n"
            "[wire]\nlength_m = 0.02\nradius_m = 0.0004445\ndensity = 7900.0\nbend_nm2 = 2e-4\ntwist_nm2 = 1.5e-4\n"
            "stretch_n = 1e4\nnodes = 5\n[wire.place]\nshape = \"straight\"\nbase = [0.0, 0.0, 0.02]\n"
            "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nspin = true\n"
            "[vessel]\nshape = \"plane\"\nsize_m = 0.04\ntriangles = 200\nwall = \"elastic\"\nwall_edge_m = 0.005\n"
            "[[wall_load]]\nat = [0.0, 0.0, 0.0]\nforce_n = [0.0, 0.0, -0.02]\n",
            "rest.toml");
        World world(make_setup(scene));
        StepTwin twin(scene, world, 0);
        const KeyFrames key_frames(scene);
        Output now;
        for (long k = 0; k < scene.steps(); ++k) {
            REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
            world.read(now, Output::WallUnder);
            const WallReadings& wall = now.walls[0].readings;
            twin.stepped(world, joint_readings(world, 0), k + 1, {0, wall.move_max, wall.stress_max});
        }
        const ErrorEstimate estimate = twin.finish(StepTwin::Finer::Never);
        const double moved = world.wall_readings().move_max;
        CHECK(moved > 1e-5);
        CHECK(estimate.wall_known);
        CHECK(estimate.wall_move < 1e-3 * moved);
    }

    TEST_CASE("analytic: of a share by nodes, the root mean square of an error that is as likely anywhere within it")
    {
        ErrorBand band{0.1, 0.1};
        band.nodes = 0.057;  // 0.1/sqrt(3) = 0.0577
        CHECK(band.is_resolved());
        band.nodes = 0.058;
        CHECK_FALSE(band.is_resolved());
    }

    TEST_CASE(
        "property: a force on a patch is believed to be off by what its twin differs by, and its band has the factor for order 1")
    {
        const ErrorBand patch = run_with_twin(bend(8e-3)).patch;
        const double differs = std::abs(patch.twin - patch.value);
        REQUIRE(differs > 1e-4 * patch.value);
        CHECK(patch.step_part * patch.step == test::about(differs).epsilon(1e-12));
        CHECK(patch.step >= 3 * differs * (1 - 1e-12));
        CHECK(patch.expected() ==
              test::about(std::hypot(differs, bands::usual * patch.nodes, bands::usual * patch.facets))
                  .epsilon(1e-12));
    }

    TEST_CASE(
        "analytic: the largest fall of a force is a strike's height; a rise has none, and what falls slowly has what it falls by "
        "within the time")
    {
        const auto fall_of = [](auto&& force) {
            LargestFall fall(0.02);
            for (int k = 0; k < 200; ++k) fall.add(force(k), 1e-3);
            return fall.largest();
        };
        CHECK(fall_of([](int k) { return 0.1 * k; }) == 0);
        CHECK(fall_of([](int k) { return k == 77 ? 5.0 : 0.01 * k; }) == test::about(5.0 - 0.78).epsilon(1e-12));
        CHECK(fall_of([](int k) { return 100 - 0.1 * k; }) == test::about(2.0).epsilon(1e-9));
    }

    TEST_CASE("property: what the step does not resolve is said, with both values")
    {
        ErrorEstimate estimate;
        estimate.dt = 0.0167;
        estimate.hand_peak = {17.9, 9.0, 26.7, false};
        estimate.hand_peak.step = 26.7;
        estimate.friction = {0.4, 0.39, 0.03, true};
        const auto said = unresolved(estimate);
        REQUIRE(said.size() == 1);
        CHECK(said[0].find("17.9 N") != std::string::npos);
        CHECK(said[0].find("16.7 ms") != std::string::npos);
        CHECK(said[0].find("scene.dt_s") != std::string::npos);
    }
}

}  // namespace seldinger::test::test_step_twin
