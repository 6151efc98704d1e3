#pragma once
// Length of each pixel's ray inside a closed mesh: depths of the faces where it leaves minus depths of those where it enters.
//
// Corners are rounded to 1/4096 pixel, and a pixel centre on an edge belongs to one of its two faces (top-left rule). So in a
// closed mesh every ray leaves as often as it enters, and rounding affects only the silhouette. 1/depth is linear on the
// detector. Rows are dealt to threads in bands, and the faces of a band keep their order: the same bits on any number of threads.

#include "vessel/wall_mesh.h"
#include "xray/c_arm.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// A copy whose openings are closed by fans about their centres, which are appended to the vertices.
[[nodiscard]] WallMesh close_openings(const WallMesh& mesh);

/// A stretch of a ray inside the mesh and what the mesh's vertices say at its ends.
struct PathInterval {
    std::int32_t pixel;
    float length;    // [m]
    float from, to;  // values where the ray enters and leaves
};

struct MeshPaths {
    std::vector<float> length;            // [rows x columns] inside the mesh [m]
    std::vector<PathInterval> intervals;  // ordered by pixel; of a mesh with values only
    long mended = 0;                      // pixels whose ray left another number of times than it entered: taken from beside them
};

/// @param closed  normals into it. @param value  per vertex, or empty
/// @throws Error BadScene: a vertex not between source and detector
[[nodiscard]] MeshPaths trace_mesh(const CArmView& view, const WallMesh& closed, std::span<const float> value = {});

/// @return the ray's length inside the ellipsoid with these half axes along unit vectors `axes` about `centre` [rows x columns]
[[nodiscard]] std::vector<float> trace_ellipsoid(const CArmView& view, const Vec3& centre, const Mat3& axes, const Vec3& half);

}  // namespace seldinger
