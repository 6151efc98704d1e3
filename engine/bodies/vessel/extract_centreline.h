#pragma once
// The vessel's axis from its wall: a tree of medial points with the radius of the largest sphere that fits there.
//
// 1. Every wall vertex gets its medial ball: the largest ball inside the lumen that touches the wall there, found by shrinking
//    [Ma, Bae & Choi 2012, doi:10.1007/s00371-011-0594-7], against exact triangles. A grid would have to resolve the
//    narrowest branch everywhere: 0.2 mm in a volume of 0.2 m; balls resolve each branch by its own wall.
// 2. Balls that larger ones make superfluous go; those left are linked where they overlap, so that links stay inside the
//    lumen. A link costs length / radius^2, so cheapest paths keep to the middle [Antiga et al. 2003,
//    doi:10.1109/TMI.2003.812261 use 1 / radius on Voronoi poles].
// 3. From the root, the farthest piece of wall that no path serves yet gets a path, until all are served; openings come first
//    [Sato et al. 2000, TEASAR, doi:10.1109/PCCGA.2000.883951]. Corners of lumens that are not round are distinguished from
//    branches.
// 4. Each path is resampled at about half its radius, smoothed, and its points climb to the local maximum of the exact
//    distance to the wall across the path.

#include "vessel/centreline.h"
#include "vessel/inside.h"
#include "vessel/wall_mesh.h"

namespace seldinger {

/// What a found centreline leaves out.
struct CentrelineGaps {
    std::vector<Vec3> unreached;  // a place in each branch that is too fine for its triangles to have a path [m]
    int side_by_side = 0;         // paths beside the axis of a flat lumen
};

/// @param lumen  of the same mesh and openings
/// @return a tree with its root at the widest opening, or in a closed mesh at the wider end of the longest path;
///         empty when no ball fits (a plane)
/// @param gaps  out, may be null
[[nodiscard]] Centreline extract_centreline(const WallMesh& mesh, const std::vector<BoundaryLoop>& openings,
                                            const LumenQuery& lumen, CentrelineGaps* gaps = nullptr);

}  // namespace seldinger
