// Pictures of what arrives: noise, blur and grey levels.
#include "core/parallel.h"
#include "support/approx.h"
#include "xray/detector.h"
#include "xray/spectrum.h"

#include <cmath>

namespace seldinger::test::test_detector {

namespace {

/// A beam that this exponent has weakened evenly over its energies.
Exposure even_exposure(const std::vector<SpectrumLine>& beam, int size, double through)
{
    double energy = 0, square = 0, share = 0;
    for (const SpectrumLine& line : beam) {
        energy += line.photons * line.energy;
        square += line.signal * line.energy;
        share += line.signal;
    }
    Exposure e;
    e.resize(size, size);
    e.signal.assign(e.signal.size(), static_cast<float>(share * through));
    e.second.assign(e.second.size(), static_cast<float>(square / energy * through));
    return e;
}

struct Moments {
    double mean = 0, variance = 0;
};

Moments moments_of(const std::vector<float>& values)
{
    const double count = static_cast<double>(values.size());
    Moments m;
    for (const float v : values) m.mean += v / count;
    for (const float v : values) m.variance += (v - m.mean) * (v - m.mean) / (count - 1);
    return m;
}

}  // namespace

TEST_SUITE("xray/detector")
{
    TEST_CASE(
        "analytic: the variance of the noise is the theory's within 2 %, for one energy and for several, few photons and many")
    {
        for (const bool one : {true, false})
            for (const double photons : {40.0, 3e3, 3e4, 1e7}) {
                const auto beam = one ? single_energy(60) : tube_spectrum(75);
                const double through = 0.1;
                const Exposure e = even_exposure(beam, 400, through);
                // photons of energy E: mean n, signal n E, variance n E^2 (over the open beam's mean signal, squared)
                double mean = 0, variance = 0, open = 0;
                for (const SpectrumLine& line : beam) open += line.photons * line.energy;
                for (const SpectrumLine& line : beam) {
                    const double n = photons * line.photons * through;
                    mean += n * line.energy / (photons * open);
                    variance += n * line.energy * line.energy / (photons * photons * open * open);
                }
                Detector detector({photons, 0, 7});
                const Moments got = moments_of(detector.read(e, 3));
                CAPTURE(one);
                CAPTURE(photons);
                // 160,000 pixels: one sigma of the mean is a four hundredth of the spread, one of the variance 0.35 %
                CHECK(std::abs(got.mean - mean) < 4 * std::sqrt(variance) / 400 + 1e-6 * mean);
                CHECK(got.variance == test::about(variance).epsilon(0.02));
            }
    }

    TEST_CASE("property: pixels and frames are independent of one another")
    {
        const Exposure e = even_exposure(single_energy(60), 400, 0.1);
        Detector detector({1e5, 0, 7});
        const std::vector<float> now = detector.read(e, 3), next = detector.read(e, 4);
        const Moments m = moments_of(now);
        const auto correlation = [&](const std::vector<float>& other, std::size_t shift) {
            double sum = 0;
            for (std::size_t k = 0; k + shift < now.size(); ++k) sum += (now[k] - m.mean) * (other[k + shift] - m.mean);
            return sum / static_cast<double>(now.size()) / m.variance;
        };
        // one sigma is 1/400; a row's generator gives four pixels a quarter of the row apart
        for (const std::size_t shift : {1, 2, 100, 200, 300, 400}) CHECK(std::abs(correlation(now, shift)) < 0.0125);
        for (const std::size_t shift : {0, 1, 100}) CHECK(std::abs(correlation(next, shift)) < 0.0125);
    }

    TEST_CASE("property: the same seed and frame make the same picture on any threads, another seed or frame another")
    {
        const Exposure e = even_exposure(tube_spectrum(75), 67, 0.5);
        const auto read = [&](std::uint64_t seed, std::uint64_t frame) {
            Detector detector({1000, 0.7, seed});
            (void)detector.read(e, 99);
            return detector.read(e, frame);
        };
        const std::vector<float> first = read(1, 2);
        set_thread_count(1);
        CHECK(read(1, 2) == first);
        set_thread_count(0);
        CHECK(read(2, 2) != first);
        CHECK(read(1, 3) != first);
    }

    TEST_CASE("analytic: blur keeps the sum and has its width, along rows and across")
    {
        Exposure point;
        point.resize(101, 101);
        point.signal[50 * 101 + 50] = point.second[50 * 101 + 50] = 1;
        Detector detector({1, 2.5, 0});
        const std::vector<float>& picture = detector.read(point, std::nullopt);
        double sum = 0, along = 0, across = 0;
        for (int row = 0; row < 101; ++row)
            for (int x = 0; x < 101; ++x) {
                const double value = picture[row * 101 + x];
                sum += value, along += value * (x - 50.0) * (x - 50.0), across += value * (row - 50.0) * (row - 50.0);
            }
        CHECK(sum == test::about(1).epsilon(1e-5));
        CHECK(std::sqrt(along) == test::about(2.5).epsilon(0.01));  // cut off at 4 standard deviations
        CHECK(std::sqrt(across) == test::about(2.5).epsilon(0.01));
    }

    TEST_CASE("property: blur leaves an even picture as it is to its edges, and none is none")
    {
        const Exposure e = even_exposure(single_energy(60), 33, 0.3);
        Detector blurred({1, 20, 0}), plain({1, 0, 0});
        for (const float s : blurred.read(e, std::nullopt)) CHECK(s == test::about(0.3).epsilon(1e-6));
        CHECK(plain.read(e, std::nullopt) == e.signal);
    }

    TEST_CASE("analytic: grey levels are 12 bits, linear or logarithmic, and a subtraction of equals is the middle")
    {
        const std::vector<float> signal = {0.0f, 0.01f, 0.02f, 1.0f};
        const auto linear = grey_levels(signal, 0.02, false), log = grey_levels(signal, 0.02, true);
        CHECK(linear[0] == 0);
        CHECK(linear[2] == reference_grey);
        CHECK(linear[1] == reference_grey / 2);
        CHECK(linear[3] == most_grey);
        CHECK(log[1] == std::lround(reference_grey - grey_per_neper * std::log(2.0)));
        CHECK(subtracted_levels(signal, signal)[1] == 2048);
    }
}

}  // namespace seldinger::test::test_detector
