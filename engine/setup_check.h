#pragma once
// What can be said of a setup without a device: `seldinger check`.

#include "model.h"

namespace seldinger {

/// @throws Error BadScene: what World's constructor would refuse; the line names the member, what was expected and what to do
void check_world_setup(const WorldSetup& setup);

}  // namespace seldinger
