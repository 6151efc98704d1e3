// The bound of a largest force where something that held lets go.
#include "bands/force_watch.h"
#include "support/approx.h"

#include <cmath>

namespace seldinger::test::test_release_watch {

namespace {

constexpr double dt = 0.001, mean_time = 0.02;  // [s]

/// Rises to 0.1 N at a rate [N/s], then stands at a level.
ReleaseWatch after_a_rise(double rate, double then)
{
    ReleaseWatch watch(mean_time);
    for (int k = 0; k * dt * rate < 0.1; ++k) watch.add(k * dt * rate, dt);
    for (int k = 0; k < 1000; ++k) watch.add(then, dt);
    return watch;
}

}  // namespace

TEST_SUITE("bands/release_watch")
{
    TEST_CASE("analytic: a force that climbs and lets go is uncertain by its rate times the time of release")
    {
        // means of a straight rise are a straight rise: exact but for rounding
        CHECK(after_a_rise(0.5, 0.02).bound() == test::about(0.5 * ReleaseWatch::release_time).epsilon(1e-9));
        CHECK(after_a_rise(0.05, 0.02).bound() == test::about(0.05 * ReleaseWatch::release_time).epsilon(1e-9));
    }

    TEST_CASE("property: what climbs and stays, or gives way by less than a fifth, has not let go")
    {
        CHECK(after_a_rise(0.5, 0.1).bound() == 0);
        CHECK(after_a_rise(0.5, 0.085).bound() == 0);
        CHECK(after_a_rise(0.5, 0.075).bound() > 0);
    }

    TEST_CASE("property: the bound is that of the largest force, a smaller release later leaves it")
    {
        ReleaseWatch watch = after_a_rise(0.05, 0.02);
        const double before = watch.bound();
        for (int k = 0; k < 60; ++k) watch.add(0.02 + 1e-3 * k, dt);  // fast, to 0.08 N
        for (int k = 0; k < 200; ++k) watch.add(0.01, dt);
        CHECK(watch.bound() == before);
    }

    TEST_CASE("property: a force that falls slowly has not let go")
    {
        ReleaseWatch watch(mean_time);
        for (int k = 0; k < 3000; ++k) watch.add(0.1 - 0.05 * std::abs(k * dt - 1), dt);  // 5 mN in 0.1 s
        CHECK(watch.bound() == 0);
    }
}

}  // namespace seldinger::test::test_release_watch
