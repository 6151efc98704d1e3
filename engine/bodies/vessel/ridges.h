#pragma once
// Ridges of a wall: edges that stand out into the lumen, over which a wire is bent or pressed at a point.

#include "vessel/wall_mesh.h"

namespace seldinger {

/// Mean angle between the facets at ridges, weighted by their length [rad]; 0 without any. On a finely meshed wall it goes to 0
/// with the facets' size. O(T).
/// @param mesh  normals into the lumen
/// @param least_facet  ridges of facets whose longest side is shorter are left out: the wire does not feel smaller ones as single
///                     ridges [m]
[[nodiscard]] double mean_ridge_angle(const WallMesh& mesh, double least_facet);

}  // namespace seldinger
