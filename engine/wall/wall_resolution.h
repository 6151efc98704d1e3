#pragma once
// Edges of an elastic wall's control mesh relative to the decay length of a dent.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"
#include "wall/wall_readings.h"

namespace seldinger {

/// Length over which the dent of a ring (tube) or line (plane) load decays [m]: 1/beta, beta^4 = (E t/R^2 + k_s)/(4 D)
/// [Hetenyi46, sec. 30]; infinite for a plane on nothing. @param lumen_radius  R [m]; infinite: a plane
[[nodiscard]] double decay_length(const VesselSpec& spec, double lumen_radius);

/// Vertices, mean edge and decay length of the control mesh that a world would make, by the scene's edge or the one that is
/// chosen. What only a made wall has is 0.
[[nodiscard]] WallMechanics expected_mechanics(const VesselSpec& spec, const WallMesh& mesh, const Centreline& centreline);

}  // namespace seldinger
