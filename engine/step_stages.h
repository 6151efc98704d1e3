#pragma once
// The stages of step.cpp. Each opens the timer of its name.

#include "world.h"

#include <cstdint>
#include <vector>

namespace seldinger {

using WireMask = std::vector<std::uint8_t>;

/// All wires but the retired ones.
[[nodiscard]] WireMask everyone(const World::Impl& state);
void clear_timers(World::Impl& state);
void collect_timers(World::Impl& state, StepReport& report);

/// Nothing of the last step is needed any more.
void begin_step(World::Impl& state);

/// Advances the wires of the mask by h. A wire that does not converge is put back and advanced by two half steps instead, down to
/// h / 512; a wire that misses the tolerance even then takes the best state found (the report says so), and one that finds none stays
/// at the start of that sub-step. A wire of which more than an edge is fed goes in parts, split and merged in between.
/// What one wire does has no say in what the others do, and is noted in its own report and in `report`, the worst of all.
/// @return wires that failed for good
WireMask advance(World::Impl& state, double h, const WireMask& mask, StepReport& report);

/// Static equilibrium with contact (scheme "static", start "settled").
void find_equilibrium(World::Impl& state, StepReport& report);

/// Splits and merges edges where the shape asks for it, after a step of dt [s]; wires of a given node number at the hub only.
void adapt_nodes(World::Impl& state, double dt);
void check_state(World::Impl& state, StepReport& report);

}  // namespace seldinger
