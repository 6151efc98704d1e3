// Draws the wall, then arrows, numbers and a list over it.
#include "view/inlet_picture.h"

#include "io/png_write.h"
#include "view/canvas.h"
#include "view/renderer.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

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
    canvas.polygon({{to.column + 9 * x, to.row + 9 * y}, {to.column - 6 * y, to.row + 6 * x}, {to.column + 6 * y, to.row - 6 * x}}, colour);
}

void draw_number(Canvas& canvas, const Font& font, double x, double y, int number, std::uint32_t colour)
{
    const std::string text = fmt::format("{}", number);
    canvas.disc(x, y, 14, 0xffffff);
    canvas.disc(x, y, 12.5, colour);
    canvas.text(font, x - 0.5 * Canvas::text_width(font, 15, text), y + 5.5, 15, text, 0xffffff);
}

}  // namespace

void draw_inlets(const std::filesystem::path& file, const WallMesh& mesh, const std::vector<Inlet>& inlets, const std::vector<Vec3>& branches,
                  int chosen)
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
    for (std::size_t k = branches.size(); k-- > 0;) {
        const Projected at = project(camera, view, branches[k]);
        draw_number(canvas, font, std::clamp(at.column, 16.0, width - 16.0), std::clamp(at.row, 16.0, height - 16.0), static_cast<int>(k) + 1, branch_colour);
    }
    for (std::size_t k = inlets.size(); k-- > 0;) {
        const Inlet& inlet = inlets[k];
        const std::uint32_t colour = static_cast<int>(k) + 1 == chosen ? chosen_colour : other_colour;
        const Projected at = project(camera, view, inlet.point);
        const double reach = 45 / pixels_per_metre(camera, view, at.depth);  // as long in every picture
        const Projected tail = project(camera, view, inlet.point - reach * inlet.direction);
        draw_arrow(canvas, tail, at, colour);
        draw_number(canvas, font, std::clamp(tail.column, 16.0, width - 16.0), std::clamp(tail.row, 16.0, height - 16.0),
                    static_cast<int>(k) + 1, colour);
    }
    const std::size_t listed = std::min(inlets.size(), most_listed);
    canvas.fill(10, 10, 330, 22.0 * static_cast<double>(listed) + 14, 0xffffff, 0.8);
    for (std::size_t k = 0; k < listed; ++k) {
        const bool taken = static_cast<int>(k) + 1 == chosen;
        canvas.text(font, 20, 30 + 22.0 * static_cast<double>(k), 15,
                    fmt::format("{}: radius {:.2f} mm{}{}", k + 1, 1e3 * inlets[k].radius,
                                inlets[k].opening >= 0 ? ", an opening" : ", a closed end", taken ? " (taken)" : ""),
                    taken ? chosen_colour : ink);
    }
    if (!branches.empty()) canvas.text(font, 20, height - 20.0, 15, "green: branches, by number; the last is the trunk's own end", branch_colour);
    write_png(file, width, height, pixels);
}

}  // namespace seldinger
