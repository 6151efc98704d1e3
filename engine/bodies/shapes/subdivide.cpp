// One round of Loop subdivision: new vertices on edges, old ones moved, rims by the cubic B-spline of their own points.
#include "shapes/subdivide.h"

#include "vessel/mesh_edges.h"

#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

/// What the neighbours of a vertex say of its new place.
struct VertexRing {
    Vec3 sum = Vec3::Zero(), rim_sum = Vec3::Zero();
    int neighbours = 0, rim_neighbours = 0;
    bool fixed = false;
};

/// Loop's weight of each of n neighbours.
double neighbour_weight(int n)
{
    const double c = 3.0 / 8 + std::cos(2 * std::numbers::pi / n) / 4;
    return (5.0 / 8 - c * c) / n;
}

Vec3 new_place(const Vec3& old, const VertexRing& ring)
{
    if (ring.fixed || ring.neighbours == 0) return old;
    if (ring.rim_neighbours == 2) return 0.75 * old + 0.125 * ring.rim_sum;
    if (ring.rim_neighbours > 0) return old;
    const double w = neighbour_weight(ring.neighbours);
    return (1 - ring.neighbours * w) * old + w * ring.sum;
}

}  // namespace

WallMesh subdivide_loop(const WallMesh& mesh)
{
    const MeshEdges edges = find_edges(mesh);
    const std::size_t old = mesh.vertices.size();
    const auto place = [&](std::int32_t v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
    const auto across = [&](std::int32_t h) -> const Vec3& {  // the corner that is not on the edge
        return place(mesh.triangles[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>((h % 3 + 2) % 3)]);
    };
    WallMesh fine;
    fine.vertices.resize(old + edges.count());
    std::vector<std::int32_t> middle(3 * mesh.triangles.size());  // of a half-edge: the vertex on its edge
    std::vector<VertexRing> rings(old);
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        const std::int32_t a = half_edge_from(mesh, uses[0]), b = half_edge_to(mesh, uses[0]);
        Vec3& point = fine.vertices[old + k];
        point = 0.5 * (place(a) + place(b));
        if (uses.size() == 2) point = 0.75 * point + 0.125 * (across(uses[0]) + across(uses[1]));
        for (const std::int32_t h : uses) middle[static_cast<std::size_t>(h)] = static_cast<std::int32_t>(old + k);
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
            VertexRing& ring = rings[static_cast<std::size_t>(from)];
            ring.sum += place(to);
            ++ring.neighbours;
            if (uses.size() == 1) ring.rim_sum += place(to), ++ring.rim_neighbours;
            if (uses.size() > 2) ring.fixed = true;
        }
    }
    for (std::size_t v = 0; v < old; ++v) fine.vertices[v] = new_place(mesh.vertices[v], rings[v]);
    fine.triangles.reserve(4 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const std::int32_t ab = middle[3 * t], bc = middle[3 * t + 1], ca = middle[3 * t + 2];
        fine.triangles.push_back({a, ab, ca});
        fine.triangles.push_back({ab, b, bc});
        fine.triangles.push_back({ca, bc, c});
        fine.triangles.push_back({ab, bc, ca});
    }
    return fine;
}

}  // namespace seldinger
