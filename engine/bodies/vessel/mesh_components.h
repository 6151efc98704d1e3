#pragma once
// Parts of a mesh connected by edges, and the volume of each with capped openings.

#include "vessel/mesh_edges.h"

#include <algorithm>
#include <numeric>

namespace seldinger {

struct MeshComponent {
    std::vector<std::int32_t> triangles;
    Box3 box;
    double volume = 0;  // signed, openings capped [m^3]; > 0 when normals point out of it
    double area = 0;    // [m^2]
};

/// Sets of triangles that hang together over the edges for which joins(uses of the edge), numbered in the order of their first
/// triangles [T].
template <class Joins>
[[nodiscard]] std::vector<std::int32_t> label_sets(const WallMesh& mesh, const MeshEdges& edges, const Joins& joins)
{
    // disjoint sets: each triangle points to an earlier one of its set, the first to itself
    std::vector<std::int32_t> earlier(mesh.triangles.size());
    std::iota(earlier.begin(), earlier.end(), 0);
    const auto first_of = [&](std::int32_t t) {
        while (true) {
            std::int32_t& up = earlier[static_cast<std::size_t>(t)];
            if (up == t) return t;
            t = up = earlier[static_cast<std::size_t>(up)];
        }
    };
    for (std::size_t k = 0; k < edges.count(); ++k) {
        const auto uses = edges.uses(k);
        if (!joins(uses)) continue;
        std::int32_t least = first_of(uses[0] / 3);
        for (const std::int32_t h : uses.subspan(1)) {
            const std::int32_t other = first_of(h / 3);
            earlier[static_cast<std::size_t>(std::max(least, other))] = std::min(least, other);
            least = std::min(least, other);
        }
    }
    std::int32_t count = 0;
    for (std::size_t t = 0; t < earlier.size();
         ++t) {  // numbers take the place of what points to earlier ones, which have theirs
        const auto up = static_cast<std::size_t>(earlier[t]);
        earlier[t] = up == t ? count++ : earlier[up];
    }
    return earlier;
}

/// Component of each triangle [T], numbered in the order of their first triangles.
[[nodiscard]] std::vector<std::int32_t> label_components(const WallMesh& mesh, const MeshEdges& edges);

/// That of each vertex [V], of its last triangle; -1: no triangle has it.
[[nodiscard]] std::vector<std::int32_t> labels_of_vertices(const WallMesh& mesh, const std::vector<std::int32_t>& label);

/// Which vertices belong to the component of the largest area [V]; empty for a single component.
[[nodiscard]] std::vector<bool> vertices_of_largest(const WallMesh& mesh, const std::vector<std::int32_t>& label);

/// Volumes need consistent orientation within each component. Each loop is capped by a fan about its centre.
[[nodiscard]] std::vector<MeshComponent> measure_components(const WallMesh& mesh, const MeshEdges& edges,
                                                            const std::vector<std::int32_t>& label);

}  // namespace seldinger
