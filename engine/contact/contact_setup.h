#pragma once
// What contact is made from: the wires of a world and the wall beside them.

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "wall/wall_model.h"

#include <algorithm>
#include <vector>

namespace seldinger {

struct ContactSetup {
    std::vector<WireSpec> wires;        // [wires]
    std::vector<ContactSpec> contacts;  // [wires]; detection, laws and precision are those of the first
    const WallModel& wall;              // outlives what is made from it
    bool known_velocities = false;      // steps may take contact at their start (ForceTerm::evaluate_start)
    std::vector<int> systems = {};      // [wires] whose wall each wire meets; empty: all that of system 0
    bool wall_moves = false;            // ContactMethod::move_wall may be called

    [[nodiscard]] int system_of(std::size_t wire) const { return systems.empty() ? 0 : systems[wire]; }
    [[nodiscard]] int system_count() const { return systems.empty() ? 1 : 1 + *std::max_element(systems.begin(), systems.end()); }
    /// Detection, laws and precision of all.
    [[nodiscard]] const ContactSpec& method() const { return contacts.front(); }
};

}  // namespace seldinger
