#pragma once
// Medial balls of the wall's vertices and the links between them.

#include "vessel/inside.h"

#include <vector>

namespace seldinger {

/// One node per chosen wall vertex. Links in compressed rows: node i links to link_to[row[i] .. row[i + 1]).
struct MedialGraph {
    std::vector<Vec3> wall;       // [N] the vertex on the wall [m]
    std::vector<Vec3> centre;     // [N] of its medial ball [m]
    std::vector<double> radius;   // [N] distance of the centre to the wall [m]
    std::vector<int> row, link_to;
    std::vector<int> node_of_vertex;  // [V] node that stands for each mesh vertex
    [[nodiscard]] std::size_t size() const { return wall.size(); }
};

/// At most about `node_limit` nodes: in finer meshes a node stands for a patch of neighbouring vertices.
[[nodiscard]] MedialGraph build_medial_graph(const WallMesh& mesh, const LumenQuery& lumen, std::size_t node_limit = 50000);

/// Cheapest paths from one node: cost = length / radius^2; `length` is the plain length of that path [m].
struct MedialPaths {
    std::vector<int> towards_root;  // [N] next node, -1 at the root and where it cannot be reached
    std::vector<double> length;     // [N] < 0 where it cannot be reached
};
[[nodiscard]] MedialPaths cheapest_paths(const MedialGraph& graph, int root);

}  // namespace seldinger
