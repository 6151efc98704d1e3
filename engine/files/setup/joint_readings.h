#pragma once
// The instruments of a system read as one: values of several instruments in trace.csv and in a batch's table.

#include "output.h"

#include <span>

namespace seldinger {

class World;

/// What the hand does (inserted, turned, its force and torque) is the first one's; counts, forces and energies are sums; overlaps
/// and what else is a worst is the largest. Readings of a system; for one instrument its own, bit for bit.
[[nodiscard]] WireReadings joint_readings(const World& world, int system);
[[nodiscard]] WireReadings joint_readings(std::span<const WireOutput> wires);

/// What the instruments do to the wall, or to each other: the worst of loads, the sum of places. @param which  of them
[[nodiscard]] ContactAlong joint_along(std::span<const WireOutput> wires, ContactAlong WireOutput::*which);

/// The worst of all, all flags together.
[[nodiscard]] WireReport joint_report(const World& world, int system);

}  // namespace seldinger
