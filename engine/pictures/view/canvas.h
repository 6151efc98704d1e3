#pragma once
// Flat drawing over a finished picture: lines, boxes, rings and text, anti-aliased, in sRGB.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace seldinger {

/// A typeface, from a file of the system (no font is part of this project).
class Font {
public:
    /// Opens the file named by SELDINGER_FONT or else DejaVu Sans where systems keep it.
    /// @throws Error BadFile, naming the package to install
    Font();
    ~Font();
    Font(Font&&) noexcept;
    Font& operator=(Font&&) noexcept;

    struct Impl;
    [[nodiscard]] Impl& impl() const { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

/// Draws into rows of 3-byte pixels, row 0 at the top. Colours are 0xRRGGBB. Pixel centres are at half-integers.
class Canvas {
public:
    Canvas(std::vector<std::uint8_t>& pixels, int width, int height) : pixels_(pixels), width_(width), height_(height) {}

    void blend(int x, int y, std::uint32_t colour, double opacity);
    void fill(double x, double y, double width, double height, std::uint32_t colour, double opacity = 1);
    void frame(double x, double y, double width, double height, double thickness, std::uint32_t colour, double opacity = 1);
    void line(double x0, double y0, double x1, double y1, double thickness, std::uint32_t colour, double opacity = 1);
    void ring(double x, double y, double radius, double thickness, std::uint32_t colour, double opacity = 1);
    /// Convex, corners in order.
    void polygon(const std::vector<std::array<double, 2>>& corners, std::uint32_t colour, double opacity = 1);
    void disc(double x, double y, double radius, std::uint32_t colour, double opacity = 1);
    /// @param x,baseline  where the first letter's origin lies. @param size  pixels per em. UTF-8.
    /// @return the advance [pixels]
    double text(const Font& font, double x, double baseline, double size, const std::string& words, std::uint32_t colour);
    [[nodiscard]] static double text_width(const Font& font, double size, const std::string& words);

private:
    std::vector<std::uint8_t>& pixels_;
    int width_, height_;
};

}  // namespace seldinger
