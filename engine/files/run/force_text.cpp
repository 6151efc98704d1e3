// Rounds a force to what its band leaves of it.
#include "run/force_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {

std::string newtons(double value, double band)
{
    const bool small = std::max(std::abs(value), std::isfinite(band) ? band : 0.0) < 0.02;
    const double scale = small ? 1e3 : 1;
    const char* unit = small ? "mN" : "N";
    value *= scale, band *= scale;
    if (!(band > 0)) return fmt::format("{:.3g} {}", value, unit);
    // one digit of the band, two where it begins with 1
    const double exponent = std::floor(std::log10(band)), leading = band / std::pow(10, exponent);
    const int decimals = std::clamp(static_cast<int>(-exponent) + (leading < 2 ? 1 : 0), 0, 9);
    return fmt::format("{:.{}f} ± {:.{}f} {}", value, decimals, band, decimals, unit);
}

}  // namespace seldinger
