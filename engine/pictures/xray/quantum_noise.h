#pragma once
// Quantum noise of a detector that takes in energy.
//
// A pixel whose photons n_k of energy E_k are Poisson gets m = sum_k n_k E_k with the variance q = sum_k n_k E_k^2. It is drawn
// as g P with g = q/m and P Poisson of mean M = m/g, which has both; of one energy it is the count itself.
// Below M = 64, P is drawn exactly. From there on it is the expansion of Poisson's quantile about the normal's by Cornish and
// Fisher [Cornish38, doi:10.2307/1400905], z normal:
//   P = M + sqrt(M) z + (z^2 - 1)/6 + (z - z^3)/(72 sqrt(M))
// Its mean is M, its variance M (1 + 1/(518 M^2)). Its skewness is Poisson's up to a fraction of 1/M. It is not rounded to
// whole photons, which would add 1/12 to the variance. The numbers of a pixel depend on seed, frame and position alone: the
// same picture on any number of threads and from any first frame.

#include "xray/exposure.h"

#include <array>
#include <cstdint>

namespace seldinger {

/// Poisson number of that mean: products of uniforms below 12, above [Hörmann93, doi:10.1016/0167-6687(93)90997-4], algorithm
/// PTRS. Both exact.
/// @param stream  state of the generator [Steele14, doi:10.1145/2660193.2660195, SplitMix]; moves on
[[nodiscard]] double draw_poisson(double mean, std::uint64_t& stream);

/// Four random words of a counter and a key: Philox 4x32 of ten rounds [Salmon11, doi:10.1145/2063384.2063405].
using RandomWords = std::array<std::uint32_t, 4>;
[[nodiscard]] RandomWords random_words(RandomWords counter, std::uint32_t key0, std::uint32_t key1);

/// What the noise of a picture is drawn with.
struct NoiseDraw {
    double photons = 0;  // per pixel in the open beam
    std::uint64_t seed = 0, frame = 0;
};

/// A row of signal as photons make it. @param out  [columns]
void draw_noisy_row(const Exposure& exposure, int row, const NoiseDraw& draw, float* out);

}  // namespace seldinger
