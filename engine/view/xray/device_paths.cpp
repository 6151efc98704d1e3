// Rays against tapered cylinders, pixel by pixel of their shadow.
#include "view/xray/device_paths.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

constexpr int band_rows = 16;
constexpr double rays_across = 24;

struct Piece {
    Vec3 begin, end, axis;                     // axis: unit
    Vec3 begin_cut, end_cut;                   // normals of the planes that bound it
    double radius, lumen, taper, taper_lumen;  // at begin, and per metre
    CArmPoint at[2];
    double reach;  // half thickness on the detector [pixels]
    int grid;      // rays per pixel's side
    int material;
    float value;
};

/// The plane that halves a kink; square to the piece where it turns back on itself.
Vec3 cut_between(const Vec3& axis, const Vec3& neighbour)
{
    return axis.dot(neighbour) > 0.2 ? Vec3((axis + neighbour).normalized()) : axis;
}

void add_pieces(const CArmView& view, const Device& device, std::vector<Piece>& pieces)
{
    std::vector<Piece> own;
    for (std::size_t i = 0; i + 1 < device.size(); ++i) {
        const DeviceStation &a = device[i], &b = device[i + 1];
        const double length = (b.place - a.place).norm();
        if (!(length > 1e-9)) continue;
        Piece p{a.place,
                b.place,
                (b.place - a.place) / length,
                Vec3::Zero(),
                Vec3::Zero(),
                a.radius,
                a.lumen,
                (b.radius - a.radius) / length,
                (b.lumen - a.lumen) / length,
                {project(view, a.place), project(view, b.place)},
                0,
                0,
                a.material,
                0.5f * (a.value + b.value)};
        if (std::abs(p.taper) > 0.5) p.radius = 0.5 * (a.radius + b.radius), p.taper = 0;  // a step, not a taper
        for (const CArmPoint& at : p.at)
            if (!(at.depth > 1e-3 && at.depth < view.sid))
                throw Error(ExitCode::BadScene,
                            "the C-arm is inside what it looks at: an instrument is not between source and detector; make --sod "
                            "or --sid larger");
        const double thick = std::max(a.radius, b.radius), thin = std::min(a.radius, b.radius);
        const double scale = std::max(p.at[0].magnification, p.at[1].magnification) / view.pixel;
        p.reach = 1.05 * thick * scale + 0.75;
        p.grid = static_cast<int>(std::clamp(std::ceil(rays_across / (2 * thin * scale)), 2.0, 24.0));
        own.push_back(p);
    }
    for (std::size_t i = 0; i < own.size(); ++i) {
        own[i].begin_cut = i > 0 ? cut_between(own[i].axis, own[i - 1].axis) : own[i].axis;
        own[i].end_cut = i + 1 < own.size() ? cut_between(own[i].axis, own[i + 1].axis) : own[i].axis;
    }
    pieces.insert(pieces.end(), own.begin(), own.end());
}

struct Chord {
    double from, to;
};

/// Where |p|^2 - a^2 <= (r + k a)^2 along p = at + t ray, a = p.axis.
Chord inside_cone(const Vec3& at, const Vec3& ray, const Vec3& axis, double r, double k)
{
    constexpr double far = std::numeric_limits<double>::max();
    const double along = ray.dot(axis), a0 = at.dot(axis), here = r + k * a0;
    const double a = ray.squaredNorm() - along * along * (1 + k * k);
    const double b = at.dot(ray) - along * a0 - here * k * along;
    const double c = at.squaredNorm() - a0 * a0 - here * here;
    if (a < 1e-12) return c < 0 ? Chord{-far, far} : Chord{0, 0};  // along the axis
    const double disc = b * b - a * c;
    if (disc <= 0) return {0, 0};
    const double root = std::sqrt(disc);
    return {(-b - root) / a, (-b + root) / a};
}

void cut(Chord& chord, const Vec3& at, const Vec3& ray, const Vec3& normal)  // keeps normal.(at + t ray) >= 0
{
    const double rate = normal.dot(ray), height = normal.dot(at);
    if (rate > 0) chord.from = std::max(chord.from, -height / rate);
    else if (rate < 0) chord.to = std::min(chord.to, -height / rate);
    else if (height < 0) chord.to = chord.from;
}

/// Length of a ray in a piece, without its lumen.
double solid_length(const CArmView& view, const Piece& p, double u, double v)
{
    const Vec3 ray = view.direction + u * view.right + v * view.up;
    // from near the piece, so that no digits are lost over the distance to the source
    const Vec3 from_begin = view.source - p.begin + 0.5 * (p.at[0].depth + p.at[1].depth) * ray;
    const Vec3 from_end = from_begin + p.begin - p.end;
    const auto length = [&](double radius, double taper) {
        Chord chord = inside_cone(from_begin, ray, p.axis, radius, taper);
        if (chord.to <= chord.from) return 0.0;
        cut(chord, from_begin, ray, p.begin_cut);
        cut(chord, from_end, ray, -p.end_cut);
        return std::max(0.0, chord.to - chord.from);
    };
    const double outer = length(p.radius, p.taper);
    const double inner = outer > 0 && p.lumen > 0 ? length(p.lumen, p.taper_lumen) : 0.0;
    return (outer - inner) * ray.norm();
}

/// Columns of a row that may lie in the piece's shadow.
bool columns_in(const Piece& p, int row, int count, int& first, int& last)
{
    const CArmPoint &a = p.at[0], &b = p.at[1];
    const double rise = b.row - a.row;
    double from = 0, to = 1;
    if (std::abs(rise) > 1e-9) {
        const double t0 = (row - p.reach - a.row) / rise, t1 = (row + p.reach - a.row) / rise;
        from = std::max(0.0, std::min(t0, t1)), to = std::min(1.0, std::max(t0, t1));
    } else if (std::abs(row - a.row) > p.reach) {
        return false;
    }
    if (from > to) return false;
    const double x0 = a.column + from * (b.column - a.column), x1 = a.column + to * (b.column - a.column);
    const double low = std::max(0.0, std::ceil(std::min(x0, x1) - p.reach));
    const double high = std::min(count - 1.0, std::floor(std::max(x0, x1) + p.reach));
    if (!(low <= high)) return false;
    first = static_cast<int>(low), last = static_cast<int>(high);
    return true;
}

/// Whether the pixel is near enough to the shadow's axis to be looked at.
bool near_axis(const Piece& p, int row, int column)
{
    const double ex = p.at[1].column - p.at[0].column, ey = p.at[1].row - p.at[0].row;
    const double x = column - p.at[0].column, y = row - p.at[0].row, square = ex * ex + ey * ey;
    const double t = square > 0 ? std::clamp((x * ex + y * ey) / square, 0.0, 1.0) : 0.0;
    const double dx = x - t * ex, dy = y - t * ey;
    return dx * dx + dy * dy <= p.reach * p.reach;
}

void trace_row(const CArmView& view, const Piece& p, int row, std::vector<DevicePath>& out)
{
    int first = 0, last = -1;
    if (!columns_in(p, row, view.columns, first, last)) return;
    for (int column = first; column <= last; ++column) {
        if (!near_axis(p, row, column)) continue;
        double sum = 0;
        for (int i = 0; i < p.grid; ++i)
            for (int j = 0; j < p.grid; ++j)
                sum += solid_length(view, p, view.u(column + (j + 0.5) / p.grid - 0.5), view.v(row + (i + 0.5) / p.grid - 0.5));
        if (sum > 0)
            out.push_back({row * view.columns + column, p.material, static_cast<float>(sum / (p.grid * p.grid)), p.value});
    }
}

}  // namespace

std::vector<DevicePath> trace_devices(const CArmView& view, const std::vector<Device>& devices)
{
    std::vector<Piece> pieces;
    for (const Device& device : devices) add_pieces(view, device, pieces);
    const int count = (view.rows + band_rows - 1) / band_rows;
    std::vector<std::vector<DevicePath>> found(count);
    for_each_item(count, 1, [&](int k) {
        const int first = k * band_rows, last = std::min(first + band_rows, view.rows) - 1;
        for (const Piece& p : pieces) {
            const auto [low, high] = std::minmax(p.at[0].row, p.at[1].row);
            const double from = std::max<double>(first, std::ceil(low - p.reach)),
                         to = std::min<double>(last, std::floor(high + p.reach));
            for (double row = from; row <= to; ++row) trace_row(view, p, static_cast<int>(row), found[k]);
        }
    });
    std::vector<DevicePath> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace seldinger
