// Poisson numbers, blur and grey levels.
#include "view/xray/detector.h"

#include "core/check.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

std::uint64_t mixed(std::uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

/// In (0, 1).
double uniform(std::uint64_t& stream)
{
    stream += 0x9e3779b97f4a7c15ull;
    return (static_cast<double>(mixed(stream) >> 11) + 0.5) * 0x1p-53;
}

/// ln k!: table below 10, Stirling's series beyond (error under 1e-11).
double log_factorial(double k)
{
    static constexpr double table[] = {0,
                                       0,
                                       0.6931471805599453,
                                       1.791759469228055,
                                       3.1780538303479458,
                                       4.787491742782046,
                                       6.579251212010101,
                                       8.525161361065415,
                                       10.60460290274525,
                                       12.801827480081469};
    if (k < 10) return table[static_cast<int>(k)];
    const double x = k + 1, y = 1 / (x * x);
    return (x - 0.5) * std::log(x) - x + 0.9189385332046727 + (1.0 / 12 - y * (1.0 / 360 - y * (1.0 / 1260 - y / 1680))) / x;
}

double draw_large(double mean, std::uint64_t& stream)
{
    const double b = 0.931 + 2.53 * std::sqrt(mean), a = -0.059 + 0.02483 * b;
    const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
    for (;;) {
        const double u = uniform(stream) - 0.5, v = uniform(stream), us = 0.5 - std::abs(u);
        const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
        if (us >= 0.07 && v <= v_r) return k;
        if (k < 0 || (us < 0.013 && v > us)) continue;
        if (std::log(v * inverse_alpha / (a / (us * us) + b)) <= -mean + k * std::log(mean) - log_factorial(k)) return k;
    }
}

}  // namespace

double draw_poisson(double mean, std::uint64_t& stream)
{
    if (!(mean > 0)) return 0;
    if (mean >= 12) return draw_large(mean, stream);
    const double floor = std::exp(-mean);
    double k = 0;
    for (double product = uniform(stream); product > floor; product *= uniform(stream)) ++k;
    return k;
}

std::uint64_t noise_stream(std::uint64_t seed, std::uint64_t frame, std::uint64_t pixel)
{
    return mixed(mixed(mixed(seed + 0x9e3779b97f4a7c15ull) + frame) + pixel);
}

void add_quantum_noise(Exposure& exposure, double photons, std::uint64_t seed, std::uint64_t frame)
{
    SEL_ASSERT(exposure.signal.size() == exposure.second.size());
    for_each_item(exposure.rows, 4, [&](int row) {
        for (int x = 0; x < exposure.columns; ++x) {
            const auto i = static_cast<std::size_t>(row) * exposure.columns + x;
            const double m = exposure.signal[i];
            if (!(m > 0)) continue;
            const double gain = exposure.second[i] / m;  // g over the mean energy of a photon of the open beam
            std::uint64_t stream = noise_stream(seed, frame, i);
            exposure.signal[i] = static_cast<float>(gain * draw_poisson(photons * m / gain, stream) / photons);
        }
    });
}

void blur_picture(std::vector<float>& picture, int columns, int rows, double pixels)
{
    if (pixels < 0.05) return;
    const int reach = static_cast<int>(std::ceil(4 * pixels));
    std::vector<float> weight(2 * reach + 1);
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) sum += std::exp(-0.5 * k * k / (pixels * pixels));
    for (int k = -reach; k <= reach; ++k)
        weight[k + reach] = static_cast<float>(std::exp(-0.5 * k * k / (pixels * pixels)) / sum);
    std::vector<float> across(picture.size());
    for_each_item(rows, 8, [&](int row) {
        std::vector<float> line(columns + 2 * reach);
        const float* in = picture.data() + static_cast<std::size_t>(row) * columns;
        for (int x = 0; x < columns + 2 * reach; ++x) line[x] = in[std::clamp(x - reach, 0, columns - 1)];
        float* out = across.data() + static_cast<std::size_t>(row) * columns;
        for (int k = 0; k <= 2 * reach; ++k)
            for (int x = 0; x < columns; ++x) out[x] += weight[k] * line[x + k];
    });
    for_each_item(rows, 8, [&](int row) {
        float* out = picture.data() + static_cast<std::size_t>(row) * columns;
        std::fill(out, out + columns, 0.0f);
        for (int k = -reach; k <= reach; ++k) {
            const float* in = across.data() + static_cast<std::size_t>(std::clamp(row + k, 0, rows - 1)) * columns;
            for (int x = 0; x < columns; ++x) out[x] += weight[k + reach] * in[x];
        }
    });
}

std::vector<std::uint16_t> grey_levels(const std::vector<float>& signal, double reference, bool logarithmic)
{
    std::vector<std::uint16_t> grey(signal.size());
    for_each_item(static_cast<int>(signal.size()), 65536, [&](int i) {
        const double share = signal[i] / reference;
        const double level =
            logarithmic ? reference_grey + grey_per_neper * std::log(std::max(share, 1e-6)) : reference_grey * share;
        grey[i] = static_cast<std::uint16_t>(std::clamp(std::floor(level + 0.5), 0.0, double(most_grey)));
    });
    return grey;
}

std::vector<std::uint16_t> subtracted_levels(const std::vector<float>& signal, const std::vector<float>& mask)
{
    SEL_ASSERT(signal.size() == mask.size());
    std::vector<std::uint16_t> grey(signal.size());
    for (std::size_t i = 0; i < grey.size(); ++i) {
        const double level = 2048 + grey_per_neper * std::log(std::max(signal[i], 1e-9f) / std::max(mask[i], 1e-9f));
        grey[i] = static_cast<std::uint16_t>(std::clamp(std::floor(level + 0.5), 0.0, double(most_grey)));
    }
    return grey;
}

}  // namespace seldinger
