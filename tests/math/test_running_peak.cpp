// The largest mean of so many values in a row.
#include "math/running_peak.h"

#include <doctest/doctest.h>

namespace test_running_peak {

using namespace seldinger;

TEST_SUITE("math/running_peak")
{
    TEST_CASE("analytic: the largest of the means of three in a row; of fewer values the mean of all")
    {
        RunningPeak peak(3);
        CHECK(peak.value() == 0);
        peak.add(6);
        CHECK(peak.value() == 6);
        peak.add(0);
        CHECK(peak.value() == 3);
        for (const double value : {0.0, 0.0, 9.0, 3.0, 0.0, 0.0}) peak.add(value);
        CHECK(peak.value() == 4);  // 0 9 3, and 9 3 0
    }

    TEST_CASE("regression: values below zero have a largest mean below zero, not none")
    {
        RunningPeak peak(2);
        for (const double value : {-4.0, -2.0, -6.0}) peak.add(value);
        CHECK(peak.value() == -3);
    }
}

}  // namespace test_running_peak
