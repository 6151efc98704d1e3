// Means over an exact span, of steps of any length.
#include "math/span_means.h"
#include "support/approx.h"

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace seldinger::test::test_span_means {

namespace {

/// Integral of a staircase from the beginning to a time. @param steps  value and length of each
double integral_to(const std::vector<std::pair<double, double>>& steps, double time)
{
    double sum = 0, begin = 0;
    for (const auto& [value, length] : steps) {
        sum += value * std::clamp(time - begin, 0.0, length);
        begin += length;
    }
    return sum;
}

}  // namespace

TEST_SUITE("math/span_means")
{
    TEST_CASE("analytic: steps of 1/60 s have means over 20 ms, not over one step: a step takes 1 and a part of the next")
    {
        SpanMeans means(0.02);
        CHECK(means.mean() == 0);
        means.add(6, 1.0 / 60);
        CHECK_FALSE(means.full());
        CHECK(means.largest() == test::about(6));  // of all that there is
        means.add(0, 1.0 / 60);
        CHECK(means.full());
        CHECK(means.mean() == test::about(6 * (0.02 - 1.0 / 60) / 0.02));  // ends with the second: the last 3.3 ms of the first
        CHECK(means.largest() == test::about(6 * (1.0 / 60) / 0.02));      // begins with the first
    }

    TEST_CASE("property: equal to integrals over the staircase, of all spans that begin or end with a step")
    {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> value(-1, 3), length(1e-4, 0.05);
        std::vector<std::pair<double, double>> steps;
        SpanMeans means(0.02);
        double time = 0, most = -1e9;
        std::vector<double> ends{0};
        for (int k = 0; k < 400; ++k) {
            steps.emplace_back(value(random), k % 3 == 0 ? 0.004 : length(random));
            means.add(steps.back().first, steps.back().second);
            ends.push_back(time += steps.back().second);
            // sums of 400 steps of up to 3 over 10 s, taken from each other: 400 * 30 * 1e-16 over the span
            if (means.full())
                CHECK(means.mean() ==
                      test::about((integral_to(steps, time) - integral_to(steps, time - 0.02)) / 0.02).scale(1).epsilon(1e-10));
        }
        for (const double end : ends) {
            if (end + 0.02 <= time) most = std::max(most, integral_to(steps, end + 0.02) - integral_to(steps, end));
            if (end >= 0.02) most = std::max(most, integral_to(steps, end) - integral_to(steps, end - 0.02));
        }
        CHECK(means.largest() == test::about(most / 0.02).scale(1).epsilon(1e-10));
    }

    TEST_CASE("regression: values below zero have a largest mean below zero, not none")
    {
        SpanMeans means(2);
        for (const double value : {-4.0, -2.0, -6.0}) means.add(value, 1);
        CHECK(means.largest() == -3);
    }
}

}  // namespace seldinger::test::test_span_means
