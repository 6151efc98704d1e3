#pragma once
// Colours of the picture and the scale that turns a force into one. Linear light inside, sRGB at the edges.

#include <array>
#include <cstdint>

namespace seldinger {

/// Linear-light red, green, blue, 0 ... 1.
struct Rgb {
    float r = 0, g = 0, b = 0;
};

/// 0xRRGGBB as written in a style sheet (sRGB) to linear light. [IEC 61966-2-1]
[[nodiscard]] Rgb rgb_from_hex(std::uint32_t hex);

/// Linear light to 8-bit sRGB, clamped.
[[nodiscard]] std::array<std::uint8_t, 3> srgb_bytes(const Rgb& colour);

/// Oklab lightness L of a colour, 0 black ... 1 white. [Ottosson 2020, "A perceptual color space for image processing"]
[[nodiscard]] float lightness(const Rgb& colour);

/// The force scale: t in 0 ... 1 (clamped) to a colour whose Oklab lightness rises linearly with t, so that equal steps of
/// force look equal and the order survives greyscale print. Violet - blue - green - yellow: no hue of tissue or of the wire.
[[nodiscard]] Rgb force_colour(double t);

/// Fraction of a scale of force per length, 0 ... 1: the square root, so that low values are distinguished too.
[[nodiscard]] double load_share(double value, double top);
/// Its colours: the wire's own where nothing touches, force_colour's above the lowest twentieth.
[[nodiscard]] Rgb load_colour(double share);

/// The scale of a wall that has moved, t in 0 ... 1 (clamped): pale where nothing happens, then orange, red, dark purple. Even
/// steps in Oklab, to 1/7, and its lightness falls linearly: it reads the same in grey and with colour blindness.
[[nodiscard]] Rgb wall_colour(double t);

namespace palette {  // sRGB; used with rgb_from_hex
inline constexpr std::uint32_t background_top = 0xfdfdfd, background_bottom = 0xdfe4ea;
inline constexpr std::uint32_t tissue = 0xf2bba8;       // the lumen's far wall
inline constexpr std::uint32_t tissue_deep = 0xb0574b;  // the same at grazing view
inline constexpr std::uint32_t glass = 0x97332e;        // the near wall's rim
inline constexpr std::uint32_t wire = 0x15304f;         // blued steel
// of several instruments in turn: apart from each other for whoever confuses hues too, and in grey
inline constexpr std::uint32_t instruments[] = {0x1f7a8c, wire, 0x7d4e9e, 0x8a6d1d};
inline constexpr std::uint32_t halo = 0xfff4ea;     // light line around wire and contacts
inline constexpr std::uint32_t outline = 0x6f7b86;  // where a wall was that has moved
inline constexpr std::uint32_t ink = 0x1f2933, faint_ink = 0x616e7c, accent = 0x0b69c7, target = 0x2f8f3e;
}  // namespace palette

}  // namespace seldinger
