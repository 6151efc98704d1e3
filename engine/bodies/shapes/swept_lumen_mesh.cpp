// From the implicit lumen to an even triangle mesh.
#include "core/check.h"
#include "shapes/swept_lumen.h"
#include "vessel/mesh_edges.h"
#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace seldinger {
namespace {

/// f on the nodes of a grid, sampled only near the wall; elsewhere +-large with the right sign is not needed and left at +large
/// outside and -large inside.
struct LumenGrid {
    Vec3 low;
    double step;
    std::array<int, 3> size;  // nodes
    std::vector<float> value;
    [[nodiscard]] std::size_t index(int x, int y, int z) const
    {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(size[0]) *
                   (static_cast<std::size_t>(y) + static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(z));
    }
    [[nodiscard]] Vec3 node(int x, int y, int z) const { return low + step * Vec3(x, y, z); }
};

LumenGrid sample(const SweptLumen& lumen, double step)
{
    constexpr float kFar = 1e3f;
    LumenGrid grid;
    grid.step = step;
    Box3 box;
    const double margin = lumen.fillet() + 2 * step;
    for (const SweptTube& tube : lumen.tubes())
        for (std::size_t i = 0; i < tube.points.size(); ++i) {
            box.extend(tube.points[i] + Vec3::Constant(tube.radius[i] + margin));
            box.extend(tube.points[i] - Vec3::Constant(tube.radius[i] + margin));
        }
    grid.low = box.min();
    for (int d = 0; d < 3; ++d) grid.size[d] = static_cast<int>(std::ceil(box.diagonal()[d] / step)) + 2;
    const std::size_t count =
        static_cast<std::size_t>(grid.size[0]) * static_cast<std::size_t>(grid.size[1]) * static_cast<std::size_t>(grid.size[2]);
    grid.value.assign(count, kFar);
    std::vector<float> own(count, kFar);
    for (const SweptTube& tube : lumen.tubes()) {
        std::fill(own.begin(), own.end(), kFar);
        for (std::size_t s = 0; s + 1 < tube.points.size(); ++s) {
            // the nodes round the segment, no farther from it than the blend reaches beyond the wall
            const double reach = std::max(tube.radius[s], tube.radius[s + 1]) + margin;
            Box3 part;
            part.extend(tube.points[s]);
            part.extend(tube.points[s + 1]);
            std::array<int, 3> from, to;
            for (int d = 0; d < 3; ++d) {
                from[d] = std::max(0, static_cast<int>((part.min()[d] - reach - grid.low[d]) / step));
                to[d] = std::min(grid.size[d] - 1, static_cast<int>((part.max()[d] + reach - grid.low[d]) / step) + 1);
            }
            for (int z = from[2]; z <= to[2]; ++z)
                for (int y = from[1]; y <= to[1]; ++y)
                    for (int x = from[0]; x <= to[0]; ++x) {
                        float& v = own[grid.index(x, y, z)];
                        v = std::min(v, static_cast<float>(SweptLumen::value_of(tube, s, grid.node(x, y, z))));
                    }
        }
        for (std::size_t i = 0; i < count; ++i)
            grid.value[i] = static_cast<float>(lumen.blend({grid.value[i], Vec3::Zero()}, {own[i], Vec3::Zero()}).value);
    }
    return grid;
}

/// Surface nets: one vertex in each cell that the wall crosses, one quadrilateral round each grid edge that it crosses.
WallMesh surface_nets(const LumenGrid& grid)
{
    WallMesh mesh;
    std::vector<std::int32_t> vertex_of(grid.value.size(), -1);  // cell (x, y, z): its lower corner's index
    auto value = [&](int x, int y, int z) { return static_cast<double>(grid.value[grid.index(x, y, z)]); };
    const std::size_t up_y = grid.index(0, 1, 0), up_z = grid.index(0, 0, 1);
    auto crossed = [&](int x, int y, int z) {  // has the cell corners on both sides of the wall?
        int inside = 0;
        for (const std::size_t row : {std::size_t{0}, up_y, up_z, up_y + up_z}) {
            const float* corners = &grid.value[grid.index(x, y, z) + row];
            inside += (corners[0] < 0) + (corners[1] < 0);
        }
        return inside != 0 && inside != 8;
    };
    for (int z = 0; z + 1 < grid.size[2]; ++z)
        for (int y = 0; y + 1 < grid.size[1]; ++y)
            for (int x = 0; x + 1 < grid.size[0]; ++x) {
                if (!crossed(x, y, z)) continue;
                Vec3 sum = Vec3::Zero();
                int crossings = 0;
                for (int a = 0; a < 8; ++a)
                    for (int axis = 0; axis < 3; ++axis) {
                        const int b = a | 1 << axis;
                        if (b == a) continue;
                        const std::array<int, 3> pa = {x + (a & 1), y + (a >> 1 & 1), z + (a >> 2)},
                                                 pb = {x + (b & 1), y + (b >> 1 & 1), z + (b >> 2)};
                        const double fa = value(pa[0], pa[1], pa[2]), fb = value(pb[0], pb[1], pb[2]);
                        if ((fa < 0) == (fb < 0)) continue;
                        const double t = fa / (fa - fb);
                        sum += (1 - t) * grid.node(pa[0], pa[1], pa[2]) + t * grid.node(pb[0], pb[1], pb[2]);
                        ++crossings;
                    }
                vertex_of[grid.index(x, y, z)] = static_cast<std::int32_t>(mesh.vertices.size());
                mesh.vertices.push_back(sum / crossings);
            }
    for (int z = 1; z + 1 < grid.size[2]; ++z)
        for (int y = 1; y + 1 < grid.size[1]; ++y)
            for (int x = 1; x + 1 < grid.size[0]; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    std::array<int, 3> up = {x, y, z}, u = {}, v = {};
                    up[axis] += 1;
                    u[(axis + 1) % 3] = 1;
                    v[(axis + 2) % 3] = 1;
                    const bool in = value(x, y, z) < 0, in_up = value(up[0], up[1], up[2]) < 0;
                    if (in == in_up) continue;
                    auto cell = [&](int i, int j) {
                        return vertex_of[grid.index(x - i * u[0] - j * v[0], y - i * u[1] - j * v[1], z - i * u[2] - j * v[2])];
                    };
                    std::array<std::int32_t, 4> q = {cell(0, 0), cell(1, 0), cell(1, 1), cell(0, 1)};  // right-handed about +axis
                    if (in) std::reverse(q.begin(), q.end());                                          // facing the lumen
                    auto at = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(q[i])]; };
                    if ((at(0) - at(2)).squaredNorm() <= (at(1) - at(3)).squaredNorm())
                        mesh.triangles.insert(mesh.triangles.end(), {{{q[0], q[1], q[2]}}, {{q[0], q[2], q[3]}}});
                    else mesh.triangles.insert(mesh.triangles.end(), {{{q[0], q[1], q[3]}}, {{q[1], q[2], q[3]}}});
                }
    return mesh;
}

/// Newton along the gradient onto f = 0, within the plane through p square to `in_plane` when that is not 0.
Vec3 onto_wall(const SweptLumen& lumen, Vec3 p, const Vec3& in_plane, int steps = 6)
{
    for (int i = 0; i < steps; ++i) {
        const FieldValue f = lumen.at(p);
        const Vec3 along = f.gradient - in_plane * in_plane.dot(f.gradient);
        const double slope = along.squaredNorm();
        if (!(slope > 1e-6)) break;
        p -= f.value / slope * along;
        if (std::abs(f.value) < 1e-9) break;  // a nanometre: below float32 at this size
    }
    return p;
}

/// Cuts the mesh flat at one end. Vertices near the plane are moved into it first, so that no thin slices are cut.
void clip(WallMesh& mesh, const SweptLumen& lumen, const LumenEnd& end, double edge)
{
    std::vector<double> side(mesh.vertices.size(), -1.0);  // > 0 beyond the plane, 0 in it
    for (std::size_t v = 0; v < side.size(); ++v) {
        const Vec3 from = mesh.vertices[v] - end.point;
        if (from.norm() > end.reach) continue;
        side[v] = from.dot(end.outward);
        if (std::abs(side[v]) > 0.4 * edge) continue;
        mesh.vertices[v] = onto_wall(lumen, mesh.vertices[v] - side[v] * end.outward, end.outward);
        side[v] = 0;
    }
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> cuts;
    auto cut = [&](std::int32_t a, std::int32_t b) {
        const auto key = std::minmax(a, b);
        const auto [it, fresh] = cuts.try_emplace(key, static_cast<std::int32_t>(mesh.vertices.size()));
        if (fresh) {
            const double sa = side[static_cast<std::size_t>(a)], sb = side[static_cast<std::size_t>(b)];
            const Vec3 p =
                mesh.vertices[static_cast<std::size_t>(a)] +
                sa / (sa - sb) * (mesh.vertices[static_cast<std::size_t>(b)] - mesh.vertices[static_cast<std::size_t>(a)]);
            mesh.vertices.push_back(onto_wall(lumen, p, end.outward));
            side.push_back(0);
        }
        return it->second;
    };
    std::vector<std::array<std::int32_t, 3>> kept;
    for (const auto& t : mesh.triangles) {
        std::vector<std::int32_t> polygon;  // the part of the triangle on the near side [Sutherland & Hodgman 1974]
        bool inside = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t a = t[i], b = t[(i + 1) % 3];
            const double sa = side[static_cast<std::size_t>(a)], sb = side[static_cast<std::size_t>(b)];
            inside |= sa < 0;
            if (sa <= 0) polygon.push_back(a);
            if (sa * sb < 0) polygon.push_back(cut(a, b));
        }
        if (!inside) continue;
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i) kept.push_back({polygon[0], polygon[i], polygon[i + 1]});
    }
    mesh.triangles = std::move(kept);
}

void drop_unused(WallMesh& mesh)
{
    std::vector<std::int32_t> place(mesh.vertices.size(), -1);
    std::vector<Vec3> kept;
    for (auto& t : mesh.triangles)
        for (auto& v : t) {
            std::int32_t& p = place[static_cast<std::size_t>(v)];
            if (p < 0) {
                p = static_cast<std::int32_t>(kept.size());
                kept.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
            }
            v = p;
        }
    mesh.vertices = std::move(kept);
}

/// Flips inner edges where that raises the lesser quality of their two triangles. Returns how many.
int flip_edges(WallMesh& mesh)
{
    const MeshEdges edges = find_edges(mesh);
    std::vector<bool> touched(mesh.triangles.size(), false);
    auto at = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
    std::vector<std::vector<std::int32_t>> around(mesh.vertices.size());  // neighbours, so that no edge is made twice
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        around[static_cast<std::size_t>(half_edge_from(mesh, h))].push_back(half_edge_to(mesh, h));
        around[static_cast<std::size_t>(half_edge_to(mesh, h))].push_back(half_edge_from(mesh, h));
    }
    int flips = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() != 2) continue;
        const auto t = static_cast<std::size_t>(uses[0] / 3), n = static_cast<std::size_t>(uses[1] / 3);
        if (touched[t] || touched[n]) continue;
        const std::int32_t a = half_edge_from(mesh, uses[0]), b = half_edge_to(mesh, uses[0]);
        const std::int32_t c = mesh.triangles[t][static_cast<std::size_t>((uses[0] % 3 + 2) % 3)],
                           d = mesh.triangles[n][static_cast<std::size_t>((uses[1] % 3 + 2) % 3)];
        const Triangle3 old_t{at(a), at(b), at(c)}, old_n{at(b), at(a), at(d)}, new_t{at(c), at(d), at(b)},
            new_n{at(d), at(c), at(a)};
        const double before = std::min(triangle_quality(old_t), triangle_quality(old_n));
        const double after = std::min(triangle_quality(new_t), triangle_quality(new_n));
        const Vec3 normal = double_area(old_t) + double_area(old_n);
        if (after < before + 0.02 || double_area(new_t).dot(normal) <= 0 || double_area(new_n).dot(normal) <= 0) continue;
        auto& nc = around[static_cast<std::size_t>(c)];
        if (std::find(nc.begin(), nc.end(), d) != nc.end()) continue;
        mesh.triangles[t] = {c, d, b};
        mesh.triangles[n] = {d, c, a};
        nc.push_back(d);
        around[static_cast<std::size_t>(d)].push_back(c);
        touched[t] = touched[n] = true;
        ++flips;
    }
    return flips;
}

/// One sweep: every vertex towards the mean of its neighbours and, in `steps` Newton steps, back onto the wall; rim vertices
/// along their rim. One step is enough while more sweeps follow.
void relax(WallMesh& mesh, const SweptLumen& lumen, const std::vector<LumenEnd>& ends, int steps)
{
    const MeshEdges edges = find_edges(mesh);
    std::vector<Vec3> sum(mesh.vertices.size(), Vec3::Zero()), rim_sum(mesh.vertices.size(), Vec3::Zero());
    std::vector<int> count(mesh.vertices.size(), 0), rim(mesh.vertices.size(), 0);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        const auto a = static_cast<std::size_t>(half_edge_from(mesh, h)), b = static_cast<std::size_t>(half_edge_to(mesh, h));
        for (const auto& [to, from] : {std::pair{a, b}, std::pair{b, a}}) {
            sum[to] += mesh.vertices[from];
            ++count[to];
            if (edges.uses(k).size() == 1) {
                rim_sum[to] += mesh.vertices[from];
                ++rim[to];
            }
        }
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const bool on_rim = rim[v] > 0;
        const Vec3 mean = on_rim ? Vec3(rim_sum[v] / rim[v]) : Vec3(sum[v] / count[v]);
        Vec3 plane = Vec3::Zero();
        if (on_rim) {
            const LumenEnd* nearest = &ends[0];
            for (const LumenEnd& end : ends)
                if ((end.point - mesh.vertices[v]).squaredNorm() < (nearest->point - mesh.vertices[v]).squaredNorm())
                    nearest = &end;
            plane = nearest->outward;
        }
        const Vec3 move = 0.6 * (mean - mesh.vertices[v]);
        mesh.vertices[v] = onto_wall(lumen, mesh.vertices[v] + move - plane * plane.dot(move), plane, steps);
    }
}

}  // namespace

WallMesh mesh_lumen(const SweptLumen& lumen, const std::vector<LumenEnd>& ends, int triangles)
{
    // Surface nets make about 3 triangles per step^2 of wall (a cell's vertex per 1.5 squares, whatever the wall's slope), so the
    // count goes with 1 / step^2. It is final before the relaxation, which costs the most.
    double area = 0;
    for (const SweptTube& tube : lumen.tubes())
        for (std::size_t i = 1; i < tube.points.size(); ++i)
            area += std::numbers::pi * (tube.radius[i] + tube.radius[i - 1]) * (tube.points[i] - tube.points[i - 1]).norm();
    double step = std::sqrt(3 * area / triangles);
    WallMesh mesh;
    for (int attempt = 0; attempt < 4; ++attempt) {
        mesh = surface_nets(sample(lumen, step));
        for (const LumenEnd& end : ends) clip(mesh, lumen, end, 1.1 * step);
        const double ratio = static_cast<double>(mesh.triangles.size()) / triangles;
        if (std::abs(ratio - 1) < 0.02) break;
        step *= std::sqrt(ratio);
    }
    drop_unused(mesh);
    for (int sweep = 0; sweep < 10; ++sweep) {
        relax(mesh, lumen, ends, sweep < 9 ? 1 : 6);
        flip_edges(mesh);
    }
    return mesh;
}

}  // namespace seldinger
