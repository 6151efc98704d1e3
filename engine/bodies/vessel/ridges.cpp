// Finds edges whose facets stand out into the lumen and averages their angle by length.
#include "vessel/ridges.h"

#include "vessel/mesh_edges.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr double flat = 0.02;  // below this two facets are taken to be one [rad]

struct Facet {
    Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
};

Facet facet_of(const WallMesh& mesh, std::int32_t t)
{
    const auto& v = mesh.triangles[static_cast<std::size_t>(t)];
    const Vec3 &a = mesh.vertices[v[0]], &b = mesh.vertices[v[1]], &c = mesh.vertices[v[2]];
    return {(b - a).cross(c - a).normalized(), (a + b + c) / 3};
}

/// Whether the longest side of each triangle is at least this long.
std::vector<bool> are_long(const WallMesh& mesh, double least)
{
    std::vector<bool> result(mesh.triangles.size());
    for (std::size_t t = 0; t < result.size(); ++t) {
        const auto& v = mesh.triangles[t];
        const Vec3 &a = mesh.vertices[v[0]], &b = mesh.vertices[v[1]], &c = mesh.vertices[v[2]];
        result[t] = !(std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}) < least);
    }
    return result;
}

}  // namespace

double mean_ridge_angle(const WallMesh& mesh, double least_facet)
{
    const std::vector<bool> is_long = are_long(mesh, least_facet);
    if (std::find(is_long.begin(), is_long.end(), true) == is_long.end()) return 0;  // as of most fine meshes
    const MeshEdges edges = find_edges(mesh);
    double length = 0, turned = 0;
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (uses.size() != 2 || !is_long[uses[0] / 3] || !is_long[uses[1] / 3]) continue;
        const Facet a = facet_of(mesh, uses[0] / 3), b = facet_of(mesh, uses[1] / 3);
        if ((b.centre - a.centre).dot(a.normal) >= 0) continue;  // a valley, or flat
        const double angle = std::atan2(a.normal.cross(b.normal).norm(), a.normal.dot(b.normal));
        if (!(angle > flat)) continue;
        const double side = (mesh.vertices[half_edge_from(mesh, uses[0])] - mesh.vertices[half_edge_to(mesh, uses[0])]).norm();
        length += side;
        turned += side * angle;
    }
    return length > 0 ? turned / length : 0;
}

}  // namespace seldinger
