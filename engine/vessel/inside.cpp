// Signed distance to the wall.
#include "vessel/inside.h"

#include "vessel/mesh_edges.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

double corner_angle(const Vec3& at, const Vec3& a, const Vec3& b)
{
    const Vec3 u = a - at, v = b - at;
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

LumenQuery::LumenQuery(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings)
    : tree_(build_wall_tree(mesh)),
      triangles_(mesh.triangles),
      facet_normal_(mesh.triangles.size()),
      vertex_normal_(mesh.vertices.size(), Vec3::Zero()),
      opposite_(opposite_half_edges(mesh, find_edges(mesh))),
      vertex_rim_(mesh.vertices.size(), -1),
      vertex_border_(mesh.vertices.size(), 0)
{
    add_slabs(tree_);
    for (std::size_t h = 0; h < opposite_.size(); ++h)
        if (opposite_[h] < 0)
            for (const std::int32_t v :
                 {half_edge_from(mesh, static_cast<std::int32_t>(h)), half_edge_to(mesh, static_cast<std::int32_t>(h))})
                vertex_border_[static_cast<std::size_t>(v)] = 1;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const Triangle3 tri = triangle_of(mesh, t);
        const Vec3 area = double_area(tri);
        facet_normal_[t] = area.norm() > 0 ? Vec3(area.normalized()) : Vec3(Vec3::Zero());
        const double angle[3] = {corner_angle(tri.a, tri.b, tri.c), corner_angle(tri.b, tri.c, tri.a),
                                 corner_angle(tri.c, tri.a, tri.b)};
        for (std::size_t c = 0; c < 3; ++c)
            vertex_normal_[static_cast<std::size_t>(triangles_[t][c])] += angle[c] * facet_normal_[t];
    }
    for (Vec3& n : vertex_normal_)
        if (n.norm() > 0) n.normalize();
    for (const BoundaryLoop& loop : openings) {
        for (const std::int32_t v : loop.vertices)
            vertex_rim_[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(rims_.size());
        rims_.push_back({loop.centre, loop.inward, 1e-4 * loop.radius});
    }
}

Vec3 LumenQuery::pseudonormal(std::size_t triangle, TriangleFeature feature) const
{
    const int f = static_cast<int>(feature);
    if (f == 0) return facet_normal_[triangle];
    if (f >= 4) return vertex_normal_[static_cast<std::size_t>(triangles_[triangle][static_cast<std::size_t>(f - 4)])];
    const std::int32_t across = opposite_[3 * triangle + static_cast<std::size_t>(f - 1)];
    return across < 0 ? facet_normal_[triangle]
                      : Vec3(facet_normal_[triangle] + facet_normal_[static_cast<std::size_t>(across / 3)]);
}

int LumenQuery::rim_of(std::size_t triangle, TriangleFeature feature) const
{
    const int f = static_cast<int>(feature);
    auto rim = [&](int corner) {
        return vertex_rim_[static_cast<std::size_t>(triangles_[triangle][static_cast<std::size_t>(corner)])];
    };
    if (f == 0) return -1;
    if (f >= 4) return rim(f - 4);
    return opposite_[3 * triangle + static_cast<std::size_t>(f - 1)] < 0 ? rim(f - 1) : -1;
}

bool LumenQuery::on_border(std::size_t triangle, TriangleFeature feature) const
{
    const int f = static_cast<int>(feature);
    if (f == 0) return false;
    if (f >= 4) return vertex_border_[static_cast<std::size_t>(triangles_[triangle][static_cast<std::size_t>(f - 4)])] != 0;
    return opposite_[3 * triangle + static_cast<std::size_t>(f - 1)] < 0;
}

LumenPlace LumenQuery::locate(const Vec3& p, std::uint64_t* visits) const
{
    LumenPlace place;
    const TreeHit hit = nearest_on_wall(tree_, p, std::numeric_limits<double>::infinity(), visits);
    if (hit.triangle < 0) return place;
    const std::size_t triangle = tree_.original[static_cast<std::size_t>(hit.triangle)];
    place.triangle = static_cast<std::int64_t>(triangle);
    place.nearest = hit.point;
    const Vec3 pseudo = pseudonormal(triangle, hit.feature);
    const double length = pseudo.norm();
    place.normal = length > 0 ? Vec3(pseudo / length) : facet_normal_[triangle];
    const double distance = std::sqrt(hit.distance2);
    place.signed_distance = (p - hit.point).dot(place.normal) >= 0 ? distance : -distance;
    place.border = on_border(triangle, hit.feature);
    if (const int rim = rim_of(triangle, hit.feature); rim >= 0) {
        const Rim& r = rims_[static_cast<std::size_t>(rim)];
        if ((p - r.centre).dot(r.inward) < -r.tolerance) place.opening = rim;
    }
    return place;
}

}  // namespace seldinger
