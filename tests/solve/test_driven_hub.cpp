// The equation of a hub that a force drives (D16), with an instrument that answers by a formula.
#include "solve/driven_hub.h"

#include "support/approx.h"

#include <cmath>
#include <functional>
#include <limits>

namespace seldinger::test::test_driven_hub {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

/// An instrument whose answer depends on the way of its hub alone.
struct Instrument {
    std::function<double(double)> answer = [](double) { return 0.0; }, stiffness = [](double) { return 0.0; };
};

struct Ride {
    HubState hub;
    double way = 0;
    int most_trials = 0;
};

/// @param force  at time t [N]
Ride ride(const HubSpec& spec, const std::function<double(double)>& force, double h, int steps, const Instrument& on = {},
          double low = -endless, double high = endless, double speed = 0)
{
    Ride r;
    r.hub.speed = speed;
    for (int k = 1; k <= steps; ++k) {
        HubEquation equation(spec, r.hub, force(k * h), 0, h, low - r.way, high - r.way);
        HubEquation::Answer now{equation.first(), 0, 0};
        for (int trial = 1;; ++trial) {
            now.force = on.answer(r.way + now.at);
            now.stiffness = on.stiffness(r.way + now.at);
            r.most_trials = std::max(r.most_trials, trial);
            if (std::abs(equation.rest(now.at, now.force)) < 1e-9) break;
            const double next = equation.next(now);
            if (equation.closed()) break;
            REQUIRE(trial < 60);
            now.at = next;
        }
        r.hub = equation.after(now, 0);
        r.way += now.at;
    }
    return r;
}

double constant(double /*t*/) { return 0.3; }

}  // namespace

TEST_SUITE("solve/driven hub")
{
    // v_n = n h F/m, x_n = h^2 F/m n (n + 1)/2: backward Euler's own
    TEST_CASE("analytic: a mass alone is pushed by a constant force")
    {
        const HubSpec hub{0.05};
        const Ride r = ride(hub, constant, 1e-3, 200);
        CHECK(r.hub.speed == about(0.2 * 0.3 / 0.05).epsilon(1e-12));
        CHECK(r.way == about(1e-6 * 0.3 / 0.05 * 200 * 201 / 2).epsilon(1e-12));
        CHECK(r.most_trials == 1);
        const HubReadings& e = r.hub.readings;
        CHECK(e.work == about(0.3 * r.way).epsilon(1e-12));
        CHECK(e.kinetic == about(0.5 * 0.05 * r.hub.speed * r.hub.speed).epsilon(1e-12));
        CHECK(std::abs(e.open()) < 1e-12 * e.work);
    }

    // v = F/c (1 - exp(-t/T)), T = m/c; backward Euler misses h t/(2 T^2) exp(-t/T) F/c: 1.6e-3 of it
    TEST_CASE("analytic: a mass with a damper goes towards F/c, with an error in first order of the step")
    {
        const HubSpec hub{0.05, 0.5};
        const double end = 0.2, exact = 0.3 / 0.5 * (1 - std::exp(-0.5 * end / 0.05));
        const double coarse = ride(hub, constant, 2e-3, 100).hub.speed - exact;
        const double fine = ride(hub, constant, 1e-3, 200).hub.speed - exact;
        CHECK(std::abs(fine) < 2e-3 * exact);
        CHECK(coarse / fine == about(2).epsilon(0.02));
        CHECK(std::abs(ride(hub, constant, 2e-3, 100).hub.readings.open()) < 1e-12);
    }

    // F = r t, friction f: at rest until f/r, then m x = r tau^3/6, of which backward Euler misses 3 h/tau: 1.5 %
    TEST_CASE("analytic: dry friction holds a hub, to the last bit, until the force exceeds it")
    {
        const HubSpec hub{0.05, 0, 0.1};
        const auto ramp = [](double t) { return 0.5 * t; };
        const Ride stuck = ride(hub, ramp, 1e-3, 199);
        CHECK(stuck.way == 0);
        CHECK(stuck.hub.readings.friction == 0);
        const double exact = 0.5 * std::pow(0.2, 3) / 6 / 0.05;
        const double coarse = ride(hub, ramp, 2e-3, 200).way - exact, fine = ride(hub, ramp, 1e-3, 400).way - exact;
        CHECK(std::abs(fine) < 0.02 * exact);
        CHECK(coarse / fine == about(2).epsilon(0.02));
        const HubReadings e = ride(hub, ramp, 1e-3, 400).hub.readings;
        CHECK(e.friction == about(0.1 * (exact + fine)).epsilon(1e-12));
        CHECK(std::abs(e.open()) < 1e-12);
    }

    // m v^2/2 = f x: friction stops it and does not push it back
    TEST_CASE("analytic: friction brings a hub to rest after m v^2/(2 f)")
    {
        const HubSpec hub{0.05, 0, 0.1};
        const auto none = [](double) { return 0.0; };
        const Ride r = ride(hub, none, 1e-4, 3000, {}, -endless, endless, 0.4);
        CHECK(r.hub.speed == 0);
        CHECK(r.way == about(0.05 * 0.16 / 0.2).epsilon(1e-3));
    }

    TEST_CASE("property: a light hub on a stiff instrument stands where that answers the force, at any step, and never swings")
    {
        constexpr double stiffness = 1e6;
        const Instrument spring{[](double x) { return stiffness * x; }, [](double) { return stiffness; }};
        for (const double h : {1e-5, 1e-3, 1.0}) {
            double last = 0;
            for (int steps = 1; steps < 60; steps += 7) {
                const double way = ride({1e-9}, constant, h, steps, spring).way;
                CHECK(way >= last);
                CHECK(way <= 0.3 / stiffness * (1 + 1e-6));
                last = way;
            }
            CHECK(last == about(0.3 / stiffness).epsilon(1e-6));
        }
    }

    // an answer that stiffens, and one that jumps: 0 before a wall of 5 N
    TEST_CASE("property: trials of both signs enclose the solution where Newton's method alone would not get there")
    {
        const Instrument cubic{[](double x) { return 1e9 * x * x * x; }, [](double x) { return 3e9 * x * x; }};
        const Ride stiffens = ride({1e-4, 2.0}, constant, 1e-2, 400, cubic);
        CHECK(stiffens.way == about(std::cbrt(0.3 / 1e9)).epsilon(1e-4));
        CHECK(stiffens.most_trials <= 12);
        const Instrument jump{[](double x) { return x < 1e-3 ? 0.0 : 5.0; }, [](double) { return 0.0; }};
        const Ride jumps = ride({1e-3}, constant, 1e-3, 100, jump);
        CHECK(jumps.way == about(1e-3).epsilon(1e-6));
        CHECK(jumps.most_trials <= 40);
    }

    TEST_CASE("property: at the end of its way a hub stops, and what it brought along is lost")
    {
        const Ride r = ride({0.05}, constant, 1e-3, 400, {}, 0, 0.02);
        CHECK(r.way == about(0.02).epsilon(1e-14));
        CHECK(r.hub.speed == 0);
        const HubReadings& e = r.hub.readings;
        CHECK(e.work == about(0.3 * 0.02).epsilon(1e-12));
        CHECK(e.stopped + e.scheme == about(e.work).epsilon(1e-12));
        CHECK(std::abs(e.open()) < 1e-15);
    }

    // F_0 - S u: what a spring to a hand that stands still pulls with at the end of the step
    TEST_CASE("analytic: a spring to a hand is taken at the end of the step")
    {
        HubState hub;
        const HubEquation equation({0.02, 0.1}, hub, 0.3, 500, 1e-3, -endless, endless);
        const double u = equation.first();
        CHECK(u == about(0.3 / (0.02 / 1e-6 + 0.1 / 1e-3 + 500)).epsilon(1e-13));
        CHECK(std::abs(equation.rest(u, 0)) < 1e-15);
        CHECK(equation.after({u, 0, 0}, 0).readings.force == about(0.3 - 500 * u).epsilon(1e-13));
    }
}

}  // namespace seldinger::test::test_driven_hub
