#pragma once
// The steps of repair(), one function each; see repair.h for their order and reasons.

#include "vessel/mesh_edges.h"
#include "vessel/wall_mesh.h"

#include <optional>
#include <vector>

namespace seldinger::repair_steps {

constexpr double kSliverQuality = 0.05;  // triangle_quality below which a triangle counts as a sliver

/// A note of so many, if any.
void note(RepairReport& report, long number, const char* one, const char* many);

// repair_clean.cpp
[[nodiscard]] double median_edge(const WallMesh& mesh);  // of those longer than 0 [m]
void drop_non_finite(WallMesh& mesh, RepairReport& report);
void weld(WallMesh& mesh, RepairReport& report);
void drop_degenerate(WallMesh& mesh, RepairReport& report);  // two equal corners
void drop_duplicates(WallMesh& mesh, RepairReport& report);  // same three corners; folds
[[nodiscard]] MeshEdges drop_flaps(WallMesh& mesh, RepairReport& report);  // the edges that are left
/// Vertices on rims of different parts that nearly meet become one. @param edges  in and out: the mesh's
void weld_rims(WallMesh& mesh, MeshEdges& edges, RepairReport& report);
/// A few triangles that hang on a corner of a large part, as a ragged cut leaves them. @param edges  in and out: the mesh's
void drop_crumbs(WallMesh& mesh, MeshEdges& edges, RepairReport& report);
/// Triangles of no height. @param edges  in and out: the mesh's
void dissolve_needles(WallMesh& mesh, MeshEdges& edges, RepairReport& report);
void drop_unused_vertices(WallMesh& mesh);

// repair_orient.cpp
/// @param edges  in and out: the mesh's
void orient(WallMesh& mesh, MeshEdges& edges, RepairReport& report);

// repair_sides.cpp
struct WallSides {
    WallMesh even;            // the mesh without noise
    std::vector<bool> inner;  // [T] whether a triangle bounds the lumen
};
/// The sides of a wall that was modelled with its thickness and is one surface. Such a wall is a sheet (its volume is half of
/// area times thickness), one side is enclosed much more than the other across it, and what that side encloses is wider than the
/// wall. Rims count as outer. Noise is averaged out first. Nothing where the mesh is no such wall. Needs consistent orientation
[[nodiscard]] std::optional<WallSides> sides_of_wall(const WallMesh& mesh, const MeshEdges& edges);

// repair_shells.cpp
/// Where a vessel's wall is modelled with its thickness, as printers, tissue models and segmentations give it, leaves the inner
/// shell only. Shells run along each other, one inside the other, with areas of at most 1.8 to 1: separate parts; or the sides of
/// one (3 to 1). Needs consistent orientation. @param as_read  triangles that stay beside the mesh's  @return whether any went
/// @throws Error BadFile: a wall whose inner side cannot be told
bool take_inner_shell(WallMesh& mesh, const MeshEdges& edges, std::vector<std::array<std::int32_t, 3>>& as_read,
                      RepairReport& report);

// repair_holes.cpp
/// @param edges  in and out: the mesh's
void close_holes(WallMesh& mesh, MeshEdges& edges, RepairReport& report);

}  // namespace seldinger::repair_steps
