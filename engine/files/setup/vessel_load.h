#pragma once
// From a vessel's description to a repaired wall with its centreline: reads a mesh file or generates a shape.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

#include <string>

namespace seldinger {

struct WallMechanics;  // wall/wall_readings.h

struct LoadedVessel {
    WallMesh mesh;  // metres, repaired, normals into the lumen
    RepairReport report;
    Centreline centreline;  // exact for generated shapes
};

/// @throws Error BadFile (missing, unreadable, empty, no usable triangle), BadScene (impossible sizes)
[[nodiscard]] LoadedVessel load_vessel(const VesselSpec& spec);

/// Where an elastic wall is thicker than half of the lumen in it, and is no thin shell. @return a sentence; empty: nowhere
[[nodiscard]] std::string describe_thick_wall(const VesselSpec& spec, const Centreline& centreline);

/// A warning where the edges of an elastic wall's control mesh are longer than the length over which a dent decays; else nothing.
/// Errors by wall_mesh_band (docs/wall.md). @param wall  edge_touched: the edge that is judged
[[nodiscard]] std::string describe_coarse_wall(const WallMechanics& wall, const VesselSpec& spec);

}  // namespace seldinger
