#pragma once
// Where instruments will touch an elastic wall, from a trial run of the scene with a rigid one. The control mesh is fine there
// (surface/control_mesh.h): a dent is a few tenths of a millimetre to a few millimetres wide, and no mesh of one size resolves
// that on a whole vessel.

#include "engine.h"

#include <functional>
#include <span>

namespace seldinger {

struct Scene;

/// Runs the scenes of the setup's systems with a rigid wall, in steps of at least 4 ms, and sets setup.vessel.touched. It changes
/// nothing if the wall is rigid, if vessel.wall_edge_m is given, or without a wall. A trial run that ends early leaves the points
/// found so far. The same scenes give the same points.
/// @param asked  ends the trial run; may be empty
/// @throws Error Interrupted, if asked
void find_wall_path(std::span<const Scene> scenes, WorldSetup& setup, const std::function<bool()>& asked = {});

}  // namespace seldinger
