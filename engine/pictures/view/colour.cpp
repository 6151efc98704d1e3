// sRGB to linear light and back, and the force scale as a path of equal steps in Oklab.
#include "view/colour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

float decode(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }
float encode(float l) { return l <= 0.0031308f ? 12.92f * l : 1.055f * std::pow(l, 1.0f / 2.4f) - 0.055f; }

/// Oklab to linear sRGB: the published inverse matrices.
Rgb from_oklab(float lightness, float a, float b)
{
    const float l = std::pow(lightness + 0.3963377774f * a + 0.2158037573f * b, 3.0f);
    const float m = std::pow(lightness - 0.1055613458f * a - 0.0638541728f * b, 3.0f);
    const float s = std::pow(lightness - 0.0894841775f * a - 1.2914855480f * b, 3.0f);
    return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s, -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
            -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

float share_of(double t) { return std::isfinite(t) ? std::clamp(static_cast<float>(t), 0.0f, 1.0f) : 0.0f; }

}  // namespace

Rgb rgb_from_hex(std::uint32_t hex)
{
    const auto channel = [hex](int shift) { return decode(static_cast<float>((hex >> shift) & 0xffu) / 255.0f); };
    return {channel(16), channel(8), channel(0)};
}

std::array<std::uint8_t, 3> srgb_bytes(const Rgb& colour)
{
    const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(255.0f * encode(std::clamp(v, 0.0f, 1.0f)))); };
    return {byte(colour.r), byte(colour.g), byte(colour.b)};
}

float lightness(const Rgb& c)
{
    const float l = std::cbrt(0.4122214708f * c.r + 0.5363325363f * c.g + 0.0514459929f * c.b);
    const float m = std::cbrt(0.2119034982f * c.r + 0.6806995451f * c.g + 0.1073969566f * c.b);
    const float s = std::cbrt(0.0883024619f * c.r + 0.2817188376f * c.g + 0.6299787005f * c.b);
    return 0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s;
}

double load_share(double value, double top) { return top > 0 ? std::sqrt(std::clamp(value / top, 0.0, 1.0)) : 0.0; }

Rgb load_colour(double share)
{
    const Rgb own = rgb_from_hex(palette::wire), force = force_colour(share);
    const float s = std::min(1.0f, 20.0f * share_of(share));
    return {own.r + s * (force.r - own.r), own.g + s * (force.g - own.g), own.b + s * (force.b - own.b)};
}

Rgb wall_colour(double t)
{
    const float u = share_of(t);
    const float light = 0.94f - 0.58f * u;
    const float hue = (95.0f - 105.0f * u) * std::numbers::pi_v<float> / 180.0f;  // yellow, orange, red, purple
    const float chroma = 0.02f + 0.10f * u + 0.36f * u * (1 - u);
    return from_oklab(light, chroma * std::cos(hue), chroma * std::sin(hue));
}

Rgb force_colour(double t)
{
    const float u = share_of(t);
    // lightness is linear in t; hue runs from 310 deg (violet) to 103 deg (yellow). Chroma stays below what sRGB can show, which
    // is 0.108 at the green-blue in the middle and more on both sides; a parabola under that limit leaves no edge in the scale.
    const float light = 0.36f + 0.56f * u;
    const float hue = (310.0f - 207.0f * u) * std::numbers::pi_v<float> / 180.0f;
    const float chroma = 0.105f + 0.26f * (u - 0.44f) * (u - 0.44f);
    return from_oklab(light, chroma * std::cos(hue), chroma * std::sin(hue));
}

}  // namespace seldinger
