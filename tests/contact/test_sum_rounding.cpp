// What sums of forces may differ by: the rounding of as many additions as there are samples, and not ten times that.
#include "contact/contact_sums.h"

#include <doctest/doctest.h>

#include <limits>

namespace seldinger::test::test_sum_rounding {

TEST_SUITE("contact/contact_sums")
{
    // Adding n numbers of one sign in any order is off by n rounding errors at most, so two such sums by 2 n.
    TEST_CASE(
        "analytic: sums that differ as two orders of addition may are equal, and those that differ by four times that are not")
    {
        for (const bool float32 : {false, true})
            for (const std::size_t samples : {1, 50, 3000}) {
                CAPTURE(float32);
                CAPTURE(samples);
                const double epsilon =
                    float32 ? static_cast<double>(std::numeric_limits<float>::epsilon()) : std::numeric_limits<double>::epsilon();
                const double two_orders = 2 * static_cast<double>(samples) * epsilon;
                ContactTotals totals;
                totals.normal = 0.7, totals.friction = 0.2;
                for (const double sign : {-1.0, 1.0}) {
                    CHECK(add_up(0.7 * (1 + sign * two_orders), 0.2, samples, totals, float32));
                    CHECK(add_up(0.7, 0.2 * (1 + sign * two_orders), samples, totals, float32));
                    const double off = 4 * 2 * static_cast<double>(samples + 1) * epsilon;
                    CHECK_FALSE(add_up(0.7 * (1 + sign * off), 0.2, samples, totals, float32));
                    CHECK_FALSE(add_up(0.7, 0.2 * (1 + sign * off), samples, totals, float32));
                }
            }
    }
}

}  // namespace seldinger::test::test_sum_rounding
