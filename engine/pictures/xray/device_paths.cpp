// Rays against tapered cylinders, pixel by pixel of their shadow.
#include "xray/device_paths.h"

#include "core/check.h"
#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

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
                throw Error(ErrorKind::BadScene,
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

/// A vector of a piece's own axes, the third along it, as a ray (u, v) turns it: c + u du + v dv.
struct Turning {
    Vec3 c, du, dv;
    [[nodiscard]] double at(int k, double u, double v) const { return c[k] + u * du[k] + v * dv[k]; }
};

/// Constants of a piece for all rays.
struct PieceRays {
    Turning ray;  // per metre of depth
    Turning from;  // from the piece's beginning to the ray at the piece's mean depth, so that no digits are lost over the
                   // source's distance
    Vec3 begin_cut, end_cut;
    double length, mean_depth;

    PieceRays(const CArmView& view, const Piece& p)
    {
        const Vec3 across = p.axis.unitOrthogonal();
        const Mat3 own = Mat3::rows(across, p.axis.cross(across), p.axis);
        ray = {own * view.direction, own * view.right, own * view.up};
        mean_depth = 0.5 * (p.at[0].depth + p.at[1].depth);
        from = {own * (view.source - p.begin) + mean_depth * ray.c, mean_depth * ray.du, mean_depth * ray.dv};
        begin_cut = own * p.begin_cut, end_cut = own * p.end_cut;
        length = (p.end - p.begin).norm();
    }
};

struct Chord {
    double from, to;
};

constexpr double far = std::numeric_limits<double>::max();

/// Keeps height + t rate >= 0.
inline void cut(Chord& chord, double height, double rate)
{
    const double at = -height / rate;
    chord.from = rate > 0 ? std::max(chord.from, at) : chord.from;
    chord.to = rate < 0 ? std::min(chord.to, at) : chord.to;
    chord.to = rate == 0 && height < 0 ? -far : chord.to;
}

/// Where a ray is inside of |p|^2 - a^2 <= (r + k a)^2, a along the axis, between the cuts: depths from the piece's mean depth.
inline Chord chord_inside(const PieceRays& rays, double u, double v, double radius, double taper)
{
    const double wx = rays.ray.at(0, u, v), wy = rays.ray.at(1, u, v), wz = rays.ray.at(2, u, v);
    const double x = rays.from.at(0, u, v), y = rays.from.at(1, u, v), z = rays.from.at(2, u, v);
    const double here = radius + taper * z, slope = taper * wz;
    const double a = wx * wx + wy * wy - slope * slope, b = x * wx + y * wy - here * slope, c = x * x + y * y - here * here;
    const double disc = b * b - a * c, root = std::sqrt(std::max(disc, 0.0));
    const bool along = a < 1e-12;  // the ray runs along the axis
    Chord chord{along ? -far : (-b - root) / a, along ? far : (-b + root) / a};
    cut(chord, rays.begin_cut.x() * x + rays.begin_cut.y() * y + rays.begin_cut.z() * z,
        rays.begin_cut.x() * wx + rays.begin_cut.y() * wy + rays.begin_cut.z() * wz);
    cut(chord, -(rays.end_cut.x() * x + rays.end_cut.y() * y + rays.end_cut.z() * (z - rays.length)),
        -(rays.end_cut.x() * wx + rays.end_cut.y() * wy + rays.end_cut.z() * wz));
    chord.to = (along ? -c : disc) > 0 ? chord.to : -far;
    return chord;
}

inline double depth_inside(const PieceRays& rays, double u, double v, double radius, double taper)
{
    const Chord chord = chord_inside(rays, u, v, radius, taper);
    return std::max(0.0, chord.to - chord.from);
}

/// A pixel's rays, row by row, as offsets of (u, v) from its middle.
struct PixelGrid {
    std::vector<double> u, v;

    PixelGrid(const CArmView& view, int side)
    {
        const double per_pixel = view.pixel / view.sid;
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                u.push_back(((j + 0.5) / side - 0.5) * per_pixel);
                v.push_back((0.5 - (i + 0.5) / side) * per_pixel);
            }
    }
};

/// Adds the lengths of a pixel's rays in a tapered cylinder. @param rays  by value: its own memory lets the loop be vectorised
/// @param at  the pixel's middle  @param sign  -1: of a lumen
void add_lengths(const PieceRays rays, double radius, double taper, const PixelGrid& grid, const Vec2& at, double sign,
                 std::vector<double>& length)
{
    const double u = at.x(), v = at.y(), *du = grid.u.data(), *dv = grid.v.data();
    double* out = length.data();
    const auto count = static_cast<int>(length.size());
    for (int k = 0; k < count; ++k) {
        const double uk = u + du[k], vk = v + dv[k];
        out[k] += sign * depth_inside(rays, uk, vk, radius, taper) * std::sqrt(1 + uk * uk + vk * vk);
    }
}

/// Mean length of a pixel's rays in a piece, without its lumen.
double mean_length(const PieceRays& rays, const Piece& p, const PixelGrid& grid, const Vec2& at)
{
    std::vector<double> length(grid.u.size());
    add_lengths(rays, p.radius, p.taper, grid, at, 1, length);
    if (p.lumen > 0) add_lengths(rays, p.lumen, p.taper_lumen, grid, at, -1, length);
    double sum = 0;
    for (const double l : length) sum += std::max(0.0, l);
    return sum / static_cast<double>(length.size());
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

/// Whether the pixel is near enough to the shadow's axis to be computed.
bool near_axis(const Piece& p, int row, int column)
{
    const double ex = p.at[1].column - p.at[0].column, ey = p.at[1].row - p.at[0].row;
    const double x = column - p.at[0].column, y = row - p.at[0].row, square = ex * ex + ey * ey;
    const double t = square > 0 ? std::clamp((x * ex + y * ey) / square, 0.0, 1.0) : 0.0;
    const double dx = x - t * ex, dy = y - t * ey;
    return dx * dx + dy * dy <= p.reach * p.reach;
}

// A pixel's rays of a mask are the bits of one word. Odd, so that the ray in the middle decides about an edge through it: an even
// grid would take an edge along the rows for covered from 7/16 on.
constexpr int cover_side = 7;

/// Coverage of one row of pixels by one device.
struct RowCover {
    std::vector<std::uint64_t> rays;  // [columns] bits of those that meet it
    std::vector<float> nearest;       // [columns] depth of its nearest surface [m]
    int first, last;                  // columns that may have bits

    explicit RowCover(int columns) : rays(columns), nearest(columns), first(columns), last(-1) {}
    void clear()
    {
        for (int c = first; c <= last; ++c) rays[c] = 0;
        first = static_cast<int>(rays.size()), last = -1;
    }
};

/// Rays of a pixel that meet a piece. @param length  scratch, one for each ray
std::uint64_t rays_that_meet(const PieceRays& rays, const Piece& p, const PixelGrid& grid, const Vec2& at,
                             std::vector<double>& length)
{
    std::fill(length.begin(), length.end(), 0.0);
    add_lengths(rays, p.radius, p.taper, grid, at, 1, length);
    std::uint64_t bits = 0;
    for (int k = 0; k < cover_side * cover_side; ++k) bits |= static_cast<std::uint64_t>(length[k] > 0) << k;
    return bits;
}

float nearest_depth(const PieceRays& rays, const Piece& p, const PixelGrid& grid, double u, double v)
{
    double nearest = far;
    for (std::size_t k = 0; k < grid.u.size(); ++k) {
        const Chord chord = chord_inside(rays, u + grid.u[k], v + grid.v[k], p.radius, p.taper);
        if (chord.to > chord.from) nearest = std::min(nearest, chord.from);
    }
    return static_cast<float>(rays.mean_depth + nearest);
}

/// Pieces of all instruments and what each row of rays meets of them.
class PieceTracer {
public:
    PieceTracer(const CArmView& view, const std::vector<Piece>& pieces) : view_(view), pieces_(pieces)
    {
        for (const Piece& p : pieces) {
            rays_.emplace_back(view, p);
            grids_.try_emplace(p.grid, view, p.grid);
        }
    }

    /// Pieces that may lie in the shadow on these rows.
    [[nodiscard]] std::vector<int> pieces_on(int first, int last) const
    {
        std::vector<int> found;
        for (std::size_t k = 0; k < pieces_.size(); ++k) {
            const auto [low, high] = std::minmax(pieces_[k].at[0].row, pieces_[k].at[1].row);
            if (low - pieces_[k].reach <= last && high + pieces_[k].reach >= first) found.push_back(static_cast<int>(k));
        }
        return found;
    }

    void trace_row(int piece, int row, std::vector<DevicePath>& out) const
    {
        const Piece& p = pieces_[piece];
        const PixelGrid& grid = grids_.at(p.grid);
        int first = 0, last = -1;
        if (!columns_in(p, row, view_.columns, first, last)) return;
        for (int column = first; column <= last; ++column) {
            if (!near_axis(p, row, column)) continue;
            const auto length = static_cast<float>(mean_length(rays_[piece], p, grid, {view_.u(column), view_.v(row)}));
            if (length > 0) out.push_back({row * view_.columns + column, p.material, length, p.value});
        }
    }

    void cover_row(int piece, int row, const PixelGrid& grid, bool with_depth, RowCover& cover) const
    {
        const Piece& p = pieces_[piece];
        int first = 0, last = -1;
        if (!columns_in(p, row, view_.columns, first, last)) return;
        std::vector<double> length(cover_side * cover_side);
        for (int column = first; column <= last; ++column) {
            if (!near_axis(p, row, column)) continue;
            const double u = view_.u(column), v = view_.v(row);
            const std::uint64_t bits = rays_that_meet(rays_[piece], p, grid, {u, v}, length);
            if (bits == 0) continue;
            if (with_depth) {
                const float depth = nearest_depth(rays_[piece], p, grid, u, v);
                cover.nearest[column] = cover.rays[column] == 0 ? depth : std::min(cover.nearest[column], depth);
            }
            cover.rays[column] |= bits;
            cover.first = std::min(cover.first, column), cover.last = std::max(cover.last, column);
        }
    }

private:
    const CArmView& view_;
    const std::vector<Piece>& pieces_;
    std::vector<PieceRays> rays_;
    std::map<int, PixelGrid> grids_;
};

/// Devices from the thickest to the thinnest.
std::vector<std::size_t> outermost_first(const std::vector<Device>& devices)
{
    std::vector<double> thickest(devices.size());
    for (std::size_t k = 0; k < devices.size(); ++k)
        for (const DeviceStation& s : devices[k]) thickest[k] = std::max(thickest[k], s.radius);
    std::vector<std::size_t> order(devices.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return thickest[a] > thickest[b]; });
    return order;
}

/// Writes a device's label where it covers half of a pixel.
void label_row(const RowCover& cover, std::uint8_t label, std::size_t begin, DeviceMask& mask)
{
    for (int column = cover.first; column <= cover.last; ++column) {
        if (2 * std::popcount(cover.rays[column]) < cover_side * cover_side) continue;
        mask.label[begin + static_cast<std::size_t>(column)] = label;
        if (!mask.depth.empty()) mask.depth[begin + static_cast<std::size_t>(column)] = cover.nearest[column];
    }
}

}  // namespace

std::vector<DevicePath> trace_devices(const CArmView& view, const std::vector<Device>& devices)
{
    std::vector<Piece> pieces;
    for (const Device& device : devices) add_pieces(view, device, pieces);
    const PieceTracer tracer(view, pieces);
    const int count = (view.rows + band_rows - 1) / band_rows;
    std::vector<std::vector<DevicePath>> found(count);
    for_each_item(count, 1, [&](int k) {
        const int first = k * band_rows, last = std::min(first + band_rows, view.rows) - 1;
        const std::vector<int> on = tracer.pieces_on(first, last);
        for (int row = first; row <= last; ++row)
            for (const int piece : on) tracer.trace_row(piece, row, found[k]);
    });
    std::vector<DevicePath> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

DeviceMask mask_devices(const CArmView& view, const std::vector<Device>& devices, bool with_depth)
{
    SEL_ASSERT(devices.size() < 256);
    std::vector<std::vector<Piece>> pieces(devices.size());
    std::vector<PieceTracer> tracers;
    for (std::size_t k = 0; k < devices.size(); ++k) {
        add_pieces(view, devices[k], pieces[k]);
        tracers.emplace_back(view, pieces[k]);
    }
    const std::vector<std::size_t> order = outermost_first(devices);
    const PixelGrid grid(view, cover_side);
    const std::size_t count = static_cast<std::size_t>(view.rows) * view.columns;
    DeviceMask mask{std::vector<std::uint8_t>(count), std::vector<float>(with_depth ? count : 0)};
    for_each_item((view.rows + band_rows - 1) / band_rows, 1, [&](int band) {
        const int first = band * band_rows, last = std::min(first + band_rows, view.rows) - 1;
        RowCover cover(view.columns);
        for (const std::size_t k : order) {
            const std::vector<int> on = tracers[k].pieces_on(first, last);
            for (int row = first; row <= last && !on.empty(); ++row) {
                for (const int piece : on) tracers[k].cover_row(piece, row, grid, with_depth, cover);
                label_row(cover, static_cast<std::uint8_t>(k + 1), static_cast<std::size_t>(row) * view.columns, mask);
                cover.clear();
            }
        }
    });
    return mask;
}

}  // namespace seldinger
