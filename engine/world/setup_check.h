#pragma once
// Checks of a setup without a device: `seldinger check`.

#include "model.h"

namespace seldinger {

/// What World's constructor asks first.
/// @throws Error BadScene: a setup that no world can be made from; the line names member, expected value and fix
void check_setup(const WorldSetup& setup);

}  // namespace seldinger
