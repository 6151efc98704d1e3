// Means over the last 20 ms: spans, parts of steps, steps shorter than a slot.
#include "math/end_mean.h"
#include "support/approx.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_end_mean {

namespace {

/// A force that rises by 1 N/s; friction is twice that. @return after `duration`
EndMean::Mean ramp(double dt, double duration)
{
    EndMean mean;
    const long steps = std::lround(duration / dt);
    for (long k = 1; k <= steps; ++k) mean.add(dt * static_cast<double>(k), 2 * dt * static_cast<double>(k), dt);
    return mean.mean();
}

}  // namespace

TEST_SUITE("math/end_mean")
{
    // The step that ends at t has the force t all through it: the mean over 20 ms of a ramp is that 10 ms before the end, and
    // half a step after, but for the oldest step, of which the mean takes a part p and the later one. Slots of several steps take
    // theirs evenly: off by less than the square of a slot's time over 20 ms.
    TEST_CASE("analytic: the mean of a ramp is over 20 ms, for steps of any length")
    {
        for (const double dt : {1e-5, 7e-5, 1e-4, 2.5e-4, 1e-3, 3e-3, 4e-3, 8e-3, 1.0 / 60}) {
            CAPTURE(dt);
            const EndMean::Mean mean = ramp(dt, 1.2);
            CHECK(mean.seconds == test::about(EndMean::span).epsilon(1e-9));
            const double last = dt * static_cast<double>(std::lround(1.2 / dt));
            double sum = 0, left = EndMean::span;
            for (double end = last; left > 1e-12; end -= dt) sum += end * std::min(dt, left), left -= dt;
            const double slot = EndMean::slot_time + dt;
            CHECK(std::abs(mean.hand - sum / EndMean::span) <=
                  1e-9 + (dt < EndMean::slot_time ? slot * slot / EndMean::span : 0));
            CHECK(mean.friction == test::about(2 * mean.hand).epsilon(1e-9));
        }
    }

    TEST_CASE("property: a step longer than the span counts alone, a short run as a whole, none as nothing, a pull as negative")
    {
        CHECK(ramp(0.05, 1).seconds == test::about(EndMean::span));
        CHECK(ramp(0.05, 1).hand == test::about(1.0));
        CHECK(ramp(1e-3, 5e-3).seconds == test::about(5e-3));
        CHECK(ramp(1e-3, 5e-3).hand == test::about(3e-3));
        CHECK(EndMean{}.mean().seconds == 0);
        EndMean pull;
        pull.add(-2, 1, 1e-3);
        CHECK(pull.mean().hand == test::about(-2));
        CHECK(pull.is_sound());
        EndMean stray = pull;
        stray.time[64] = 1e-3;  // no step before or after it
        CHECK_FALSE(stray.is_sound());
        stray = pull;
        stray.hand[5] = 1e-300;  // a force without time
        CHECK_FALSE(stray.is_sound());
        pull.last = EndMean::slots;
        CHECK_FALSE(pull.is_sound());
    }
}

}  // namespace seldinger::test::test_end_mean
