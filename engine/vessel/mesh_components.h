#pragma once
// Parts of a mesh connected by edges, and the volume of each with capped openings.

#include "vessel/mesh_edges.h"

namespace seldinger {

struct MeshComponent {
    std::vector<std::int32_t> triangles;
    Box3 box;
    double volume = 0;  // signed, openings capped [m^3]; > 0 when normals point out of it
    double area = 0;    // [m^2]
};

/// Component of each triangle [T], numbered in the order of their first triangles.
[[nodiscard]] std::vector<std::int32_t> label_components(const WallMesh& mesh, const MeshEdges& edges);

/// Which vertices belong to the component of the largest area [V]; empty for a single component.
[[nodiscard]] std::vector<bool> vertices_of_largest(const WallMesh& mesh, const std::vector<std::int32_t>& label);

/// Volumes need consistent orientation within each component. Each loop is capped by a fan about its centre.
[[nodiscard]] std::vector<MeshComponent> measure_components(const WallMesh& mesh, const MeshEdges& edges,
                                                            const std::vector<std::int32_t>& label);

}  // namespace seldinger
