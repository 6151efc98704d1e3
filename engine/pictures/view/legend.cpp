// Lays out the sheet and draws readings, scale bars, tip mark, inset frame and the force scale.
#include "view/legend.h"

#include "view/colour.h"
#include "view/force_load.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// A force with the unit that keeps it readable.
std::string force_text(double newton)
{
    return std::abs(newton) < 0.9995 ? fmt::format("{:.3g} mN", 1e3 * newton) : fmt::format("{:.3g} N", newton);
}

/// A force per length of wire, with its unit.
std::string load_text(double newton_per_metre)
{
    return newton_per_metre < 0.9995 ? fmt::format("{:.3g} mN/m", 1e3 * newton_per_metre)
                                     : fmt::format("{:.3g} N/m", newton_per_metre);
}

std::string length_text(double metre) { return fmt::format("{:.3g} mm", 1e3 * metre); }

double round_up(double value, std::initializer_list<double> steps)
{
    const double decade = std::pow(10.0, std::floor(std::log10(value)));
    for (double step : steps) {
        if (value <= step * decade * (1 + 1e-9)) return step * decade;
    }
    return 10 * decade;
}

/// A bar of a round length, between half and 1.25 times `share` of the view's width, true at the depth of the camera's target.
void draw_scale_bar(Canvas& canvas, const Font& font, const Camera& camera, const Viewport& view, double unit, double share)
{
    const double scale = pixels_per_metre(camera, view, (camera.target - camera.eye).norm());
    const double length = round_up_125(0.5 * share * view.width / scale), bar = length * scale;
    const double x = view.x + 14 * unit, y = view.y + view.height - 16 * unit;
    const std::string label = length_text(length);
    const double wide = std::max(bar, Canvas::text_width(font, 13 * unit, label) + 8 * unit);
    canvas.fill(x - 6 * unit, y - 25 * unit, wide + 12 * unit, 34 * unit, 0xffffff, 0.78);
    canvas.fill(x, y - 1.5 * unit, bar, 3 * unit, palette::ink);
    canvas.fill(x, y - 5 * unit, 1.5 * unit, 8 * unit, palette::ink);
    canvas.fill(x + bar - 1.5 * unit, y - 5 * unit, 1.5 * unit, 8 * unit, palette::ink);
    canvas.text(font, x + 4 * unit, y - 9 * unit, 13 * unit, label, palette::ink);
}

/// A cube that lies as the patient does, the letters of its near faces on them: A/P, L/R, H/F.
void draw_cube(Canvas& canvas, const Font& font, const LegendFacts& facts)
{
    const double unit = facts.layout.unit, half = 17 * unit;
    const Viewport& view = facts.layout.main;
    const Camera& camera = facts.main_camera;
    const double x = view.x + view.width - 3 * half, y = view.y + view.height - 3 * half;
    const Vec3 right = camera.right(), forward = camera.forward(), up = right.cross(forward);
    static constexpr const char* letters[3][2] = {{"R", "L"}, {"A", "P"}, {"F", "H"}};
    const auto place = [&](const Vec3& p) { return std::array<double, 2>{x + half * p.dot(right), y - half * p.dot(up)}; };
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            const Vec3 normal = (side ? 1.0 : -1.0) * facts.cube[axis];
            const double facing = -normal.dot(forward);
            if (facing < 0.02) continue;
            const Vec3 &b = facts.cube[(axis + 1) % 3], &c = facts.cube[(axis + 2) % 3];
            const std::vector<std::array<double, 2>> corners = {place(normal + b + c), place(normal + b - c),
                                                                place(normal - b - c), place(normal - b + c)};
            canvas.polygon(corners, facing > 0.7 ? 0xf4f6f8 : facing > 0.35 ? 0xdde3e9 : 0xc3ccd5, 0.95);
            for (std::size_t k = 0; k < 4; ++k)
                canvas.line(corners[k][0], corners[k][1], corners[(k + 1) % 4][0], corners[(k + 1) % 4][1], unit,
                            palette::faint_ink);
            if (facing < 0.3) continue;
            const double size = 17 * unit;
            const std::array<double, 2> middle = place(normal);
            const char* letter = letters[axis][side];
            canvas.text(font, middle[0] - 0.5 * Canvas::text_width(font, size, letter), middle[1] + 0.36 * size, size, letter,
                        palette::ink);
        }
    }
}

constexpr double tip_mark = 8;  // radius of a tip's ring [units]

/// A ring about a place that is in the view. @param radius  [pixels]
void draw_mark(Canvas& canvas, double unit, const Projected& at, const Viewport& view, double radius, std::uint32_t colour)
{
    if (at.depth <= 0 || at.column < view.x || at.column > view.x + view.width || at.row < view.y ||
        at.row > view.y + view.height)
        return;
    canvas.ring(at.column, at.row, radius, 4.0 * unit, 0xffffff, 0.9);
    canvas.ring(at.column, at.row, radius, 2.0 * unit, colour);
}

/// Tips, and round the target a ring as wide as that, if it can be told from a tip's.
void draw_marks(Canvas& canvas, const LegendFacts& facts, const Camera& camera, const Viewport& view)
{
    const double unit = facts.layout.unit;
    for (const WireLine& wire : facts.frame->wires)
        if (!wire.nodes.empty())
            draw_mark(canvas, unit, project(camera, view, wire.nodes.front()), view, tip_mark * unit, palette::accent);
    if (!facts.target) return;
    const Projected at = project(camera, view, facts.target->at);
    const double wide = at.depth > 0 ? facts.target->radius * pixels_per_metre(camera, view, at.depth) : 0;
    draw_mark(canvas, unit, at, view, std::max(wide, 1.75 * tip_mark * unit), palette::target);
}

/// The inset's frame, its own scale bar, and its outline in the main view.
void draw_inset(Canvas& canvas, const Font& font, const LegendFacts& facts)
{
    const double unit = facts.layout.unit;
    const Viewport &box = facts.layout.inset, &main = facts.layout.main;
    const double main_scale =
        pixels_per_metre(facts.main_camera, main, project(facts.main_camera, main, facts.inset_camera.target).depth);
    const double reach = (facts.inset_camera.target - facts.inset_camera.eye).norm();
    const double inset_scale = pixels_per_metre(facts.inset_camera, box, reach);
    const Projected centre = project(facts.main_camera, main, facts.inset_camera.target);
    const double side = box.width * main_scale / inset_scale;
    canvas.frame(centre.column - side / 2 - 1.5 * unit, centre.row - side / 2 - 1.5 * unit, side + 3 * unit, side + 3 * unit,
                 1.2 * unit, palette::accent, 0.9);
    canvas.frame(box.x - 1.5 * unit, box.y - 1.5 * unit, box.width + 3 * unit, box.height + 3 * unit, 1.5 * unit,
                 palette::accent);
    draw_scale_bar(canvas, font, facts.inset_camera, box, unit, 0.22);
    const std::string label = fmt::format("tip, {:.2g}\u00d7", inset_scale / main_scale);
    const double width = Canvas::text_width(font, 13 * unit, label);
    canvas.text(font, box.x + box.width - width - 8 * unit, box.y + 18 * unit, 13 * unit, label, palette::accent);
}

struct Row {
    std::string name, value;
};

std::vector<Row> readings(const LegendFacts& facts)
{
    const WireFrame& frame = *facts.frame;
    std::vector<Row> rows;
    if (std::isfinite(frame.inserted)) rows.push_back({"inserted", fmt::format("{:.1f} mm", 1e3 * frame.inserted)});
    if (std::isfinite(frame.time)) rows.push_back({"time", fmt::format("{:.3f} s", frame.time)});
    if (std::isfinite(frame.hand_force)) rows.push_back({"hand force", force_text(frame.hand_force)});
    double load = 0;
    bool known = true;
    std::vector<int> places;
    for (const ContactMark& c : frame.contacts) {
        load = std::max(load, c.per_length);
        known = known && std::isfinite(c.per_length);
        if (std::find(places.begin(), places.end(), c.place) == places.end()) places.push_back(c.place);
    }
    if (known) {
        if (std::isfinite(frame.per_length)) load = frame.per_length;
        rows.push_back({"contact, per length", load_text(load)});
        rows.push_back({"places in contact", std::to_string(places.size())});
    } else {
        rows.push_back({"contact samples", std::to_string(frame.contacts.size())});
    }
    return rows;
}

std::string wall_text(WallQuantity quantity, double value)
{
    return quantity == WallQuantity::Stress ? fmt::format("{:.3g} kPa", 1e-3 * value) : length_text(value);
}

Row wall_reading(const LegendFacts& facts)
{
    double most = 0;
    for (const double v : facts.frame->wall.value) most = std::max(most, v);
    return {facts.wall_scale.quantity == WallQuantity::Stress ? "largest stress" : "farthest move",
            wall_text(facts.wall_scale.quantity, most)};
}

/// @return the y below the last row
double draw_readings(Canvas& canvas, const Font& font, const LegendFacts& facts, double x, double y, double width)
{
    const double unit = facts.layout.unit, size = 14 * unit;
    std::vector<Row> rows = readings(facts);
    if (facts.wall_scale.top > 0) rows.push_back(wall_reading(facts));
    for (const Row& row : rows) {
        y += 21 * unit;
        canvas.text(font, x, y, size, row.name, palette::faint_ink);
        canvas.text(font, x + width - Canvas::text_width(font, size, row.value), y, size, row.value, palette::ink);
    }
    return y;
}

double draw_wire_key(Canvas& canvas, const Font& font, const LegendFacts& facts, double x, double y)
{
    const double unit = facts.layout.unit, size = 12 * unit, thick = std::max(facts.least_pixels, 3 * unit);
    const WireFrame& frame = *facts.frame;
    y += 6 * unit;
    for (std::size_t k = 0; k < frame.wires.size(); ++k) {
        if (frame.wires[k].radius.empty()) continue;
        y += 18 * unit;
        const std::string name = frame.wires[k].name.empty() ? "wire" : frame.wires[k].name;
        canvas.line(x + 2 * unit, y - 4 * unit, x + 26 * unit, y - 4 * unit, thick, instrument_colour(frame, k));
        canvas.text(font, x + 36 * unit, y, size, fmt::format("{}, \u00d8 {:.3g} mm", name, 2e3 * frame.wires[k].radius[0]),
                    palette::ink);
    }
    if (facts.widened) {
        y += 16 * unit;
        canvas.text(font, x + 36 * unit, y, size, fmt::format("drawn at least {:.2g} pixels wide", facts.least_pixels),
                    palette::faint_ink);
    }
    if (!facts.ruler) return y;
    y += 20 * unit;
    canvas.ring(x + 14 * unit, y - 4 * unit, 5.5 * unit, 2 * unit, palette::accent);
    canvas.text(font, x + 36 * unit, y, size, "tip", palette::ink);
    if (!facts.target) return y;
    y += 20 * unit;
    canvas.ring(x + 14 * unit, y - 4 * unit, 5.5 * unit, 2 * unit, palette::target);
    canvas.text(font, x + 36 * unit, y, size, "target: " + facts.target->name, palette::ink);
    return y;
}

/// A bar of colours with three labels under it.
struct ColourBar {
    std::string title, middle, top;
    Rgb (*colour)(double);
};

void draw_colour_bar(Canvas& canvas, const Font& font, const ColourBar& bar, double unit, double x, double y, double width)
{
    const double size = 12 * unit, height = std::round(12 * unit);
    y += 26 * unit;
    canvas.text(font, x, y, size, bar.title, palette::ink);
    // whole pixels: a column shared by two colours would be neither
    x = std::round(x), y = std::round(y + 8 * unit), width = std::round(width);
    for (int column = 0; column < static_cast<int>(width); ++column) {
        const auto c = srgb_bytes(bar.colour((column + 0.5) / width));
        canvas.fill(x + column, y, 1, height, (c[0] << 16) | (c[1] << 8) | c[2]);
    }
    canvas.frame(x, y, width, height, std::max(1.0, 0.8 * unit), palette::faint_ink, 0.8);
    const std::string labels[] = {"0", bar.middle, bar.top};
    for (int k = 0; k <= 2; ++k) {
        const double at = x + 0.5 * k * width, wide = Canvas::text_width(font, size, labels[k]);
        canvas.fill(at - (k == 2 ? unit : 0), y + height, unit, 4 * unit, palette::faint_ink);
        canvas.text(font, at - 0.5 * k * wide, y + height + 17 * unit, size, labels[k], palette::ink);
    }
}

ColourBar force_bar(double top) { return {"contact force on the wire", force_text(0.5 * top), force_text(top), force_colour}; }

ColourBar load_bar(double top)
{
    return {fmt::format("contact force, over {:.0f} mm", 1e3 * load_window), load_text(0.25 * top), load_text(top), load_colour};
}

ColourBar wall_bar(const WallScale& scale)
{
    const char* title = scale.quantity == WallQuantity::Stress ? "von Mises stress of the wall" : "displacement of the wall";
    return {title, wall_text(scale.quantity, 0.5 * scale.top),
            (scale.beyond ? "\u2265 " : "") + wall_text(scale.quantity, scale.top), wall_colour};
}

}  // namespace

std::uint32_t instrument_colour(const WireFrame& frame, std::size_t k)
{
    return frame.wires[k].name.empty() ? palette::wire : palette::instruments[k % std::size(palette::instruments)];
}

double round_up_125(double value) { return round_up(value, {1, 2, 5}); }
double round_force_up(double value) { return round_up(value, {1, 1.2, 1.6, 2, 2.4, 3, 4, 5, 6, 8}); }

Layout lay_out_sheet(int width, int height, const Look& look)
{
    Layout layout;
    layout.main = {0, 0, width, height};
    layout.side_panel = width >= 1.15 * height;
    layout.unit = layout.side_panel ? std::min(height / 720.0, width / 1000.0) : std::min(width / 720.0, height / 900.0);
    layout.panel_dropped = layout.unit < 0.4;  // letters under 6 pixels
    if (!look.legend || layout.panel_dropped) return layout;
    const int across = static_cast<int>(std::lround(290 * layout.unit)), gap = static_cast<int>(std::lround(18 * layout.unit));
    if (layout.side_panel) {
        layout.main.width = width - across;
        layout.panel = {width - across, 0, across, height};
        layout.inset = {width - across + gap / 3, gap, across - gap - gap / 3, across - gap - gap / 3};
    } else {
        layout.main.height = height - across;
        layout.panel = {0, height - across, width, across};
        layout.inset = {gap, height - across + gap / 3, across - gap - gap / 3, across - gap - gap / 3};
    }
    return layout;
}

void draw_legend(Canvas& canvas, const Font& font, const LegendFacts& facts)
{
    const Layout& layout = facts.layout;
    const double unit = layout.unit;
    if (facts.ruler) draw_scale_bar(canvas, font, facts.main_camera, layout.main, unit, 0.12);
    if (!facts.cube.empty()) draw_cube(canvas, font, facts);
    if (facts.ruler) draw_marks(canvas, facts, facts.main_camera, layout.main);
    double x = layout.panel.x + 6 * unit, y = layout.panel.y + 14 * unit, width = layout.panel.width - 24 * unit;
    if (facts.inset) {
        draw_inset(canvas, font, facts);
        if (layout.side_panel) {
            y = layout.inset.y + layout.inset.height + 12 * unit;
        } else {
            x = layout.inset.x + layout.inset.width + 24 * unit;
        }
    } else if (!layout.side_panel) {
        x += 18 * unit;
    }
    if (!layout.side_panel) width = std::min(260 * unit, layout.panel.x + layout.panel.width - x - 18 * unit);
    y = draw_readings(canvas, font, facts, x, y, width);
    y = draw_wire_key(canvas, font, facts, x, y);
    if (facts.wall_scale.top > 0) draw_colour_bar(canvas, font, wall_bar(facts.wall_scale), unit, x, y, width);
    else if (facts.load_scale > 0) draw_colour_bar(canvas, font, load_bar(facts.load_scale), unit, x, y, width);
    else if (facts.force_scale > 0) draw_colour_bar(canvas, font, force_bar(facts.force_scale), unit, x, y, width);
}

}  // namespace seldinger
