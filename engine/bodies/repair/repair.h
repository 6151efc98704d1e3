#pragma once
// Makes a wall of a file's mesh: welds, drops degenerate and double triangles, orients normals into the lumen, closes small
// holes, finds the openings, and reports all of it.

#include "vessel/wall_mesh.h"

namespace seldinger {

/// Repairs in place, in this order:
///  1. triangles with a non-finite corner are removed.
///  2. vertices nearer than the weld tolerance become one: min(1e-6 of the bounding box's diagonal, 1e-3 of the median
///     edge). The first covers coordinates printed with six digits or stored in float32 metres from the origin; the second keeps
///     real triangles from being welded, however fine. Distances are to the cluster's first vertex, so no chains form.
///  3. triangles with two equal corners and second copies are removed. If two triangles face each other, one stays where the
///     wall was written twice. Both are removed where they are a fold with no lumen between.
///  4. flaps are removed: the loosest triangle of an edge that an odd number share, if another of its edges is open.
///  5. orientation spreads over edges of two triangles, then over worse ones. Each component is turned so that its volume,
///     openings capped, is that of a lumen seen from inside. A component inside an odd number of others counts as an obstacle.
///  6. loops of the boundary that are holes and not openings are closed (see hole_by in repair_holes.cpp).
///  7. needle triangles without height are dissolved into their neighbour, which is split at their tip.
///  8. openings, components, non-manifold edges and slivers (quality below 0.05) are counted.
/// @param holes  whether step 6 is taken
/// @throws Error BadFile when no wall is left: no finite triangle, or a patch so flat that it bounds no lumen.
[[nodiscard]] RepairReport repair(WallMesh& mesh, bool holes = true);

/// Counts and openings of a mesh that needs no repair (generated shapes). Does not change it.
[[nodiscard]] RepairReport describe(const WallMesh& mesh);

}  // namespace seldinger
