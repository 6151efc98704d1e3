#pragma once
// Input of contact: the wires of a world and its wall.

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "wall/wall_model.h"

#include <vector>

namespace seldinger {

struct ContactSetup {
    std::vector<WireSpec> wires;        // [wires]
    std::vector<ContactSpec> contacts;  // [wires]; detection, laws and precision are those of the first
    const WallModel& wall;              // outlives what is made from it
    bool known_velocities = false;      // steps may take contact at their start (TermTrial::before)

    /// Detection, laws and precision of all.
    [[nodiscard]] const ContactSpec& method() const { return contacts.front(); }
};

}  // namespace seldinger
