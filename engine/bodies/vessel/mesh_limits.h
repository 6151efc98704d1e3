#pragma once
// Limits for the extent of a wall, and for the distance of its corners relative to its size.

#include "vessel/wall_mesh.h"

namespace seldinger {

/// Largest coordinate of a wall [m]. An aorta in micrometres that is read as metres must come through, so that its unit
/// can be said to be wrong; squares of squares of much larger numbers overflow in the device's float32.
constexpr double most_coordinate = 1e6;

/// Index of the first vertex with a coordinate that is no number or beyond most_coordinate; -1: all can be used.
[[nodiscard]] std::int64_t first_unusable_vertex(const WallMesh& mesh);

/// Refuses walls with stray vertices: one corner far away makes a spike, which would be reported, and entered, as a vessel of
/// that length. Strays are fewer than 0.5 % of the vertices and make the box twenty times as wide, or any number of vertices that
/// make float32 numbers coarser than 1 % of the edges.
/// @param median_edge  half of the edges are shorter [m]     @throws Error BadFile, naming the vertex that lies farthest off
void require_no_strays(const WallMesh& mesh, double median_edge);

}  // namespace seldinger
