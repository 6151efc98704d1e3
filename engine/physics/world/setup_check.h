#pragma once
// Checks of a setup without a device: `seldinger check`.

#include "model.h"

namespace seldinger {

/// What World's constructor asks first.
/// @throws Error BadScene: a setup that no world can be made from; the line names member, expected value and fix
void check_setup(const WorldSetup& setup);

/// All that World's constructor refuses of a setup: that, places of wires and their holds, the mesh of an elastic wall.
/// @throws Error BadScene, BadFile: as World's constructor
void check_start(const WorldSetup& setup);

/// A contact cannot need less force to start sliding than to continue: the rule for every pair of coefficients.
[[nodiscard]] constexpr bool friction_in_order(double mu_static, double mu_sliding) { return mu_static >= mu_sliding; }

}  // namespace seldinger
