#pragma once
// The steps of repair(), one function each; see repair.h for their order and reasons.

#include "vessel/wall_mesh.h"

namespace seldinger::repair_steps {

constexpr double kSliverQuality = 0.05;  // triangle_quality below which a triangle counts as a sliver

// repair_clean.cpp
[[nodiscard]] double median_edge(const WallMesh& mesh);  // of those longer than 0 [m]
void drop_non_finite(WallMesh& mesh, RepairReport& report);
void weld(WallMesh& mesh, RepairReport& report);
void drop_degenerate(WallMesh& mesh, RepairReport& report);  // two equal corners
void drop_duplicates(WallMesh& mesh, RepairReport& report);  // same three corners; folds
void drop_flaps(WallMesh& mesh, RepairReport& report);
void dissolve_needles(WallMesh& mesh, RepairReport& report);  // no height
void drop_unused_vertices(WallMesh& mesh);

// repair_orient.cpp
void orient(WallMesh& mesh, RepairReport& report);

// repair_holes.cpp
void close_holes(WallMesh& mesh, RepairReport& report);

}  // namespace seldinger::repair_steps
