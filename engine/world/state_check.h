#pragma once
// Checks of a saved state before any computation with it: others may have made the file.

#include "world/world.h"

#include <cstdint>

namespace seldinger {

/// Numbers of one instrument as they were read, before they are used. @throws Error BadFile
void check_saved_wire(const World::Impl& state, int wire);
/// Its ledger and the time. @throws Error BadFile
void check_saved_audit(const EnergyAudit& audit);
void check_saved_time(double time, std::int64_t steps);

}  // namespace seldinger
