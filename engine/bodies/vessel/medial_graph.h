#pragma once
// Medial balls of the lumen and the links between them.

#include "vessel/enclosure.h"
#include "vessel/mesh_edges.h"

#include <vector>

namespace seldinger {

/// Wall samples, each with the ball that represents its own medial ball, and the balls that remain when those made superfluous by
/// a larger one are removed. Balls that overlap are linked: the line between their centres lies inside the lumen. Balls of
/// neighbouring samples are linked too, so that the graph hangs together as the wall does; paths use such a link only where
/// nothing else leads on. Links in compressed rows: ball i links to link_to[row[i] .. row[i + 1]).
struct MedialGraph {
    std::vector<Vec3> wall;             // [N] samples of the wall [m]
    std::vector<int> ball_of_sample;    // [N]
    std::vector<int> sample_of_vertex;  // [V] sample that stands for each mesh vertex
    std::vector<Vec3> centre;           // [B] [m]
    std::vector<double> radius;         // [B] distance of the centre to the wall, decreasing [m]
    std::vector<bool> is_lumen;         // [B] belongs to a stretch of lumen where a path may end, not to a corner of a rough wall
    std::vector<int> row, link_to;
    [[nodiscard]] std::size_t ball_count() const { return centre.size(); }
};

/// At most about `sample_limit` samples: in finer meshes one represents a patch of neighbouring vertices.
[[nodiscard]] MedialGraph build_medial_graph(const WallMesh& mesh, const MeshEdges& edges,
                                             const std::vector<BoundaryLoop>& openings, const LumenQuery& lumen,
                                             const Enclosure& enclosure, std::size_t sample_limit = 50000);

/// Cheapest paths from one ball: cost = length / radius^2; `length` is the plain length of that path [m].
struct MedialPaths {
    std::vector<int> towards_root;  // [B] next ball, -1 at the root and where it cannot be reached
    std::vector<double> length;     // [B] < 0 where it cannot be reached
};
[[nodiscard]] MedialPaths cheapest_paths(const MedialGraph& graph, int root);

}  // namespace seldinger
