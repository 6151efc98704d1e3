#pragma once
// From the arriving energy to a 12-bit picture: quantum noise, blur, grey levels.

#include "xray/exposure.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace seldinger {

struct DetectorSpec {
    double photons = 1e5;    // per pixel in the open beam
    double blur = 0;         // standard deviation of a Gaussian [pixels], edges held; less than 0.05: none
    std::uint64_t seed = 0;  // of the noise
};

/// Reads pictures one after another in memory that it keeps.
class Detector {
public:
    explicit Detector(const DetectorSpec& spec);
    /// Signal with noise and blur; it stands until the next.
    /// @param frame  number of the picture, which its noise is drawn with; none: no noise
    [[nodiscard]] const std::vector<float>& read(const Exposure& exposure, std::optional<std::uint64_t> frame);

private:
    void blur_down(int columns, int rows);

    DetectorSpec spec_;
    std::vector<float> weight_;  // of the blur, from the middle outwards; one: none
    std::vector<float> signal_, across_;
};

/// Grey levels 0 ... 4095 of the signal. @param reference  signal that becomes `reference_grey`
[[nodiscard]] std::vector<std::uint16_t> grey_levels(const std::vector<float>& signal, double reference, bool logarithmic);

inline constexpr int most_grey = 4095;
inline constexpr double reference_grey = 1700;
inline constexpr double grey_per_neper = 1000;  // of logarithmic pictures and of subtracted ones

/// What the contrast run has more than the mask: 2048 + grey_per_neper (ln signal - ln mask), vessels with contrast dark.
[[nodiscard]] std::vector<std::uint16_t> subtracted_levels(const std::vector<float>& signal, const std::vector<float>& mask);

}  // namespace seldinger
