// Poisson numbers: exact for few photons, vectors of expansions for many.
#include "xray/quantum_noise.h"

#include "xray/pixel_math.h"

#include <cmath>

namespace seldinger {
namespace {

constexpr float exact_below = 64;  // photons

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

/// The stream of a pixel.
std::uint64_t pixel_stream(const NoiseDraw& draw, std::uint64_t pixel)
{
    return mixed(mixed(mixed(draw.seed + 0x9e3779b97f4a7c15ull) + draw.frame) + pixel);
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

inline std::uint32_t high_product(std::uint32_t a, std::uint32_t b)
{
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(a) * b) >> 32);
}

inline void philox(std::uint32_t& c0, std::uint32_t& c1, std::uint32_t& c2, std::uint32_t& c3, std::uint32_t key0,
                   std::uint32_t key1)
{
    constexpr std::uint32_t m0 = 0xd2511f53u, m1 = 0xcd9e8d57u;
#pragma GCC unroll 10
    for (int round = 0; round < 10; ++round) {
        const std::uint32_t high0 = high_product(m0, c0), low0 = m0 * c0, high1 = high_product(m1, c2), low1 = m1 * c2;
        c0 = high1 ^ c1 ^ key0, c1 = low1;
        c2 = high0 ^ c3 ^ key1, c3 = low0;
        key0 += 0x9e3779b9u, key1 += 0xbb67ae85u;
    }
}

/// Two independent normal numbers of two random words [Box58, doi:10.1214/aoms/1177706645]; the largest is 6.7.
inline void normal_pair(std::uint32_t first, std::uint32_t second, float& a, float& b)
{
    const float u = static_cast<float>(static_cast<std::int32_t>(first >> 1)) * 0x1p-31f + 0x1p-32f;  // in (0, 1]
    const float radius = std::sqrt(std::max(0.0f, -2.0f * log_of(u)));
    float sine, cosine;
    sine_cosine_turns(static_cast<float>(static_cast<std::int32_t>(second)) * 0x1p-32f, sine, cosine);
    a = radius * cosine, b = radius * sine;
}

/// Normal numbers of a row: z[k + count j] are those of the row's counter k.
void draw_normals(const NoiseDraw& draw, int row, int count, float* z)
{
    const auto key0 = static_cast<std::uint32_t>(draw.seed), key1 = static_cast<std::uint32_t>(draw.seed >> 32);
    const auto frame0 = static_cast<std::uint32_t>(draw.frame), frame1 = static_cast<std::uint32_t>(draw.frame >> 32);
    const std::uint32_t first = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(count);
    float *const z1 = z + count, *const z2 = z1 + count, *const z3 = z2 + count;
#if !defined(__clang__)  // which does not know it, and looks at run time whether the rows overlap
    #pragma GCC ivdep
#endif
    for (int k = 0; k < count; ++k) {
        std::uint32_t c0 = first + static_cast<std::uint32_t>(k), c1 = frame0, c2 = frame1, c3 = 0;
        philox(c0, c1, c2, c3, key0, key1);
        normal_pair(c0, c1, z[k], z1[k]);
        normal_pair(c2, c3, z2[k], z3[k]);
    }
}

float draw_few(float signal, float second, const NoiseDraw& draw, std::uint64_t pixel)
{
    if (!(signal > 0)) return 0;
    std::uint64_t stream = pixel_stream(draw, pixel);
    const double gain = static_cast<double>(second) / signal;
    return static_cast<float>(gain * draw_poisson(draw.photons * signal / gain, stream) / draw.photons);
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

RandomWords random_words(RandomWords c, std::uint32_t key0, std::uint32_t key1)
{
    philox(c[0], c[1], c[2], c[3], key0, key1);
    return c;
}

void draw_noisy_row(const Exposure& exposure, int row, const NoiseDraw& draw, float* out)
{
    const int columns = exposure.columns, counters = (columns + 3) / 4;
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    const float *signal = exposure.signal.data() + begin, *second = exposure.second.data() + begin;
    std::vector<float> normal(4 * static_cast<std::size_t>(counters)), mean(columns);
    draw_normals(draw, row, counters, normal.data());
    const auto photons = static_cast<float>(draw.photons);
    const float* z = normal.data();
    for (int x = 0; x < columns; ++x) {
        const float gain = second[x] / signal[x], m = photons * signal[x] / gain, root = std::sqrt(m);
        const float square = z[x] * z[x];
        const float beyond = root * z[x] + (square - 1.0f) * (1.0f / 6) + z[x] * (1.0f - square) / (72.0f * root);
        out[x] = signal[x] + gain / photons * beyond;
        mean[x] = m;
    }
    for (int x = 0; x < columns; ++x)
        if (!(mean[x] >= exact_below)) out[x] = draw_few(signal[x], second[x], draw, begin + x);  // 0/0 where nothing arrives
}

}  // namespace seldinger
