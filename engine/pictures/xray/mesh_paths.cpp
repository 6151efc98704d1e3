// Rasterises depths in bands of rows.
#include "xray/mesh_paths.h"

#include "core/error.h"
#include "core/parallel.h"
#include "vessel/mesh_edges.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace seldinger {
namespace {

constexpr int sub_bits = 12, rows_per_band = 16;
constexpr std::int64_t sub = 1 << sub_bits;
constexpr double most_pixels = 1 << 18;  // beyond, corners leave 32 bits and their products 64

struct Corner {
    std::int64_t x, y;  // [pixel / sub]
    double inverse;     // 1/depth [1/m]
};

/// All corners of a mesh. Faces find them in any order: what most are looked up for is kept small and apart.
struct Corners {
    struct Place {
        std::int32_t x, y;  // [pixel / sub]
    };
    std::vector<Place> place;
    std::vector<double> inverse;

    [[nodiscard]] Corner operator[](std::int32_t k) const { return {place[k].x, place[k].y, inverse[k]}; }
};

struct Hit {
    std::int32_t pixel;
    float depth, value;
    int sign;
};

/// Rows whose pixel centres lie in [low, high].
struct Rows {
    int first, last;
};

Rows rows_of(std::int64_t low, std::int64_t high, int count)
{
    const std::int64_t first = (low + sub - 1) >> sub_bits, last = high >> sub_bits;
    return {static_cast<int>(std::clamp<std::int64_t>(first, 0, count)),
            static_cast<int>(std::clamp<std::int64_t>(last, -1, count - 1))};
}

Corners project_corners(const CArmView& view, const WallMesh& mesh)
{
    Corners corners;
    corners.place.resize(mesh.vertices.size()), corners.inverse.resize(mesh.vertices.size());
    std::vector<char> outside(mesh.vertices.size());
    for_each_item(static_cast<int>(outside.size()), 4096, [&](int i) {
        const CArmPoint at = project(view, mesh.vertices[i]);
        outside[i] = !(at.depth > 1e-3 && at.depth < view.sid);
        outside[i] |= 2 * !(std::abs(at.column) < most_pixels && std::abs(at.row) < most_pixels);
        if (outside[i]) return;
        corners.place[i] = {static_cast<std::int32_t>(std::llround(at.column * sub)),
                            static_cast<std::int32_t>(std::llround(at.row * sub))};
        corners.inverse[i] = 1 / at.depth;
    });
    const int worst = outside.empty() ? 0 : *std::max_element(outside.begin(), outside.end());
    if (worst == 2)
        throw Error(ErrorKind::BadScene,
                    "--field: the pixels are too small for what is looked at; expected a wider field or fewer pixels");
    if (worst > 0)
        throw Error(
            ErrorKind::BadScene,
            "the C-arm is inside what it looks at: part of it is not between source and detector; make --sod or --sid larger");
    return corners;
}

/// Faces of each band of rows that may cover a pixel's centre, in their order.
struct Bands {
    std::vector<std::int32_t> first, face;
};

Bands deal_faces(const WallMesh& mesh, const std::vector<Corners::Place>& places, int columns, int rows)
{
    const int count = (rows + rows_per_band - 1) / rows_per_band;
    std::vector<Rows> span(mesh.triangles.size());
    for_each_item(static_cast<int>(span.size()), 4096, [&](int t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const auto [low, high] = std::minmax({places[a].y, places[b].y, places[c].y});
        const auto [left, right] = std::minmax({places[a].x, places[b].x, places[c].x});
        const Rows across = rows_of(left, right, columns);
        // of a fine mesh most faces lie between the centres
        span[t] = across.first > across.last ? Rows{0, -1} : rows_of(low, high, rows);
    });
    Bands bands;
    bands.first.assign(count + 1, 0);
    for (const Rows& s : span)
        for (int k = s.first / rows_per_band; s.first <= s.last && k <= s.last / rows_per_band; ++k) ++bands.first[k + 1];
    for (int k = 0; k < count; ++k) bands.first[k + 1] += bands.first[k];
    bands.face.resize(bands.first.back());
    std::vector<std::int32_t> next(bands.first.begin(), bands.first.end() - 1);
    for (std::size_t t = 0; t < span.size(); ++t)
        for (int k = span[t].first / rows_per_band; span[t].first <= span[t].last && k <= span[t].last / rows_per_band; ++k)
            bands.face[next[k]++] = static_cast<std::int32_t>(t);
    return bands;
}

/// a x + b y + c >= 0 on the inner side of an edge; a point on a top or a left edge is inside.
struct Edge {
    std::int64_t a, b, c;
    Edge(const Corner& p, const Corner& q) : a(p.y - q.y), b(q.x - p.x), c(-a * p.x - b * p.y)
    {
        const bool keeps = a > 0 || (a == 0 && b > 0);
        if (!keeps) c -= 1;
    }
    [[nodiscard]] std::int64_t at(std::int64_t x, std::int64_t y) const { return a * x + b * y + c; }
};

/// A function linear on the detector with given values in three corners.
struct Plane {
    double dx, dy, c;
    Plane(const Corner* v[3], double f0, double f1, double f2)
    {
        const double x1 = static_cast<double>(v[1]->x - v[0]->x), y1 = static_cast<double>(v[1]->y - v[0]->y);
        const double x2 = static_cast<double>(v[2]->x - v[0]->x), y2 = static_cast<double>(v[2]->y - v[0]->y);
        const double area = x1 * y2 - x2 * y1;
        dx = ((f1 - f0) * y2 - (f2 - f0) * y1) / area * sub;
        dy = ((f2 - f0) * x1 - (f1 - f0) * x2) / area * sub;
        c = f0 - (dx * static_cast<double>(v[0]->x) + dy * static_cast<double>(v[0]->y)) / sub;
    }
};

/// Pixels of a row that lie on the inner side of all three edges: [first, last].
Rows columns_of(const Edge (&edges)[3], int row, Rows box)
{
    for (const Edge& e : edges) {
        const std::int64_t at0 = e.at(0, row * sub), step = e.a * sub;  // at0 + step * column >= 0
        if (step > 0) {
            const std::int64_t need = at0 >= 0 ? -(at0 / step) : (-at0 + step - 1) / step;
            box.first = static_cast<int>(std::max<std::int64_t>(box.first, need));
        } else if (step < 0) {
            const std::int64_t most = at0 >= 0 ? at0 / -step : -1;
            box.last = static_cast<int>(std::min<std::int64_t>(box.last, most));
        } else if (at0 < 0) {
            box.last = -1;
        }
        if (box.first > box.last) return {0, -1};
    }
    return box;
}

/// Output of one band of rows.
struct Band {
    int first, last;  // rows
    std::vector<std::int16_t> crossings;
    std::vector<Hit> hits;
};

class Raster {
public:
    Raster(const CArmView& view, const WallMesh& mesh, std::span<const float> value)
        : view_(view),
          mesh_(mesh),
          value_(value),
          corners_(project_corners(view, mesh)),
          facing_(view.right.cross(view.up).dot(view.direction) > 0 ? 1 : -1)
    {
    }

    void face(std::int32_t t, Band& band, std::vector<float>& sum) const
    {
        const auto& corner = mesh_.triangles[t];
        const Corner own[3] = {corners_[corner[0]], corners_[corner[1]], corners_[corner[2]]};
        const Corner* v[3] = {&own[0], &own[1], &own[2]};
        const std::int64_t area = (v[1]->x - v[0]->x) * (v[2]->y - v[0]->y) - (v[2]->x - v[0]->x) * (v[1]->y - v[0]->y);
        if (area == 0) return;
        const int turn = area > 0 ? 1 : -1;
        const Edge edges[3] = {edge(v, 0, 1, turn), edge(v, 1, 2, turn), edge(v, 2, 0, turn)};
        // Seen from behind the detector, as X-rays are, the normal, into the lumen, faces the source where corners turn from
        // columns to rows: there the ray leaves. An ordinary camera sees it the other way round.
        const int sign = facing_ * turn;
        const auto [x_low, x_high] = std::minmax({v[0]->x, v[1]->x, v[2]->x});
        const auto [y_low, y_high] = std::minmax({v[0]->y, v[1]->y, v[2]->y});
        const Rows box = rows_of(x_low, x_high, view_.columns), rows = rows_of(y_low, y_high, view_.rows);
        const Plane inverse(v, v[0]->inverse, v[1]->inverse, v[2]->inverse);
        for (int row = std::max(rows.first, band.first); row <= std::min(rows.last, band.last); ++row) {
            const Rows span = columns_of(edges, row, box);
            add_span(row, span, sign, inverse, band, sum);
            if (!value_.empty()) keep_hits(row, span, sign, inverse, v, corner, band);
        }
    }

private:
    static Edge edge(const Corner* v[3], int i, int j, int turn) { return turn > 0 ? Edge(*v[i], *v[j]) : Edge(*v[j], *v[i]); }

    void add_span(int row, Rows span, int sign, const Plane& inverse, Band& band, std::vector<float>& sum) const
    {
        const double start = inverse.c + inverse.dy * row;
        float* out = sum.data() + static_cast<std::size_t>(row) * view_.columns;
        std::int16_t* crossed = band.crossings.data() + static_cast<std::size_t>(row - band.first) * view_.columns;
        for (int x = span.first; x <= span.last; ++x) {
            out[x] += static_cast<float>(sign * (1 / (start + inverse.dx * x) - view_.sod));
            crossed[x] = static_cast<std::int16_t>(crossed[x] + sign);
        }
    }

    void keep_hits(int row, Rows span, int sign, const Plane& inverse, const Corner* v[3],
                   const std::array<std::int32_t, 3>& corner, Band& band) const
    {
        const Plane over(v, value_[corner[0]] * v[0]->inverse, value_[corner[1]] * v[1]->inverse,
                         value_[corner[2]] * v[2]->inverse);
        for (int x = span.first; x <= span.last; ++x) {
            const double depth = 1 / (inverse.c + inverse.dy * row + inverse.dx * x);
            const double value = depth * (over.c + over.dy * row + over.dx * x);
            band.hits.push_back(
                {row * view_.columns + x, static_cast<float>(depth - view_.sod), static_cast<float>(value), sign});
        }
    }

    const CArmView& view_;
    const WallMesh& mesh_;
    std::span<const float> value_;
    Corners corners_;
    int facing_;  // of the view: 1 as an X-ray, -1 as a camera

public:
    [[nodiscard]] const std::vector<Corners::Place>& places() const { return corners_.place; }
};

/// Metres of ray per metre of depth.
double obliquity(const CArmView& view, int row, int column)
{
    const double u = view.u(column), v = view.v(row);
    return std::sqrt(1 + u * u + v * v);
}

/// By pixel, those of a pixel by depth; of equals, in the order that they were met.
std::vector<Hit> sorted_hits(const Band& band, int columns)
{
    const int begin = band.first * columns, pixels = (band.last - band.first + 1) * columns;
    std::vector<std::int32_t> next(pixels + 1);
    for (const Hit& hit : band.hits) ++next[hit.pixel - begin + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    const std::vector<std::int32_t> first = next;
    std::vector<Hit> sorted(band.hits.size());
    for (const Hit& hit : band.hits) {
        std::int32_t at = next[hit.pixel - begin]++;
        // a ray meets a few faces: each is carried to its place
        for (; at > first[hit.pixel - begin] && sorted[at - 1].depth > hit.depth; --at) sorted[at] = sorted[at - 1];
        sorted[at] = hit;
    }
    return sorted;
}

/// Pairs the hits along each ray. Where lumens overlap a stretch counts as often as it is inside.
std::vector<PathInterval> pair_hits(const CArmView& view, const Band& band)
{
    const std::vector<Hit> hits = sorted_hits(band, view.columns);
    std::vector<PathInterval> intervals;
    int inside = 0;
    for (std::size_t i = 0; i + 1 < hits.size(); ++i) {
        const Hit &a = hits[i], &b = hits[i + 1];
        inside -= a.sign;
        if (a.pixel != b.pixel) inside = 0;
        if (inside <= 0 || a.pixel != b.pixel) continue;
        const double q = obliquity(view, a.pixel / view.columns, a.pixel % view.columns);
        intervals.push_back({a.pixel, static_cast<float>(inside * q * (b.depth - a.depth)), a.value, b.value});
    }
    return intervals;
}

/// Depths become lengths; a ray that crosses a wall that is not closed takes its neighbour's.
long finish_rows(const CArmView& view, const Band& band, std::vector<float>& sum)
{
    long mended = 0;
    for (int row = band.first; row <= band.last; ++row)
        for (int x = 0; x < view.columns; ++x) {
            float& out = sum[static_cast<std::size_t>(row) * view.columns + x];
            if (band.crossings[static_cast<std::size_t>(row - band.first) * view.columns + x] != 0) {
                out = x > 0 ? (&out)[-1] : 0.0f;
                ++mended;
            } else if (out != 0) {
                out = std::max(0.0f, static_cast<float>(out * obliquity(view, row, x)));
            }
        }
    return mended;
}

}  // namespace

WallMesh close_openings(const WallMesh& mesh)
{
    WallMesh closed = mesh;
    for (const std::vector<std::int32_t>& loop : boundary_chains(mesh, find_edges(mesh))) {
        Vec3 centre = Vec3::Zero();
        for (const std::int32_t v : loop) centre += mesh.vertices[v] / static_cast<double>(loop.size());
        const auto middle = static_cast<std::int32_t>(closed.vertices.size());
        closed.vertices.push_back(centre);
        // a cap runs along the rim the other way than the wall does
        for (std::size_t k = 0; k < loop.size(); ++k) closed.triangles.push_back({loop[(k + 1) % loop.size()], loop[k], middle});
    }
    return closed;
}

MeshPaths trace_mesh(const CArmView& view, const WallMesh& closed, std::span<const float> value)
{
    MeshPaths paths;
    paths.length.assign(static_cast<std::size_t>(view.rows) * view.columns, 0.0f);
    const Raster raster(view, closed, value);
    const Bands bands = deal_faces(closed, raster.places(), view.columns, view.rows);
    const int count = static_cast<int>(bands.first.size()) - 1;
    std::vector<std::vector<PathInterval>> intervals(count);
    std::vector<long> mended(count);
    for_each_item(count, 1, [&](int k) {
        Band band{k * rows_per_band, std::min((k + 1) * rows_per_band, view.rows) - 1, {}, {}};
        band.crossings.assign(static_cast<std::size_t>(rows_per_band) * view.columns, 0);
        for (std::int32_t i = bands.first[k]; i < bands.first[k + 1]; ++i) raster.face(bands.face[i], band, paths.length);
        mended[k] = finish_rows(view, band, paths.length);
        intervals[k] = pair_hits(view, band);
    });
    for (int k = 0; k < count; ++k) {
        paths.mended += mended[k];
        paths.intervals.insert(paths.intervals.end(), intervals[k].begin(), intervals[k].end());
    }
    return paths;
}

std::vector<float> trace_ellipsoid(const CArmView& view, const Vec3& centre, const Mat3& axes, const Vec3& half)
{
    std::vector<float> length(static_cast<std::size_t>(view.rows) * view.columns);
    // in the ellipsoid's own measure it is the unit ball: |o + t w| <= 1, w = ahead + u right + v up
    const Mat3 own = Mat3::rows(axes.col(0) * (1 / half[0]), axes.col(1) * (1 / half[1]), axes.col(2) * (1 / half[2]));
    const Vec3 o = own * (view.source - centre), ahead = own * view.direction, right = own * view.right, up = own * view.up;
    const double beyond = o.squaredNorm() - 1, right2 = right.squaredNorm(), right_o = right.dot(o);
    for_each_item(view.rows, 8, [&](int row) {
        const double v = view.v(row);
        const Vec3 first = ahead + v * up;  // of the row, u = 0
        const double first2 = first.squaredNorm(), first_o = first.dot(o), cross = 2 * first.dot(right), ray2 = 1 + v * v;
        float* out = length.data() + static_cast<std::size_t>(row) * view.columns;
        const double u0 = view.u(0), du = view.u(1) - u0;
        for (int x = 0; x < view.columns; ++x) {
            const double u = u0 + x * du, a = first2 + u * (cross + u * right2), b = first_o + u * right_o;
            const double disc = std::max(0.0, b * b - a * beyond);
            out[x] = static_cast<float>(2 * std::sqrt(disc) / a * std::sqrt(ray2 + u * u));
        }
    });
    return length;
}

}  // namespace seldinger
