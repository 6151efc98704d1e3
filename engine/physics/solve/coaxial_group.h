#pragma once
// Instruments that share one centreline (D12) among the wires of a system.
//
// The first of them (the outermost) is the line: its arrays hold the centreline's nodes, positions and frames, and the spin
// angles of the outermost instrument. The others are its passengers: as many nodes at the same places, with the same frames, of
// which only the spin angles are unknowns of their own. So every instrument has arrays in which its material lies along the
// centreline. Forces on an instrument's surface (contact with the wall, friction) are evaluated on its own arrays; their effect
// on a passenger's positions goes to the line's.
//
// The last node's angle is that of the clamp at the hub (rod/coaxial.h).

#include "rod/coaxial.h"

#include <vector>

namespace seldinger {

struct CoaxialGroup {
    std::vector<int> wires;                    // of the world, outer first
    CoaxialRod rod;                            // its angles are scratch: they are kept in the wires' arrays
    CoaxialBase base;                          // at the end of the step
    std::array<double, most_coaxial> clamp{};  // angle at the clamp at the end of the step, where the hand is there [rad]
    std::array<double, most_coaxial> fed{};    // pushed over the present step, along the line [m]
    [[nodiscard]] int line() const { return wires.front(); }
    [[nodiscard]] int count() const { return static_cast<int>(wires.size()); }
};

}  // namespace seldinger
