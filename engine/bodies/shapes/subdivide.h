#pragma once
// Loop subdivision: every triangle becomes four, and the surface tends to a smooth one, so that the new triangles lie in planes
// of their own.

#include "vessel/wall_mesh.h"

namespace seldinger {

/// One round of Loop's scheme [Loop87], with his own weights. Rims of openings follow the cubic B-spline of their own points
/// alone, so an opening in a plane stays in it. Two kinds of vertices stay in place: those of a rim with more than two rim edges,
/// and those of edges with more than two triangles. Orientation is kept. O(T).
[[nodiscard]] WallMesh subdivide_loop(const WallMesh& mesh);

}  // namespace seldinger
