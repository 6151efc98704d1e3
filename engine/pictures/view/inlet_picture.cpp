// Draws the wall, then arrows, numbers and a list over it.
#include "view/inlet_picture.h"

#include "io/png_write.h"
#include "view/canvas.h"
#include "view/renderer.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace seldinger {
namespace {

constexpr int width = 1280, height = 900;
constexpr std::uint32_t chosen_colour = 0xc62828, other_colour = 0x1d4e89, branch_colour = 0x2e7d32, ink = 0x202020;
constexpr std::size_t most_listed = 24;

void draw_arrow(Canvas& canvas, const Projected& from, const Projected& to, std::uint32_t colour)
{
    canvas.line(from.column, from.row, to.column, to.row, 3, colour);
    const double dx = to.column - from.column, dy = to.row - from.row, length = std::hypot(dx, dy);
    if (length < 4) return;  // straight at the eye
    const double x = dx / length, y = dy / length;
    canvas.polygon(
        {{to.column + 9 * x, to.row + 9 * y}, {to.column - 6 * y, to.row + 6 * x}, {to.column + 6 * y, to.row - 6 * x}}, colour);
}

constexpr double disc = 14, margin = 16;  // radius of a number's disc, distance of its middle from the border [pixels]

void draw_number(Canvas& canvas, const Font& font, const PicturePoint& at, const PicturePoint& of, int number,
                 std::uint32_t colour)
{
    const std::string text = fmt::format("{}", number);
    if (std::hypot(at.x - of.x, at.y - of.y) > disc) canvas.line(at.x, at.y, of.x, of.y, 1, colour);
    canvas.disc(at.x, at.y, disc, 0xffffff);
    canvas.disc(at.x, at.y, disc - 1.5, colour);
    canvas.text(font, at.x - 0.5 * Canvas::text_width(font, 15, text), at.y + 5.5, 15, text, 0xffffff);
}

double distance_to(const PictureStroke& stroke, const PicturePoint& p)
{
    const double dx = stroke.to.x - stroke.from.x, dy = stroke.to.y - stroke.from.y, square = dx * dx + dy * dy;
    const double along =
        square > 0 ? std::clamp(((p.x - stroke.from.x) * dx + (p.y - stroke.from.y) * dy) / square, 0.0, 1.0) : 0;
    return std::hypot(p.x - stroke.from.x - along * dx, p.y - stroke.from.y - along * dy);
}

}  // namespace

// The nearest free place, in rings about where a number belongs.
std::vector<PicturePoint> place_numbers(const std::vector<PicturePoint>& wanted, const std::vector<PictureStroke>& strokes,
                                        double columns, double rows)
{
    constexpr double ring = 12, stroke_half = 9;  // [pixels], with the head
    constexpr int rings = 12, around = 16;
    std::vector<PicturePoint> placed;
    for (const PicturePoint& at : wanted) {
        const auto within = [&](PicturePoint p) {
            return PicturePoint{std::clamp(p.x, margin, columns - margin), std::clamp(p.y, margin, rows - margin)};
        };
        const auto clear = [&](const PicturePoint& p) {  // how far it is from what it could hide or be hidden by
            double room = std::numeric_limits<double>::infinity();
            for (const PictureStroke& stroke : strokes) room = std::min(room, distance_to(stroke, p) - stroke_half - disc);
            for (const PicturePoint& other : placed) room = std::min(room, std::hypot(p.x - other.x, p.y - other.y) - 2 * disc);
            return room;
        };
        PicturePoint best = within(at);
        double room = clear(best);
        for (int r = 1; r <= rings && room < 0; ++r)
            for (int k = 0; k < around && room < 0; ++k) {
                const double angle = 2 * std::numbers::pi * k / around;
                const PicturePoint p = within({at.x + r * ring * std::cos(angle), at.y + r * ring * std::sin(angle)});
                if (const double there = clear(p); there > room) best = p, room = there;
            }
        placed.push_back(best);
    }
    return placed;
}

void draw_inlets(const std::filesystem::path& file, const WallMesh& mesh, const std::vector<Inlet>& inlets,
                 const std::vector<Vec3>& branches, int chosen)
{
    Look look;
    look.legend = look.inset = look.ruler = false;
    const Font font;
    Renderer renderer(width, height, look);
    renderer.set_wall(mesh);
    std::vector<Vec3> points;
    for (const Inlet& inlet : inlets) points.push_back(inlet.point);
    renderer.aim(points);
    renderer.draw({});
    std::vector<std::uint8_t> pixels = renderer.pixels();
    Canvas canvas(pixels, width, height);
    const Camera& camera = renderer.camera();
    const Viewport& view = renderer.main_view();
    // arrows first: a number lies over none of them
    std::vector<PicturePoint> wanted, places;
    std::vector<PictureStroke> arrows;
    std::vector<std::uint32_t> colours;
    for (std::size_t k = inlets.size(); k-- > 0;) {
        const Inlet& inlet = inlets[k];
        const Projected at = project(camera, view, inlet.point);
        const double reach = 45 / pixels_per_metre(camera, view, at.depth);  // as long in every picture
        const Projected tail = project(camera, view, inlet.point - reach * inlet.direction);
        draw_arrow(canvas, tail, at, static_cast<int>(k) + 1 == chosen ? chosen_colour : other_colour);
        arrows.push_back({{tail.column, tail.row}, {at.column, at.row}});
    }
    for (std::size_t k = 0; k < inlets.size(); ++k) {
        const PictureStroke& arrow = arrows[inlets.size() - 1 - k];
        const double dx = arrow.from.x - arrow.to.x, dy = arrow.from.y - arrow.to.y, length = std::max(1.0, std::hypot(dx, dy));
        wanted.push_back(
            {arrow.from.x + (disc + 10) * dx / length, arrow.from.y + (disc + 10) * dy / length});  // behind its arrow
        places.push_back(arrow.from);
        colours.push_back(static_cast<int>(k) + 1 == chosen ? chosen_colour : other_colour);
    }
    for (const Vec3& branch : branches) {
        const Projected at = project(camera, view, branch);
        wanted.push_back({at.column, at.row});
        places.push_back(wanted.back());
        colours.push_back(branch_colour);
    }
    const std::vector<PicturePoint> numbers = place_numbers(wanted, arrows, width, height);
    for (std::size_t k = numbers.size(); k-- > 0;)
        draw_number(canvas, font, numbers[k], places[k], static_cast<int>(k < inlets.size() ? k : k - inlets.size()) + 1,
                    colours[k]);
    const std::size_t listed = std::min(inlets.size(), most_listed);
    canvas.fill(10, 10, 330, 22.0 * static_cast<double>(listed) + 14, 0xffffff, 0.8);
    for (std::size_t k = 0; k < listed; ++k) {
        const bool taken = static_cast<int>(k) + 1 == chosen;
        canvas.text(font, 20, 30 + 22.0 * static_cast<double>(k), 15,
                    fmt::format("{}: radius {:.2f} mm{}{}", k + 1, 1e3 * inlets[k].radius,
                                inlets[k].opening >= 0 ? ", an opening" : ", a closed end", taken ? " (taken)" : ""),
                    taken ? chosen_colour : ink);
    }
    if (!branches.empty())
        canvas.text(font, 20, height - 20.0, 15, "green: branches, by number; the last is the trunk's own end", branch_colour);
    write_png(file, width, height, pixels);
}

}  // namespace seldinger
