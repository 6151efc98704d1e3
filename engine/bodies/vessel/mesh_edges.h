#pragma once
// Which triangles share an edge. A half-edge is 3 t + e: edge e of triangle t, from its vertex e to its vertex (e + 1) % 3.

#include "vessel/wall_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// Half-edges grouped by the undirected edge they lie on, edges ordered by (smaller, larger) vertex index.
struct MeshEdges {
    std::vector<std::int32_t> half_edges;  // [3 T], those of one edge contiguous, in increasing order
    std::vector<std::int32_t> first;       // [E + 1], edge k owns half_edges[first[k] .. first[k + 1])

    [[nodiscard]] std::size_t count() const { return first.size() - 1; }
    [[nodiscard]] std::span<const std::int32_t> uses(std::size_t edge) const
    {
        return {half_edges.data() + first[edge], static_cast<std::size_t>(first[edge + 1] - first[edge])};
    }
};

/// O(V + T): counting sort by the smaller vertex, then a short sort inside each vertex's few edges.
[[nodiscard]] MeshEdges find_edges(const WallMesh& mesh);

/// Half-edge on the other side of each half-edge [3 T]; -1 at an opening and at edges of more than two triangles.
[[nodiscard]] std::vector<std::int32_t> opposite_half_edges(const WallMesh& mesh, const MeshEdges& edges);

[[nodiscard]] inline std::int32_t half_edge_from(const WallMesh& mesh, std::int32_t h)
{
    return mesh.triangles[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>(h % 3)];
}
[[nodiscard]] inline std::int32_t half_edge_to(const WallMesh& mesh, std::int32_t h)
{
    return mesh.triangles[static_cast<std::size_t>(h / 3)][static_cast<std::size_t>((h % 3 + 1) % 3)];
}

/// Closed chains of the edges that only one triangle uses, in that triangle's direction. A chain that meets itself
/// in a vertex is cut into simple loops there.
[[nodiscard]] std::vector<std::vector<std::int32_t>> boundary_chains(const WallMesh& mesh, const MeshEdges& edges);

/// Centre, mean radius and direction into the lumen of the loop through `vertices`, ordered along the (inward-facing)
/// triangles that it bounds. A flap that stands far out of the rim counts for none of the three.
[[nodiscard]] BoundaryLoop describe_loop(const WallMesh& mesh, std::vector<std::int32_t> vertices);

/// How far a loop's vertices lie out of its plane at most [m]. @param vertex  out, may be null: which one
[[nodiscard]] double rim_height(const WallMesh& mesh, const BoundaryLoop& loop, std::int32_t* vertex = nullptr);

}  // namespace seldinger
