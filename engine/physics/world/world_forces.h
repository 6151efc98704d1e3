#pragma once
// All that acts on the wires of a world, wall and device included. It is made once; only the memory of its force terms changes
// (ForceTerm::walk_state).

#include "contact/contact_row.h"
#include "contact/contact_setup.h"
#include "contact/rods/instrument_cells.h"
#include "model.h"
#include "solve/force_term.h"

#include <memory>
#include <optional>

namespace seldinger {

class CoaxialFriction;    // contact/rods/coaxial_friction.h
class ContactMethod;      // contact/contact_system.h
class InstrumentContact;  // contact/rods/instrument_contact.h
class GivenForces;        // solve/given_forces.h
class LineHolds;          // solve/line_holds.h
class SystemList;         // world/systems.h
class WallBody;           // contact/wall_body.h
class WallContact;        // contact/wall_contact.h
namespace device {
class Context;  // device/device.h
}

/// What contact is made from.
[[nodiscard]] ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall);
[[nodiscard]] InstrumentSetup instrument_setup(const WorldSetup& setup, std::span<const int> system_of);

struct WorldForces {
    /// The wall alone: wires are placed before anything touches them. @param made  the wall body of this setup, if there is one
    explicit WorldForces(const WorldSetup& setup, std::shared_ptr<const WallBody> made = {});
    ~WorldForces();
    /// Contact with the wall and between instruments.
    void make_contacts(const WorldSetup& setup, const SystemList& systems, RodArrays& rods);

    std::unique_ptr<device::Context> context;        // none without a vessel and without instruments that touch
    std::optional<WallModel> wall;                   // none without a vessel
    std::shared_ptr<const WallBody> wall_body;       // only of a wall that deforms, and so the next; twins share it
    std::unique_ptr<RodArrays> unmoved_rods;         // the wires as the wall sees them where it has not moved
    std::unique_ptr<ContactMethod> contact;          // none without a vessel
    std::unique_ptr<WallContact> with_body;          // in front of it, of a wall that deforms
    WallContact* wall_contact = nullptr;             // contact as the wires feel it, one of the two
    std::unique_ptr<InstrumentContact> instruments;  // of those that can touch each other
    std::unique_ptr<CoaxialFriction> coaxial_friction;  // between those that share a centreline
    std::unique_ptr<LineHolds> line_holds;              // of instruments that share a centreline; none without
    std::unique_ptr<GivenForces> given;                 // World::add_force; none without
    ForceTerms terms;                                // all of them
    /// For forces that depend on it: time at the end of the next trials, their length (0: an equilibrium) [s].
    void set_time(int wire, double time, double dt) const;
    /// What is to change in forces at the end of a sub-step: their own state. @return false: one has raised, there or before
    [[nodiscard]] bool conclude(std::span<const std::uint8_t> wires) const;
    /// Whether a force of the program has raised since raise(), which throws that.
    [[nodiscard]] bool raised() const;
    void raise() const;
    /// Whether anything may act on a wire as it is placed that is not known before the first step: contact, holds of groups.
    [[nodiscard]] bool are_unknown() const { return terms.count() > (given ? 1 : 0); }

    /// Contacts of the accepted state, in an order that does not depend on the device.
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) const;
};

}  // namespace seldinger
