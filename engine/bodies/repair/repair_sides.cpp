// The two sides of a wall that was exported as one surface: outer, inner and the rims that join them. Noise as of segmentations
// included.
#include "repair/repair_steps.h"
#include "vessel/mesh_components.h"
#include "vessel/tree.h"
#include "vessel/triangle_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace seldinger::repair_steps {
namespace {

constexpr double far = std::numeric_limits<double>::infinity();
constexpr double least_sheet = 0.36;   // V/(A t) of a sheet of the thickness t is 1/2, of a round tube 1/4, of a ball 1/6
// difference of enclosure across a wall: half turns of view in a tube, hardly any across a lumen
constexpr double least_side = 0.15;
constexpr double least_inner = 0.2, least_sided = 0.6;  // shares of the surface that are inner, and that are inner or outer
constexpr double least_enclosed = 0.65;  // median of the inner side: 0.74 in the middle of a tube two diameters long
constexpr double least_width = 1.25;     // of the lumen, in thicknesses: two lumens with a flap are the other way round
constexpr double rough = 20;  // [degrees] median turn at an edge: of noise, and not of coarse facets, which turn at every second
constexpr int most_rounds = 12;          // of smoothing
constexpr std::size_t asked_places = 300, few_places = 32, most_rays_from = 20000;

constexpr double few_steps = 3e7,
                 most_steps = 6e8;  // of rays through the tree, for the places and for all: 10 and 6 times those of noisy walls

/// Triangles of a wall that may be a sheet, with evened vertices, seen from without its material.
struct Body {
    WallMesh mesh;
    double volume = 0, area = 0;  // [m^3, m^2]
    double facing = 1;            // -1: normals point into the material
    std::vector<double> cumulated;  // [T] area up to each triangle
};

double median(std::vector<double> values)
{
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Median turn of the surface at its edges [degrees].
double roughness(const WallMesh& mesh, const MeshEdges& edges)
{
    std::vector<Vec3> normal(mesh.triangles.size());
    for (std::size_t t = 0; t < normal.size(); ++t) normal[t] = double_area(triangle_of(mesh, t)).normalized();
    std::vector<double> turns;
    for (std::size_t k = 0; k < edges.count(); ++k)
        if (const auto uses = edges.uses(k); uses.size() == 2)
            turns.push_back(-normal[static_cast<std::size_t>(uses[0] / 3)].dot(normal[static_cast<std::size_t>(uses[1] / 3)]));
    return std::acos(std::clamp(-median(std::move(turns)), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Takes values at vertices a share of the way to the mean of their neighbours. @param weight  of each edge; empty: all alike
template <class T>
void average(std::vector<T>& values, const WallMesh& mesh, const MeshEdges& edges, const T& zero, double share,
             const std::vector<double>& weight = {})
{
    std::vector<T> sum(values.size(), zero);
    std::vector<double> count(values.size(), 0);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto a = static_cast<std::size_t>(half_edge_from(mesh, edges.uses(k)[0])),
                   b = static_cast<std::size_t>(half_edge_to(mesh, edges.uses(k)[0]));
        const double w = weight.empty() ? 1 : weight[k];
        sum[a] += w * values[b], sum[b] += w * values[a];
        count[a] += w, count[b] += w;
    }
    for (std::size_t v = 0; v < values.size(); ++v)
        if (count[v] > 0) values[v] = (1 - share) * values[v] + (share / count[v]) * sum[v];
}

/// Vector area of the triangles at each vertex, out of the material.
std::vector<Vec3> areas_of_vertices(const Body& body)
{
    std::vector<Vec3> area(body.mesh.vertices.size(), Vec3::Zero());
    for (std::size_t t = 0; t < body.mesh.triangles.size(); ++t)
        for (const std::int32_t v : body.mesh.triangles[t])
            area[static_cast<std::size_t>(v)] += 0.5 * body.facing * double_area(triangle_of(body.mesh, t));
    return area;
}

/// Of each edge, one over its length: beside long edges of a mesh that was made coarse, short ones even noise out without moving
/// the shape [Fujiwara 1995, doi:10.1090/S0002-9939-1995-1231297-4].
std::vector<double> one_over_length(const WallMesh& mesh, const MeshEdges& edges)
{
    std::vector<double> weight(edges.count());
    for (std::size_t k = 0; k < weight.size(); ++k) {
        const std::int32_t h = edges.uses(k)[0];
        const double length = (mesh.vertices[static_cast<std::size_t>(half_edge_to(mesh, h))] -
                               mesh.vertices[static_cast<std::size_t>(half_edge_from(mesh, h))])
                                  .norm();
        weight[k] = 1 / std::max(length, 1e-9);
    }
    return weight;
}

/// Averages noise out and leaves the shape [Taubin 1995, doi:10.1145/218380.218473].
Body evened(const WallMesh& mesh, const MeshEdges& edges)
{
    Body body{mesh, 0, 0, 1, {}};
    const std::vector<double> weight = one_over_length(mesh, edges);
    for (int round = 0; round < most_rounds && roughness(body.mesh, edges) > rough; ++round)
        for (const double share : {0.5, -0.53})
            average(body.mesh.vertices, mesh, edges, Vec3(Vec3::Zero()), share, weight);
    const std::vector<std::int32_t> one(mesh.triangles.size(), 0);
    const double volume = measure_components(body.mesh, edges, one)[0].volume;
    body.volume = std::abs(volume);
    body.facing = volume > 0 ? 1 : -1;
    for (const Vec3& area : areas_of_vertices(body)) body.area += area.norm() / 3;  // folds of noise have none
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        body.cumulated.push_back((t ? body.cumulated.back() : 0) + 0.5 * double_area(triangle_of(body.mesh, t)).norm());
    return body;
}

/// A place on the surface, and the direction out of the material.
struct Place {
    Vec3 at, out;
};

/// The middle of the triangle behind a share of the area.
Place place_at(const Body& body, double share)
{
    const auto t = static_cast<std::size_t>(
        std::upper_bound(body.cumulated.begin(), body.cumulated.end(), share * body.cumulated.back()) - body.cumulated.begin());
    const Triangle3 c = triangle_of(body.mesh, std::min(t, body.cumulated.size() - 1));
    return {(c.a + c.b + c.c) / 3, body.facing * double_area(c).normalized()};
}

/// Distance through the material by all triangles, for a few places without a tree.
double thickness_of_all(const Body& body, const Place& p)
{
    double least = far;
    const Vec3 into = -p.out;
    for (std::size_t t = 0; t < body.mesh.triangles.size(); ++t) {
        const Triangle3 c = triangle_of(body.mesh, t);
        const Vec3 ab = c.b - c.a, ac = c.c - c.a, h = into.cross(ac), s = p.at - c.a;
        const double det = ab.dot(h), u = s.dot(h);
        if (det == 0 || u * det < 0 || std::abs(u) > std::abs(det)) continue;
        const Vec3 q = s.cross(ab);
        const double v = into.dot(q);
        if (v * det < 0 || std::abs(u + v) > std::abs(det)) continue;
        const double along = ac.dot(q) / det;
        if (along > 1e-9 * std::sqrt(body.area) && along < least) least = along;
    }
    return least;
}

/// Looks along rays, and counts steps.
class Rays {
public:
    Rays(const Body& body) : tree_(build_wall_tree(body.mesh)), skip_(1e-6 * std::sqrt(body.area)) {}
    [[nodiscard]] bool tired(double limit) const { return static_cast<double>(visits_) > limit; }
    double hit(const Vec3& from, const Vec3& along) { return first_hit(tree_, from, along, skip_, &visits_); }
    /// Share of the half space in front that ends at the surface, weighted with the cosine.
    double enclosure(const Place& p, int rays)
    {
        const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
        const CrossFrame frame = cross_frame(p.out, Vec3::UnitX());
        int met = 0;
        for (int k = 0; k < rays; ++k) {
            const double r2 = (k + 0.5) / rays;
            const Vec3 along =
                std::sqrt(r2) * (std::cos(golden * k) * frame.u + std::sin(golden * k) * frame.v) + std::sqrt(1 - r2) * p.out;
            met += hit(p.at, along) < far;
        }
        return static_cast<double>(met) / rays;
    }
    /// Which side of the wall: its enclosure less that of the other side; below 0 without one. @param thickness  out
    double side(const Place& p, int rays, double& thickness, double& own)
    {
        thickness = hit(p.at, -p.out);
        own = enclosure(p, rays);
        return thickness < far ? own - enclosure({p.at - thickness * p.out, -p.out}, rays) : -1;
    }

private:
    WallTree tree_;
    double skip_;
    std::uint64_t visits_ = 0;
};

/// Whether it is a wall of two surfaces around a lumen, by the places chosen.
bool is_wall(const Body& body, Rays& rays)
{
    std::size_t inner = 0, sided = 0;
    std::vector<double> thickness, width, enclosed;
    for (std::size_t k = 0; k < asked_places && !rays.tired(few_steps); ++k) {
        const Place p = place_at(body, (static_cast<double>(k) + 0.5) / asked_places);
        double through = 0, own = 0;
        const double side = rays.side(p, 24, through, own);
        if (std::abs(side) < least_side || through == far) continue;
        ++sided;
        thickness.push_back(through);
        if (side < 0) continue;
        ++inner;
        width.push_back(rays.hit(p.at, p.out));
        enclosed.push_back(own);
    }
    if (rays.tired(few_steps) || inner < least_inner * asked_places || sided < least_sided * asked_places) return false;
    const double middle = median(thickness);
    return median(width) > least_width * middle && median(enclosed) > least_enclosed &&
           body.volume > least_sheet * body.area * middle;
}

/// Side of each vertex, averaged over its neighbourhood: > 0 inner.
std::vector<double> sides_of_vertices(const Body& body, const MeshEdges& edges, Rays& rays)
{
    const std::vector<Vec3> out = areas_of_vertices(body);
    std::vector<double> side(out.size(), 0), known(out.size(), 0);
    const std::size_t step = 1 + out.size() / most_rays_from;
    for (std::size_t v = 0; v < out.size(); ++v) {
        if (v % step != 0 || out[v].isZero() || rays.tired(most_steps)) continue;
        double through = 0, own = 0;
        side[v] = rays.side({body.mesh.vertices[v], out[v].normalized()}, 12, through, own);
        known[v] = 1;
    }
    for (std::size_t round = 0; round < 2 + step; ++round)
        for (std::vector<double>* values : {&side, &known}) average(*values, body.mesh, edges, 0.0, 0.5);
    for (std::size_t v = 0; v < side.size(); ++v) side[v] /= std::max(known[v], 1e-12);
    return side;
}

/// The largest set of triangles of one mark.
std::vector<bool> largest_of(const WallMesh& mesh, const MeshEdges& edges, const std::vector<bool>& marked)
{
    const auto has = [&](std::int32_t h) { return marked[static_cast<std::size_t>(h / 3)]; };
    const std::vector<std::int32_t> set =
        label_sets(mesh, edges, [&](std::span<const std::int32_t> uses) { return std::all_of(uses.begin(), uses.end(), has); });
    std::vector<double> area;
    for (std::size_t t = 0; t < set.size(); ++t) {
        area.resize(std::max(area.size(), static_cast<std::size_t>(set[t]) + 1), 0.0);
        if (marked[t]) area[static_cast<std::size_t>(set[t])] += double_area(triangle_of(mesh, t)).norm();
    }
    const auto best = std::max_element(area.begin(), area.end()) - area.begin();
    std::vector<bool> in(set.size());
    for (std::size_t t = 0; t < set.size(); ++t) in[t] = marked[t] && set[t] == best;
    return in;
}

/// Takes teeth off the border: triangles with two neighbours on the other side.
void straighten(const WallMesh& mesh, const MeshEdges& edges, std::vector<bool>& inner)
{
    const std::vector<std::int32_t> opposite = opposite_half_edges(mesh, edges);
    for (int round = 0; round < 3; ++round) {
        const std::vector<bool> before = inner;
        for (std::size_t t = 0; t < before.size(); ++t) {
            int others = 0;
            for (std::size_t e = 0; e < 3; ++e) {
                const std::int32_t h = opposite[3 * t + e];
                others += h >= 0 && before[static_cast<std::size_t>(h / 3)] != before[t];
            }
            if (others >= 2) inner[t] = !before[t];
        }
    }
}

}  // namespace

std::optional<WallSides> sides_of_wall(const WallMesh& mesh, const MeshEdges& edges)
{
    Body body = evened(mesh, edges);
    std::vector<double> thickness;
    for (std::size_t k = 0; k < few_places; ++k)
        thickness.push_back(thickness_of_all(body, place_at(body, (static_cast<double>(k) + 0.5) / few_places)));
    if (!(body.volume > least_sheet * body.area * median(thickness))) return std::nullopt;
    Rays rays(body);
    if (!is_wall(body, rays)) return std::nullopt;
    const std::vector<double> side = sides_of_vertices(body, edges, rays);
    std::vector<bool> inner(mesh.triangles.size());
    for (std::size_t t = 0; t < inner.size(); ++t) {
        double sum = 0;
        for (const std::int32_t v : mesh.triangles[t]) sum += side[static_cast<std::size_t>(v)];
        inner[t] = sum > 0.5 * 3 * least_side;
    }
    straighten(mesh, edges, inner);
    // outer side and rims hang together, and so does the inner side: the rest are specks of noise
    inner.flip();
    inner = largest_of(mesh, edges, inner);
    inner.flip();
    inner = largest_of(mesh, edges, inner);
    return WallSides{std::move(body.mesh), std::move(inner)};
}

}  // namespace seldinger::repair_steps
