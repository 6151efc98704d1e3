// Blends anti-aliased lines, boxes, rings and FreeType glyphs into rows of sRGB bytes.
#include "view/canvas.h"

#include "core/assets.h"
#include "core/error.h"

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace seldinger {

struct Font::Impl {
    FT_Library library = nullptr;
    FT_Face face = nullptr;
    ~Impl()
    {
        if (face) FT_Done_Face(face);
        if (library) FT_Done_FreeType(library);
    }
};

namespace {

std::string font_path()
{
    if (const char* asked = std::getenv("SELDINGER_FONT"); asked && *asked) return asked;
    for (const char* path : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",    // Debian, Ubuntu
                             "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",  // Fedora
                             "/usr/share/fonts/TTF/DejaVuSans.ttf",                // Arch
                             "/usr/share/fonts/dejavu/DejaVuSans.ttf"}) {          // Alpine
        if (std::filesystem::exists(path)) return path;
    }
    const std::filesystem::path packaged = assets_folder() / "fonts" / "DejaVuSans.ttf";  // the wheel brings it
    if (std::filesystem::exists(packaged)) return packaged.string();
    throw Error(ErrorKind::BadFile,
                "no font for the legend: install DejaVu Sans (Debian: apt-get install fonts-dejavu-core) or set "
                "SELDINGER_FONT to a .ttf file");
}

/// Next code point of UTF-8 text; a broken sequence gives its first byte.
char32_t next_character(const std::string& s, std::size_t& i)
{
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(k < s.size() ? s[k] : 0); };
    const unsigned char lead = byte(i);
    const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc0 ? 1 : 0;
    char32_t c = more == 3 ? lead & 0x07u : more == 2 ? lead & 0x0fu : more == 1 ? lead & 0x1fu : lead;
    for (int k = 1; k <= more; ++k) c = (c << 6) | (byte(i + k) & 0x3fu);
    i += 1 + more;
    return c;
}

/// Calls place(pen_x, slot) for every letter, laid out with kerning; returns the advance. One pixel is 64 units.
template <typename Place>
double lay_out(const Font& font, double size, const std::string& words, Place&& place)
{
    FT_Face face = font.impl().face;
    FT_Set_Char_Size(face, 0, static_cast<FT_F26Dot6>(std::lround(size * 64)), 72, 72);
    double pen = 0;
    FT_UInt before = 0;
    for (std::size_t i = 0; i < words.size();) {
        const FT_UInt glyph = FT_Get_Char_Index(face, next_character(words, i));
        FT_Vector kerning{};
        if (before && glyph) FT_Get_Kerning(face, before, glyph, FT_KERNING_UNFITTED, &kerning);
        pen += kerning.x / 64.0;
        before = glyph;
        if (FT_Load_Glyph(face, glyph, FT_LOAD_NO_HINTING)) continue;
        place(pen, face->glyph);
        pen += face->glyph->linearHoriAdvance / 65536.0;
    }
    return pen;
}

}  // namespace

Font::Font() : impl_(std::make_unique<Impl>())
{
    const std::string path = font_path();
    if (FT_Init_FreeType(&impl_->library) || FT_New_Face(impl_->library, path.c_str(), 0, &impl_->face)) {
        throw Error(ErrorKind::BadFile, path + ": not a font that FreeType can read (SELDINGER_FONT names another)");
    }
}
Font::~Font() = default;
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;

void Canvas::blend(int x, int y, std::uint32_t colour, double opacity)
{
    if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0) return;
    std::uint8_t* pixel = &pixels_[3 * (static_cast<std::size_t>(y) * width_ + x)];
    for (int k = 0; k < 3; ++k) {
        const double over = (colour >> (16 - 8 * k)) & 0xffu;
        pixel[k] = static_cast<std::uint8_t>(std::lround(pixel[k] + std::min(opacity, 1.0) * (over - pixel[k])));
    }
}

void Canvas::fill(double x, double y, double width, double height, std::uint32_t colour, double opacity)
{
    for (int row = static_cast<int>(std::floor(y)); row < y + height; ++row) {
        const double cover_y = std::min<double>(row + 1, y + height) - std::max<double>(row, y);
        for (int column = static_cast<int>(std::floor(x)); column < x + width; ++column) {
            const double cover_x = std::min<double>(column + 1, x + width) - std::max<double>(column, x);
            blend(column, row, colour, opacity * cover_x * cover_y);
        }
    }
}

void Canvas::frame(double x, double y, double width, double height, double thickness, std::uint32_t colour, double opacity)
{
    fill(x, y, width, thickness, colour, opacity);
    fill(x, y + height - thickness, width, thickness, colour, opacity);
    fill(x, y + thickness, thickness, height - 2 * thickness, colour, opacity);
    fill(x + width - thickness, y + thickness, thickness, height - 2 * thickness, colour, opacity);
}

void Canvas::line(double x0, double y0, double x1, double y1, double thickness, std::uint32_t colour, double opacity)
{
    const double reach = 0.5 * thickness + 1, dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy;
    for (int row = static_cast<int>(std::min(y0, y1) - reach); row <= std::max(y0, y1) + reach; ++row) {
        for (int column = static_cast<int>(std::min(x0, x1) - reach); column <= std::max(x0, x1) + reach; ++column) {
            const double px = column + 0.5 - x0, py = row + 0.5 - y0;
            const double t = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0;
            const double distance = std::hypot(px - t * dx, py - t * dy);
            blend(column, row, colour, opacity * std::clamp(0.5 + 0.5 * thickness - distance, 0.0, 1.0));
        }
    }
}

void Canvas::ring(double x, double y, double radius, double thickness, std::uint32_t colour, double opacity)
{
    const double reach = radius + thickness + 1;
    for (int row = static_cast<int>(y - reach); row <= y + reach; ++row) {
        for (int column = static_cast<int>(x - reach); column <= x + reach; ++column) {
            const double off = std::abs(std::hypot(column + 0.5 - x, row + 0.5 - y) - radius);
            blend(column, row, colour, opacity * std::clamp(0.5 + 0.5 * thickness - off, 0.0, 1.0));
        }
    }
}

void Canvas::polygon(const std::vector<std::array<double, 2>>& corners, std::uint32_t colour, double opacity)
{
    double top = corners[0][1], bottom = top, left = corners[0][0], right = left, area = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const auto &a = corners[k], &b = corners[(k + 1) % corners.size()];
        top = std::min(top, a[1]), bottom = std::max(bottom, a[1]), left = std::min(left, a[0]), right = std::max(right, a[0]);
        area += a[0] * b[1] - b[0] * a[1];
    }
    for (int row = static_cast<int>(top) - 1; row <= bottom + 1; ++row) {
        for (int column = static_cast<int>(left) - 1; column <= right + 1; ++column) {
            double inside = 1;  // how far inside the nearest edge [pixels], 1 at most
            for (std::size_t k = 0; k < corners.size(); ++k) {
                const auto &a = corners[k], &b = corners[(k + 1) % corners.size()];
                const double dx = b[0] - a[0], dy = b[1] - a[1], length = std::hypot(dx, dy);
                if (!(length > 0)) continue;
                const double off = (dx * (row + 0.5 - a[1]) - dy * (column + 0.5 - a[0])) / length * (area < 0 ? -1 : 1);
                inside = std::min(inside, off + 0.5);
            }
            blend(column, row, colour, opacity * std::clamp(inside, 0.0, 1.0));
        }
    }
}

void Canvas::disc(double x, double y, double radius, std::uint32_t colour, double opacity)
{
    ring(x, y, 0.5 * radius, radius, colour, opacity);
}

double Canvas::text(const Font& font, double x, double baseline, double size, const std::string& words, std::uint32_t colour)
{
    return lay_out(font, size, words, [&](double pen, FT_GlyphSlot slot) {
        // the outline moves by the pen's fraction before it becomes pixels, so that letters are evenly spaced
        const double left = x + pen, whole = std::floor(left);
        FT_Outline_Translate(&slot->outline, std::lround((left - whole) * 64), 0);
        if (FT_Render_Glyph(slot, FT_RENDER_MODE_NORMAL)) return;
        const FT_Bitmap& bitmap = slot->bitmap;
        for (unsigned row = 0; row < bitmap.rows; ++row) {
            for (unsigned column = 0; column < bitmap.width; ++column) {
                const double cover = bitmap.buffer[row * bitmap.pitch + column] / 255.0;
                blend(static_cast<int>(whole) + slot->bitmap_left + static_cast<int>(column),
                      static_cast<int>(std::lround(baseline)) - slot->bitmap_top + static_cast<int>(row), colour, cover);
            }
        }
    });
}

double Canvas::text_width(const Font& font, double size, const std::string& words)
{
    return lay_out(font, size, words, [](double, FT_GlyphSlot) {});
}

}  // namespace seldinger
