#pragma once
// Contact force per length along a wire, smoothed, from the contacts of a frame: what a picture colours a wire by. Unlike the
// force of one contact it does not depend on how densely a wire is sampled for contact.

#include "view/renderer.h"

namespace seldinger {

inline constexpr double load_window = 5e-3;  // [m] width at half height of the triangle that a contact's force is spread over

/// Force per length [N/m] of one wire's nodes and of the contacts.
struct FrameLoads {
    std::vector<double> nodes, contacts;
    double largest = 0;  // along the wire
};

/// Loads of a single wire; empty for several wires, whose colours tell them apart, and without contacts.
[[nodiscard]] FrameLoads loads_of(const WireFrame& frame);

}  // namespace seldinger
