// The surface of a lumen: a net through the cells between voxels, made fair without shrinking.
//
// 1. Net (S. Gibson's surface nets, MICCAI 1998): a point in each cell of eight voxel centres for each sheet of the surface
//    in it, the mean of the crossings on the cell's edges; one quadrilateral for each crossing. A face whose corners alternate
//    keeps its two voxels of the lumen apart, so vessels that meet in an edge stay two. Of a label, crossings are midway
//    between voxels: off by up to half a voxel along their axis, and by 0 in the mean, whatever the curvature.
// 2. Fairing. The mean of a point's neighbours lies inside a bent surface, so averaging shrinks a tube, and so does a net of
//    elastic springs until a bound stops it. Here the way back follows two rounds of averaging: the height of the crossings over
//    their quadrilaterals, averaged along the surface over about four voxels. It is a number for each point, and on a tube the
//    same for all, so a tube of any radius stays; steps of the voxels have a mean height of 0, and go. Variations of the radius
//    within ten voxels are smoothed; no point goes farther than half a voxel along an axis.
// 3. For edges a and b along curvatures k1 and k2, the middle of a quadrilateral lies (k1 a^2 + k2 b^2) / 8 inside a bent surface
//    through its corners, its two facets (k1 a^2 + k2 b^2) / 12 in the mean, and the mean of a point's neighbours
//    (k1 a^2 + k2 b^2) / 4. Step 2 puts middles on the surface; a sixth of the way to the mean of the neighbours puts facets
//    there, and the radius is right.
#include "voxels/voxels.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace seldinger {
namespace {

using Quad = std::array<std::int32_t, 4>;

std::size_t index_of(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Edge 4 a + bu + 2 bv of a cell runs along axis a; u and v are the two axes after a. Corner x + 2 y + 4 z.
constexpr int edge_between(int c, int d)
{
    const int a = (c ^ d) == 1 ? 0 : (c ^ d) == 2 ? 1 : 2, low = c < d ? c : d;
    return 4 * a + (low >> ((a + 1) % 3) & 1) + 2 * (low >> ((a + 2) % 3) & 1);
}
constexpr int low_corner(int edge)
{
    const int a = edge / 4;
    return (edge & 1) << ((a + 1) % 3) | (edge >> 1 & 1) << ((a + 2) % 3);
}

/// Sheets of the surface in a cell, by which of its corners are in the lumen.
struct CellSheets {
    std::int8_t count = 0;
    std::array<std::int8_t, 12> of_edge{};  // -1: no crossing
};

CellSheets sheets_of(int corners)
{
    const auto in = [&](int c) { return corners >> c & 1; };
    std::array<int, 12> up{};
    std::iota(up.begin(), up.end(), 0);
    const auto join = [&](int e, int f) {
        const int from = up[static_cast<std::size_t>(e)], to = up[static_cast<std::size_t>(f)];
        for (int& u : up)
            if (u == from) u = to;
    };
    for (int face = 0; face < 6; ++face) {
        const int a = face / 2, u = 1 << (a + 1) % 3, v = 1 << (a + 2) % 3, base = face % 2 << a;
        const std::array<int, 4> ring = {base, base | u, base | u | v, base | v};
        const auto corner = [&](std::size_t k) { return ring[k % 4]; };
        std::vector<int> crossing;
        for (std::size_t k = 0; k < 4; ++k)
            if (in(corner(k)) != in(corner(k + 1))) crossing.push_back(edge_between(corner(k), corner(k + 1)));
        if (crossing.size() == 2) join(crossing[0], crossing[1]);
        for (std::size_t k = 0; k < 4 && crossing.size() == 4; ++k)
            if (in(corner(k))) join(edge_between(corner(k + 3), corner(k)), edge_between(corner(k), corner(k + 1)));
    }
    CellSheets sheets;
    std::array<std::int8_t, 12> number;
    number.fill(-1);
    for (int e = 0; e < 12; ++e) {
        const int low = low_corner(e);
        std::int8_t& mine = sheets.of_edge[static_cast<std::size_t>(e)] = -1;
        if (in(low) == in(low | 1 << e / 4)) continue;
        std::int8_t& of_set = number[static_cast<std::size_t>(up[static_cast<std::size_t>(e)])];
        if (of_set < 0) of_set = sheets.count++;
        mine = of_set;
    }
    return sheets;
}

/// Points in the box's indices times the spacing, and quadrilaterals whose normals point into the lumen of a right-handed grid.
struct Net {
    std::vector<Vec3> points;
    std::vector<Quad> quads;
    std::vector<Vec3> crossings;  // of each quadrilateral
};

class NetMaker {
public:
    NetMaker(const VoxelGrid& grid, const LumenVoxels& lumen, const std::vector<float>& fractions)
        : grid_(grid), lumen_(lumen), fractions_(fractions), stride_(lumen.strides()), spacing_(grid.spacing())
    {
        for (int corners = 0; corners < 256; ++corners) sheets_[static_cast<std::size_t>(corners)] = sheets_of(corners);
    }

    Net make()
    {
        const std::ptrdiff_t nx = lumen_.size[0], ny = lumen_.size[1], nz = lumen_.size[2];
        for (auto& layer : cell_) layer.assign(static_cast<std::size_t>(nx * ny), -1);
        for (std::ptrdiff_t k = 0; k + 1 < nz; ++k) {
            std::fill(cell_[k % 2].begin(), cell_[k % 2].end(), -1);
            for (std::ptrdiff_t j = 0; j + 1 < ny; ++j) walk_row(j, k);
        }
        return std::move(net_);
    }

private:
    struct Cell {
        std::int32_t first = 0;  // point of its first sheet
        std::uint8_t corners = 0;
    };

    void walk_row(std::ptrdiff_t j, std::ptrdiff_t k)
    {
        const std::uint8_t* row = lumen_.flags.data() + k * stride_[2] + j * stride_[1];
        const auto column = [&](std::ptrdiff_t i) {  // the four voxels beside each other, two bits apart
            return (row[i] & 1) | (row[i + stride_[1]] & 1) << 2 | (row[i + stride_[2]] & 1) << 4 |
                   (row[i + stride_[1] + stride_[2]] & 1) << 6;
        };
        constexpr int all = 1 | 1 << 2 | 1 << 4 | 1 << 6;
        int here = column(0);
        for (std::ptrdiff_t i = 0; i + 1 < lumen_.size[0]; ++i) {
            const int next = column(i + 1);
            if (here != next || (here != 0 && here != all)) add_cell({i, j, k}, here | next << 1);
            here = next;
        }
    }

    void add_cell(const std::array<std::ptrdiff_t, 3>& at, int corners)
    {
        const CellSheets& sheets = sheets_[static_cast<std::size_t>(corners)];
        cell_[at[2] % 2][static_cast<std::size_t>(at[0] + at[1] * stride_[1])] = static_cast<std::int32_t>(cells_.size());
        cells_.push_back({static_cast<std::int32_t>(net_.points.size()), static_cast<std::uint8_t>(corners)});
        std::array<Vec3, 4> sum;
        std::array<int, 4> count{};
        sum.fill(Vec3::Zero());
        const std::ptrdiff_t base = at[0] + at[1] * stride_[1] + at[2] * stride_[2];
        for (int e = 0; e < 12; ++e) {
            if (sheets.of_edge[static_cast<std::size_t>(e)] < 0) continue;
            const auto sheet = static_cast<std::size_t>(sheets.of_edge[static_cast<std::size_t>(e)]);
            const int a = e / 4, low = low_corner(e);
            const std::ptrdiff_t v = base + (low & 1) + (low >> 1 & 1) * stride_[1] + (low >> 2) * stride_[2];
            if (is_open(v, a)) continue;
            Vec3 crossing(static_cast<double>(at[0] + (low & 1)), static_cast<double>(at[1] + (low >> 1 & 1)),
                          static_cast<double>(at[2] + (low >> 2)));
            crossing[static_cast<std::size_t>(a)] += fractions_.empty() ? 0.5 : share(crossing, a);
            crossing = crossing.cwiseProduct(spacing_);
            sum[sheet] += crossing;
            ++count[sheet];
            if (low == 0) add_quad(at, a, corners & 1, crossing);
        }
        for (std::size_t s = 0; s < static_cast<std::size_t>(sheets.count); ++s)
            net_.points.push_back(sum[s] / std::max(1, count[s]));
    }

    /// Whether the face between a voxel and the next one along an axis is an opening.
    [[nodiscard]] bool is_open(std::ptrdiff_t v, int axis) const
    {
        const std::uint8_t below = lumen_.flags[static_cast<std::size_t>(v)],
                           above = lumen_.flags[static_cast<std::size_t>(v + stride_[static_cast<std::size_t>(axis)])];
        return below & LumenVoxels::open_face(axis, true) || above & LumenVoxels::open_face(axis, false);
    }

    /// Where between a voxel and the next one the fraction is 0.5.
    [[nodiscard]] double share(const Vec3& index, int axis) const
    {
        std::ptrdiff_t v = 0;
        for (std::size_t a = 3; a-- > 0;) v = v * grid_.size[a] + lumen_.low[a] + static_cast<std::ptrdiff_t>(index[a]);
        const std::ptrdiff_t next = axis == 0   ? 1
                                    : axis == 1 ? grid_.size[0]
                                                : static_cast<std::ptrdiff_t>(grid_.size[0]) * grid_.size[1];
        const double a = fractions_[static_cast<std::size_t>(v)], b = fractions_[static_cast<std::size_t>(v + next)];
        return a == b ? 0.5 : std::clamp((0.5 - a) / (b - a), 0.0, 1.0);
    }

    /// About the crossing on the edge from the cell's first corner along axis a: the cells there that come before it, and itself.
    void add_quad(const std::array<std::ptrdiff_t, 3>& at, int a, bool below_is_in, const Vec3& crossing)
    {
        const auto u = static_cast<std::size_t>((a + 1) % 3), v = static_cast<std::size_t>((a + 2) % 3);
        constexpr std::array<std::array<int, 2>, 4> back = {{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
        Quad quad;
        for (std::size_t q = 0; q < 4; ++q) {
            std::array<std::ptrdiff_t, 3> other = at;
            other[u] -= back[q][0], other[v] -= back[q][1];
            const Cell& cell = cells_[index_of(cell_[other[2] % 2][static_cast<std::size_t>(other[0] + other[1] * stride_[1])])];
            const int edge = 4 * a + back[q][0] + 2 * back[q][1];
            quad[q] = cell.first + sheets_[cell.corners].of_edge[static_cast<std::size_t>(edge)];
        }
        if (below_is_in) std::swap(quad[1], quad[3]);
        net_.quads.push_back(quad);
        net_.crossings.push_back(crossing);
    }

    const VoxelGrid& grid_;
    const LumenVoxels& lumen_;
    const std::vector<float>& fractions_;
    std::array<std::ptrdiff_t, 3> stride_;
    Vec3 spacing_;
    std::array<CellSheets, 256> sheets_;
    std::array<std::vector<std::int32_t>, 2> cell_;  // of this layer and the one before, -1: no surface
    std::vector<Cell> cells_;
    Net net_;
};

/// Points that share an edge of a quadrilateral with each point; of a point on a rim apart those along the rim.
struct Neighbours {
    std::vector<std::int32_t> first, list;          // all of them
    std::vector<std::int32_t> rim_first, rim_list;  // none: no rim

    [[nodiscard]] std::pair<const std::int32_t*, const std::int32_t*> all(std::size_t p) const
    {
        return {list.data() + first[p], list.data() + first[p + 1]};
    }
    /// Those among which a point moves.
    [[nodiscard]] std::pair<const std::int32_t*, const std::int32_t*> along(std::size_t p) const
    {
        if (rim_first[p] == rim_first[p + 1]) return all(p);
        return {rim_list.data() + rim_first[p], rim_list.data() + rim_first[p + 1]};
    }
    [[nodiscard]] bool on_rim(std::size_t p) const { return rim_first[p] != rim_first[p + 1]; }
};

/// @param each  calls its argument with both ends of each edge
template <class Each>
void group(std::size_t points, const Each& each, std::vector<std::int32_t>& first, std::vector<std::int32_t>& list)
{
    first.assign(points + 2, 0);
    each([&](std::int32_t p, std::int32_t) { ++first[index_of(p) + 2]; });
    for (std::size_t k = 2; k < first.size(); ++k) first[k] += first[k - 1];
    list.resize(index_of(first.back()));
    each([&](std::int32_t p, std::int32_t q) { list[index_of(first[index_of(p) + 1]++)] = q; });
    first.pop_back();
}

Neighbours neighbours_of(const Net& net)
{
    const std::size_t n = net.points.size();
    std::vector<std::int32_t> first, list;
    const auto each_side = [&](const auto& take) {
        for (const Quad& q : net.quads)
            for (std::size_t k = 0; k < 4; ++k) take(q[k], q[(k + 1) % 4]);
    };
    group(n, each_side, first, list);
    const auto has = [&](std::int32_t p, std::int32_t q) {
        const std::int32_t *begin = list.data() + first[index_of(p)], *end = list.data() + first[index_of(p) + 1];
        return std::find(begin, end, q) != end;
    };
    std::vector<std::array<std::int32_t, 2>> rim;  // sides of one quadrilateral only
    each_side([&](std::int32_t p, std::int32_t q) {
        if (!has(q, p)) rim.push_back({p, q});
    });
    Neighbours all;
    group(
        n,
        [&](const auto& take) {
            for (const auto& [p, q] : rim) take(p, q), take(q, p);
        },
        all.rim_first, all.rim_list);
    group(
        n,
        [&](const auto& take) {
            each_side(take);
            for (const auto& [p, q] : rim) take(q, p);
        },
        all.first, all.list);
    return all;
}

class Fairing {
public:
    Fairing(Net& net, const Vec3& spacing, bool label)
        : net_(net), near_(neighbours_of(net)), start_(net.points), bound_(0.5 * spacing), label_(label)
    {
    }

    void run()
    {
        const int rounds = label_ ? label_rounds : 4, spread = label_ ? label_spread : 2;
        std::vector<double> height(net_.points.size());
        for (int round = 0; round < rounds; ++round) {
            for (int k = 0; k < 2; ++k) average_points();
            find_normals(height);
            average(height, spread);
            each_point([&](std::size_t p) {
                const Vec3 moved = net_.points[p] + height[p] * normal_[p];
                net_.points[p] = start_[p] + (moved - start_[p]).cwiseMax(-bound_).cwiseMin(bound_);
            });
        }
        find_normals(height);
        each_point(
            [&](std::size_t p) { height[p] = normal_[p].dot(mean_about(p) - net_.points[p]) / (near_.on_rim(p) ? 12 : 6); });
        average(height, label_ ? 5 : 1);
        each_point([&](std::size_t p) { net_.points[p] += height[p] * normal_[p]; });
    }

private:
    template <class Body>
    void each_point(const Body& body) const
    {
        for_each_item(static_cast<int>(net_.points.size()), 4096, [&](int p) { body(index_of(p)); });
    }

    [[nodiscard]] Vec3 mean_about(std::size_t p) const
    {
        Vec3 sum = Vec3::Zero();
        const auto [begin, end] = near_.along(p);
        for (const std::int32_t* q = begin; q != end; ++q) sum += net_.points[index_of(*q)];
        return begin == end ? net_.points[p] : sum / static_cast<double>(end - begin);
    }

    void average_points()
    {
        other_.resize(net_.points.size());
        each_point([&](std::size_t p) { other_[p] = 0.5 * (net_.points[p] + mean_about(p)); });
        net_.points.swap(other_);
    }

    void average(std::vector<double>& values, int times)
    {
        std::vector<double> next(values.size());
        for (int k = 0; k < times; ++k) {
            each_point([&](std::size_t p) {
                double sum = 0;
                const auto [begin, end] = near_.all(p);
                for (const std::int32_t* q = begin; q != end; ++q) sum += values[index_of(*q)];
                next[p] = begin == end ? values[p] : 0.4 * values[p] + 0.6 * sum / static_cast<double>(end - begin);
            });
            values.swap(next);
        }
    }

    /// @param height  out: of the crossings over the quadrilaterals about each point
    void find_normals(std::vector<double>& height)
    {
        normal_.assign(net_.points.size(), Vec3::Zero());
        height.assign(net_.points.size(), 0);
        std::vector<std::int32_t> count(net_.points.size(), 0);
        for (std::size_t k = 0; k < net_.quads.size(); ++k) {
            const Quad& q = net_.quads[k];
            const auto at = [&](std::size_t c) -> const Vec3& { return net_.points[index_of(q[c])]; };
            const Vec3 area = (at(2) - at(0)).cross(at(3) - at(1)), middle = 0.25 * (at(0) + at(1) + at(2) + at(3));
            const double over = area.normalized().dot(net_.crossings[k] - middle);
            for (const std::int32_t p : q) {
                normal_[index_of(p)] += area;
                height[index_of(p)] += over;
                ++count[index_of(p)];
            }
        }
        each_point([&](std::size_t p) {
            normal_[p].normalize();
            height[p] /= count[p];
        });
    }

    static constexpr int label_rounds = 10, label_spread = 40;
    Net& net_;
    Neighbours near_;
    std::vector<Vec3> start_, other_, normal_;
    Vec3 bound_;
    bool label_;
};

/// Only points that a quadrilateral has.
void drop_unused(Net& net)
{
    std::vector<std::int32_t> place(net.points.size(), -1);
    for (const Quad& q : net.quads)
        for (const std::int32_t p : q) place[index_of(p)] = 0;
    std::int32_t count = 0;
    for (std::size_t p = 0; p < place.size(); ++p) {
        if (place[p] < 0) continue;
        net.points[index_of(count)] = net.points[p];
        place[p] = count++;
    }
    net.points.resize(index_of(count));
    for (Quad& q : net.quads)
        for (std::int32_t& p : q) p = place[index_of(p)];
}

}  // namespace

WallMesh surface_of(const VoxelGrid& grid, const LumenVoxels& lumen, const std::vector<float>& fractions)
{
    Net net = NetMaker(grid, lumen, fractions).make();
    drop_unused(net);
    Fairing(net, grid.spacing(), fractions.empty()).run();
    WallMesh mesh;
    mesh.triangles.reserve(2 * net.quads.size());
    const auto length = [&](std::int32_t p, std::int32_t q) {
        return (net.points[index_of(p)] - net.points[index_of(q)]).squaredNorm();
    };
    for (Quad q : net.quads) {
        if (grid.volume() < 0) std::swap(q[1], q[3]);
        if (length(q[1], q[3]) < length(q[0], q[2])) q = {q[1], q[2], q[3], q[0]};
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    const Vec3 spacing = grid.spacing(), low(lumen.low[0], lumen.low[1], lumen.low[2]);
    mesh.vertices = std::move(net.points);
    for (Vec3& p : mesh.vertices) p = grid.at(low + p.cwiseQuotient(spacing));
    return mesh;
}

}  // namespace seldinger
