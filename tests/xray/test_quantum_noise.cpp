// Random words against published vectors, Poisson numbers against the distribution, fast functions against the library's.
#include "xray/pixel_math.h"
#include "xray/quantum_noise.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace seldinger::test::test_quantum_noise {

namespace {

/// Sorted numbers of photons that pixels of this mean draw.
std::vector<double> drawn_counts(double mean, int size)
{
    Exposure e;
    e.resize(size, size);
    const double photons = 2 * mean;
    e.signal.assign(e.signal.size(), 0.5f), e.second = e.signal;
    std::vector<double> counts;
    std::vector<float> row(size);
    for (int k = 0; k < size; ++k) {
        draw_noisy_row(e, k, {photons, 11, 5}, row.data());
        for (const float s : row) counts.push_back(s * photons);
    }
    std::sort(counts.begin(), counts.end());
    return counts;
}

}  // namespace

TEST_SUITE("xray/quantum_noise")
{
    TEST_CASE("analytic: random words are the published ones of Philox 4x32-10")
    {
        // known answers that come with the authors' Random123
        CHECK(random_words({0, 0, 0, 0}, 0, 0) == RandomWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
        CHECK(random_words({~0u, ~0u, ~0u, ~0u}, ~0u, ~0u) == RandomWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
        CHECK(random_words({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0xa4093822, 0x299f31d0) ==
              RandomWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
    }

    TEST_CASE("analytic: photons are spread as Poisson's law says on both sides of where they are drawn exactly")
    {
        const int size = 1000;
        for (const double mean : {20.0, 63.0, 65.0, 300.0, 1e4}) {
            const std::vector<double> counts = drawn_counts(mean, size);
            // where the law is above a millionth, cumulated: share of draws below k + 1/2
            double law = 0, worst = 0;
            for (int k = 0; k < mean + 8 * std::sqrt(mean); ++k) {
                law += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1.0));
                const auto below = std::upper_bound(counts.begin(), counts.end(), k + 0.5) - counts.begin();
                worst = std::max(worst, std::abs(static_cast<double>(below) / counts.size() - law));
            }
            CAPTURE(mean);
            // a million draws: Kolmogorov's distance is under 2.2/1000 but once in 30,000 times
            CHECK(worst < 2.2e-3);
        }
    }

    TEST_CASE("analytic: mean, variance and skewness from 64 photons on")
    {
        for (const double mean : {64.5, 1e3, 1e5}) {
            const std::vector<double> counts = drawn_counts(mean, 1000);
            const double n = static_cast<double>(counts.size());
            double sum = 0, square = 0, cube = 0;
            for (const double c : counts) {
                const double z = (c - mean) / std::sqrt(mean);
                sum += z / n, square += z * z / n, cube += z * z * z / n;
            }
            CAPTURE(mean);
            // a million draws: one sigma is 0.001, 0.0014 and 0.0039
            CHECK(std::abs(sum) < 0.004);
            CHECK(std::abs(square - 1) < 0.0056);
            CHECK(std::abs(cube - 3 * sum - 1 / std::sqrt(mean)) < 0.012);  // 1/sqrt(M) is 0.12 at 64
        }
    }

    TEST_CASE("property: where nothing arrives there is no noise")
    {
        Exposure e;
        e.resize(5, 1);
        std::vector<float> row(5, 7.0f);
        draw_noisy_row(e, 0, {1e5, 1, 1}, row.data());
        for (const float s : row) CHECK(s == 0);
    }

    TEST_CASE("analytic: exponential, logarithm, sine and cosine have the errors that they say")
    {
        for (float x = -19.4f; x < 87; x += 0.00713f)
            CHECK(std::abs(exp_minus(x) / std::exp(-static_cast<double>(x)) - 1) < 3e-7 + 1e-7 * std::abs(x));
        for (float x = 1e-12f; x < 1e12f; x *= 1.0071f) {
            const double exact = std::log(static_cast<double>(x));
            CHECK(std::abs(log_of(x) - exact) < 2e-7 * std::max(1.0, std::abs(exact)));
        }
        for (int k = -5000; k <= 5000; ++k) {
            const float t = static_cast<float>(k) / 10000;
            float sine, cosine;
            sine_cosine_turns(t, sine, cosine);
            CHECK(std::abs(sine - std::sin(2 * std::numbers::pi * t)) < 1e-6);
            CHECK(std::abs(cosine - std::cos(2 * std::numbers::pi * t)) < 1e-6);
        }
    }
}

}  // namespace seldinger::test::test_quantum_noise
