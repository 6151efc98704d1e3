#pragma once
// The vessel's wall as a triangle soup with shared vertices, and the changes made to it on import.

#include "math/vec3.h"
#include "vessel/vessel_spec.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace seldinger {

/// Triangle mesh in metres, double precision, world frame. Normals (right-hand rule) point into the lumen once repaired.
struct WallMesh {
    std::vector<Vec3> vertices;                          // [V] [m]
    std::vector<std::array<std::int32_t, 3>> triangles;  // [T] indices into vertices
};

/// Boundary loop (an opening): ordered vertex indices, centre, mean radius, and unit direction into the lumen.
struct BoundaryLoop {
    std::vector<std::int32_t> vertices;
    Vec3 centre = Vec3::Zero();
    Vec3 inward = Vec3::UnitX();
    double radius = 0;  // [m]
};

/// Findings and repairs of the import. Counts are of triangles unless the name says otherwise.
struct RepairReport {
    long triangles_read = 0, triangles = 0, vertices = 0;
    long vertices_welded = 0, non_finite_dropped = 0, degenerate_dropped = 0, duplicates_dropped = 0, flipped = 0;
    long non_manifold_edges = 0, boundary_edges = 0, components = 0, hole_loops_closed = 0, slivers = 0;
    bool inverted = false;            // the whole surface pointed out of the lumen and was turned
    std::vector<BoundaryLoop> loops;  // openings
    std::vector<Vec3> unreached;      // ends of the vessel that its centreline does not reach, one place in each [m]
    std::vector<std::string> notes;   // one sentence each, for people
};

}  // namespace seldinger
