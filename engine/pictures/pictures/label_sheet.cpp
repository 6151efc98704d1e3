// Shrinks pictures to tiles and draws the labels over each.
#include "pictures/label_sheet.h"

#include "core/check.h"
#include "io/png_write.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace seldinger {
namespace {

constexpr int tile_side = 400, caption_height = 22, gap = 4;
constexpr double tint = 0.75;  // of a pixel that the mask covers
// bright on grey and apart from each other; they repeat after four
constexpr std::uint32_t colours[] = {0x35b8ff, 0xff9f1c, 0x6ee05a, 0xff5d8f};
constexpr std::uint32_t contact_colour = 0xffe14d;

std::uint32_t colour_of(std::size_t instrument) { return colours[instrument % std::size(colours)]; }

}  // namespace

LabelSheet::Pick LabelSheet::pick(std::size_t i, std::size_t count, std::size_t frames, std::size_t views)
{
    // first and last where there are enough; else blocks of the same one, within which the other advances
    const auto spread = [&](std::size_t all) {
        return all >= count && count > 1 ? i * (all - 1) / (count - 1) : i * all / count;
    };
    return {spread(frames), views > count ? spread(views) : i % views};
}

LabelSheet::LabelSheet(std::size_t pictures, int width, int height) : width_(width), height_(height)
{
    columns_ = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(std::max<std::size_t>(pictures, 1)))));
    const int rows = (static_cast<int>(std::max<std::size_t>(pictures, 1)) + columns_ - 1) / columns_;
    const double scale = static_cast<double>(tile_side) / std::max(width, height);
    tile_width_ = std::max(1, static_cast<int>(std::lround(scale * width)));
    tile_height_ = std::max(1, static_cast<int>(std::lround(scale * height)));
    sheet_width_ = columns_ * (tile_width_ + gap) + gap;
    sheet_height_ = rows * (tile_height_ + caption_height + gap) + gap;
    pixels_.assign(3 * static_cast<std::size_t>(sheet_width_) * sheet_height_, 255);
}

void LabelSheet::add(std::span<const std::uint8_t> rgb, const PictureTruth& truth, const std::string& caption)
{
    SEL_ASSERT(rgb.size() == 3 * static_cast<std::size_t>(width_) * height_);
    const int k = static_cast<int>(count_++);
    const int left = gap + k % columns_ * (tile_width_ + gap), top = gap + k / columns_ * (tile_height_ + caption_height + gap);
    SEL_ASSERT(top + tile_height_ <= sheet_height_);
    shrink(rgb, truth.mask, left, top);
    mark(truth, left, top);
    Canvas(pixels_, sheet_width_, sheet_height_).text(font_, left + 2, top + tile_height_ + 16, 13, caption, 0x1f2933);
}

/// Each tile pixel is the mean of those under it, tinted by as much of it as the mask covers.
void LabelSheet::shrink(std::span<const std::uint8_t> rgb, const std::vector<std::uint8_t>& mask, int left, int top)
{
    const auto under = [](int at, int from, int to) {
        const int first = static_cast<int>(static_cast<long>(at) * from / to);
        return std::pair{first, std::max(first + 1, static_cast<int>(static_cast<long>(at + 1) * from / to))};
    };
    Canvas canvas(pixels_, sheet_width_, sheet_height_);
    for (int y = 0; y < tile_height_; ++y)
        for (int x = 0; x < tile_width_; ++x) {
            const auto [x0, x1] = under(x, width_, tile_width_);
            const auto [y0, y1] = under(y, height_, tile_height_);
            std::array<double, 3> sum{};
            std::array<int, 256> covered{};
            for (int r = y0; r < y1; ++r)
                for (int c = x0; c < x1; ++c) {
                    const std::size_t p = static_cast<std::size_t>(r) * width_ + c;
                    for (std::size_t i = 0; i < 3; ++i) sum[i] += rgb[3 * p + i];
                    if (!mask.empty()) covered[mask[p]]++;
                }
            const double count = static_cast<double>(x1 - x0) * (y1 - y0);
            const std::size_t at = 3 * (static_cast<std::size_t>(top + y) * sheet_width_ + left + x);
            for (std::size_t i = 0; i < 3; ++i) pixels_[at + i] = static_cast<std::uint8_t>(std::lround(sum[i] / count));
            for (std::size_t label = 1; label < covered.size(); ++label)
                if (covered[label] > 0) canvas.blend(left + x, top + y, colour_of(label - 1), tint * covered[label] / count);
        }
}

/// A dot of the centreline every 24 pixels, a ring about the tip, contacts by their force.
void LabelSheet::mark(const PictureTruth& truth, int left, int top)
{
    Canvas canvas(pixels_, sheet_width_, sheet_height_);
    const double scale = static_cast<double>(tile_width_) / width_;
    // a canvas has pixel centres at half-integers
    const auto x_of = [&](const PixelPoint& p) { return left + scale * (p.column + 0.5); };
    const auto y_of = [&](const PixelPoint& p) { return top + scale * (p.row + 0.5); };
    double strongest = 0;
    for (const InstrumentTruth& of : truth.instruments)
        for (const ContactTruth& c : of.contacts) strongest = std::max(strongest, c.force.norm());
    for (std::size_t k = 0; k < truth.instruments.size(); ++k) {
        const InstrumentTruth& of = truth.instruments[k];
        for (const ContactTruth& c : of.contacts)
            if (c.pixel.in_field && strongest > 0)
                canvas.disc(x_of(c.pixel), y_of(c.pixel), 1 + 2 * std::sqrt(c.force.norm() / strongest), contact_colour, 0.6);
        double x = -1e9, y = -1e9;
        for (const PixelPoint& p : of.pixels) {
            if (!p.in_field || std::hypot(x_of(p) - x, y_of(p) - y) < 24) continue;
            x = x_of(p), y = y_of(p);
            canvas.disc(x, y, 1.3, 0x000000);
        }
        if (!of.pixels.empty() && of.pixels.front().in_field)
            canvas.ring(x_of(of.pixels.front()), y_of(of.pixels.front()), 6, 1.5, colour_of(k));
    }
}

void LabelSheet::write(const std::filesystem::path& path) const { write_png(path, sheet_width_, sheet_height_, pixels_); }

}  // namespace seldinger
