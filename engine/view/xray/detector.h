#pragma once
// From the share of the beam that arrives to a 12-bit picture: quantum noise, blur, grey levels.
//
// A detector that takes in energy gets m = sum_k n_k E_k of a pixel whose photons n_k of energy E_k are Poisson: variance
// q = sum_k n_k E_k^2. It is drawn as g P with g = q/m and P Poisson of mean m/g, which has both; of one energy it is the count
// itself. Each pixel draws from its own stream, numbered by seed, frame and pixel: the same picture on any threads and from any
// frame on.

#include <cstdint>
#include <vector>

namespace seldinger {

/// Poisson number of that mean: products of uniforms below 12, above [Hörmann93, doi:10.1016/0167-6687(93)90997-4], algorithm
/// PTRS. Both exact.
/// @param stream  state of the generator [Steele14, doi:10.1145/2660193.2660195, SplitMix]; moves on
[[nodiscard]] double draw_poisson(double mean, std::uint64_t& stream);

/// The stream of a pixel.
[[nodiscard]] std::uint64_t noise_stream(std::uint64_t seed, std::uint64_t frame, std::uint64_t pixel);

/// What arrives, per pixel, as shares of the open beam.
struct Exposure {
    int columns = 0, rows = 0;
    std::vector<float> signal;  // m over the open beam's, I/I_0
    std::vector<float> second;  // q over the open beam's m and the mean energy of its photons; of one energy the same as signal
};

/// Replaces the signal by one that photons make. @param photons  per pixel in the open beam
void add_quantum_noise(Exposure& exposure, double photons, std::uint64_t seed, std::uint64_t frame);

/// Gaussian of that standard deviation [pixels], edges held. Less than 0.05: nothing.
void blur_picture(std::vector<float>& picture, int columns, int rows, double pixels);

/// Grey levels 0 ... 4095 of the signal. @param reference  signal that becomes `level`
[[nodiscard]] std::vector<std::uint16_t> grey_levels(const std::vector<float>& signal, double reference, bool logarithmic);

inline constexpr int most_grey = 4095;
inline constexpr double reference_grey = 1700;
inline constexpr double grey_per_neper = 1000;  // of logarithmic pictures and of subtracted ones

/// What the contrast run has more than the mask: 2048 + grey_per_neper (ln signal - ln mask), vessels with contrast dark.
[[nodiscard]] std::vector<std::uint16_t> subtracted_levels(const std::vector<float>& signal, const std::vector<float>& mask);

}  // namespace seldinger
