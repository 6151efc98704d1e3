// Noise and blur row by row, and grey levels.
#include "xray/detector.h"

#include "core/check.h"
#include "core/parallel.h"
#include "xray/pixel_math.h"
#include "xray/quantum_noise.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Weights of a Gaussian cut off at four standard deviations, from its middle outwards; both sides sum to 1.
std::vector<float> gaussian(double pixels)
{
    if (pixels < 0.05) return {1.0f};
    std::vector<double> value;
    double sum = -1;  // the middle counts once
    for (int k = 0; k <= std::ceil(4 * pixels); ++k) {
        value.push_back(std::exp(-0.5 * k * k / (pixels * pixels)));
        sum += 2 * value.back();
    }
    std::vector<float> weight;
    for (const double v : value) weight.push_back(static_cast<float>(v / sum));
    return weight;
}

/// out = weight[0] middle, where a row starts being blurred.
void scale_row(const float* middle, float weight, int count, float* out)
{
    for (int x = 0; x < count; ++x) out[x] = weight * middle[x];
}

void add_pair(const float* one, const float* other, float weight, int count, float* out)
{
    for (int x = 0; x < count; ++x) out[x] += weight * (one[x] + other[x]);
}

/// @param line  row with `reach` places on either side, which are filled
void blur_along(std::vector<float>& line, const std::vector<float>& weight, int columns, float* out)
{
    const int reach = static_cast<int>(weight.size()) - 1;
    std::fill_n(line.begin(), reach, line[reach]);
    std::fill_n(line.end() - reach, reach, line[reach + columns - 1]);
    const float* middle = line.data() + reach;
    scale_row(middle, weight[0], columns, out);
    for (int k = 1; k <= reach; ++k) add_pair(middle - k, middle + k, weight[k], columns, out);
}

/// level(signal) to the nearest of 0 ... 4095.
template <class Level>
std::vector<std::uint16_t> levels_of(const std::vector<float>& signal, const Level& level)
{
    constexpr int piece = 16384;
    const int count = static_cast<int>(signal.size());
    std::vector<std::uint16_t> grey(signal.size());
    for_each_item((count + piece - 1) / piece, 1, [&](int p) {
        for (int i = p * piece; i < std::min(count, (p + 1) * piece); ++i)
            grey[i] = static_cast<std::uint16_t>(
                static_cast<std::int32_t>(std::max(0.0f, std::min(static_cast<float>(most_grey), level(i))) + 0.5f));
    });
    return grey;
}

/// Signals are taken as this at least before their logarithm.
constexpr float least_signal = 1e-9f;

}  // namespace

Detector::Detector(const DetectorSpec& spec) : spec_(spec), weight_(gaussian(spec.blur)) {}

const std::vector<float>& Detector::read(const Exposure& exposure, std::optional<std::uint64_t> frame)
{
    SEL_ASSERT(exposure.signal.size() == exposure.second.size());
    const int columns = exposure.columns, rows = exposure.rows, reach = static_cast<int>(weight_.size()) - 1;
    const NoiseDraw draw{spec_.photons, spec_.seed, frame.value_or(0)};
    signal_.resize(exposure.signal.size());
    across_.resize(reach > 0 ? signal_.size() : 0);
    for_each_item(rows, 8, [&](int row) {
        const std::size_t begin = static_cast<std::size_t>(row) * columns;
        std::vector<float> line(columns + 2 * reach);
        if (frame) draw_noisy_row(exposure, row, draw, line.data() + reach);
        else std::copy_n(exposure.signal.begin() + begin, columns, line.begin() + reach);
        if (reach > 0) blur_along(line, weight_, columns, across_.data() + begin);
        else std::copy_n(line.begin(), columns, signal_.begin() + begin);
    });
    if (reach > 0) blur_down(columns, rows);
    return signal_;
}

void Detector::blur_down(int columns, int rows)
{
    const int reach = static_cast<int>(weight_.size()) - 1;
    const auto across = [&](int row) {
        return across_.data() + static_cast<std::size_t>(std::clamp(row, 0, rows - 1)) * columns;
    };
    for_each_item(rows, 8, [&](int row) {
        float* out = signal_.data() + static_cast<std::size_t>(row) * columns;
        scale_row(across(row), weight_[0], columns, out);
        for (int k = 1; k <= reach; ++k) add_pair(across(row - k), across(row + k), weight_[k], columns, out);
    });
}

std::vector<std::uint16_t> grey_levels(const std::vector<float>& signal, double reference, bool logarithmic)
{
    const float* s = signal.data();
    const auto scale = static_cast<float>(1 / reference);
    constexpr auto level = static_cast<float>(reference_grey), per_neper = static_cast<float>(grey_per_neper);
    if (!logarithmic) return levels_of(signal, [=](int i) { return level * (scale * s[i]); });
    return levels_of(signal, [=](int i) { return level + per_neper * log_of(std::max(scale * s[i], 1e-6f)); });
}

std::vector<std::uint16_t> subtracted_levels(const std::vector<float>& signal, const std::vector<float>& mask)
{
    SEL_ASSERT(signal.size() == mask.size());
    const float *s = signal.data(), *m = mask.data();
    constexpr auto per_neper = static_cast<float>(grey_per_neper);
    return levels_of(
        signal, [=](int i) { return 2048.0f + per_neper * log_of(std::max(s[i], least_signal) / std::max(m[i], least_signal)); });
}

}  // namespace seldinger
