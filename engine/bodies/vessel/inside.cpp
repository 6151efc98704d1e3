// Signed distance to the wall.
#include "vessel/inside.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace seldinger {
namespace {

double corner_angle(const Vec3& at, const Vec3& a, const Vec3& b)
{
    const Vec3 u = a - at, v = b - at;
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

bool has_edge(const std::array<std::int32_t, 3>& triangle, std::int32_t a, std::int32_t b)
{
    const auto has = [&](std::int32_t v) { return triangle[0] == v || triangle[1] == v || triangle[2] == v; };
    return has(a) && has(b);
}

}  // namespace

LumenQuery::LumenQuery(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings, Expect queries)
    : tree_(shared_wall_tree(mesh)), mesh_(mesh)
{
    if (queries == Expect::Many) quads_ = make_quads(*tree_);
    for (const BoundaryLoop& loop : openings) {
        for (const std::int32_t v : loop.vertices) vertex_rim_.emplace_back(v, static_cast<std::int32_t>(rims_.size()));
        rims_.push_back({loop.centre, loop.inward, 1e-4 * loop.radius});
    }
    std::sort(vertex_rim_.begin(), vertex_rim_.end());
}

Vec3 LumenQuery::facet_normal(std::size_t triangle) const
{
    const Vec3 area = double_area(triangle_of(mesh_, triangle));
    return area.norm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
}

std::vector<std::uint32_t> LumenQuery::triangles_at(std::int32_t vertex, std::uint64_t* visits) const
{
    std::vector<std::uint32_t> found;
    triangles_around(*tree_, mesh_.vertices[static_cast<std::size_t>(vertex)], found, visits);
    for (std::uint32_t& k : found) k = tree_->original[k];
    std::erase_if(found, [&](std::uint32_t t) {
        const auto& v = mesh_.triangles[t];
        return v[0] != vertex && v[1] != vertex && v[2] != vertex;
    });
    std::sort(found.begin(), found.end());
    return found;
}

Vec3 LumenQuery::vertex_normal(std::int32_t vertex, std::uint64_t* visits) const
{
    return vertex_normal(vertex, triangles_at(vertex, visits));
}

Vec3 LumenQuery::vertex_normal(std::int32_t vertex, const std::vector<std::uint32_t>& triangles) const
{
    Vec3 normal = Vec3::Zero();
    for (const std::uint32_t t : triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            if (mesh_.triangles[t][c] != vertex) continue;
            const auto corner = [&](std::size_t k) {
                return mesh_.vertices[static_cast<std::size_t>(mesh_.triangles[t][k % 3])];
            };
            normal += corner_angle(corner(c), corner(c + 1), corner(c + 2)) * facet_normal(t);
        }
    return normal.norm() > 0 ? normal.normalized() : normal;
}

LumenQuery::Around LumenQuery::around(std::size_t triangle, TriangleFeature feature) const
{
    const auto f = static_cast<std::size_t>(feature);
    Around at;
    if (f == 0) return at;
    const auto& v = mesh_.triangles[triangle];
    at.from = f >= 4 ? v[f - 4] : v[f - 1];
    at.triangles = triangles_at(at.from);
    if (f >= 4) return at;
    at.to = v[f % 3];
    std::erase_if(at.triangles, [&](std::uint32_t t) { return !has_edge(mesh_.triangles[t], at.from, at.to); });
    return at;
}

Vec3 LumenQuery::pseudonormal(std::size_t triangle, const Around& at) const
{
    if (at.from >= 0 && !at.is_edge()) return vertex_normal(at.from, at.triangles);
    const Vec3 normal = facet_normal(triangle);
    if (!at.is_edge() || at.triangles.size() != 2) return normal;
    return normal + facet_normal(at.triangles[at.triangles[0] == triangle ? 1 : 0]);
}

/// An edge of one triangle, or of more than two; a vertex on one.
bool LumenQuery::is_border(const Around& at) const
{
    if (at.is_edge()) return at.triangles.size() != 2;
    for (const std::uint32_t t : at.triangles)
        for (const std::int32_t other : mesh_.triangles[t]) {
            const auto uses = std::count_if(at.triangles.begin(), at.triangles.end(),
                                            [&](std::uint32_t k) { return has_edge(mesh_.triangles[k], at.from, other); });
            if (other != at.from && uses != 2) return true;
        }
    return false;
}

int LumenQuery::rim_of(const Around& at, bool border) const
{
    if (at.from < 0 || (at.is_edge() && !border)) return -1;
    const auto found =
        std::upper_bound(vertex_rim_.begin(), vertex_rim_.end(), std::pair(at.from, std::numeric_limits<std::int32_t>::max()));
    return found == vertex_rim_.begin() || std::prev(found)->first != at.from ? -1 : std::prev(found)->second;
}

double LumenPlace::clearance(const Vec3& p) const
{
    const double off = std::abs((p - nearest).dot(normal));  // less than the distance: past the border, and not behind the sheet
    return opening >= 0 || (border && off < (1 - 1e-6) * -signed_distance) ? std::numeric_limits<double>::infinity()
                                                                           : signed_distance;
}

LumenPlace LumenQuery::locate(const Vec3& p, std::uint64_t* visits) const
{
    LumenPlace place;
    const TreeHit hit = nearest(p, std::numeric_limits<double>::infinity(), visits);
    if (hit.triangle < 0) return place;
    const std::size_t triangle = tree_->original[static_cast<std::size_t>(hit.triangle)];
    place.triangle = static_cast<std::int64_t>(triangle);
    place.nearest = hit.point;
    const Around at = around(triangle, hit.feature);
    const Vec3 pseudo = pseudonormal(triangle, at);
    const double length = pseudo.norm();
    place.normal = length > 0 ? Vec3(pseudo / length) : facet_normal(triangle);
    const double distance = std::sqrt(hit.distance2);
    place.signed_distance = (p - hit.point).dot(place.normal) >= 0 ? distance : -distance;
    place.border = is_border(at);
    if (const int rim = rim_of(at, place.border); rim >= 0) {
        const Rim& r = rims_[static_cast<std::size_t>(rim)];
        if ((p - r.centre).dot(r.inward) < -r.tolerance) place.opening = rim;
    }
    return place;
}

}  // namespace seldinger
