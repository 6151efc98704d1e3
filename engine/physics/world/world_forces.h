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
class ElasticWall;        // wall/elastic_wall.h
class InstrumentContact;  // contact/rods/instrument_contact.h
class LineHolds;          // solve/line_holds.h
class SystemList;         // world/systems.h
class WallContact;        // contact/wall_contact.h
class ElasticContact;       // contact/elastic/elastic_contact.h
namespace device {
class Context;  // device/device.h
}

/// What contact is made from.
[[nodiscard]] ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall);
[[nodiscard]] InstrumentSetup instrument_setup(const WorldSetup& setup, std::span<const int> system_of);

struct WorldForces {
    /// The wall alone: wires are placed before anything touches them. @param made  the elastic wall of this setup, if there is
    /// one already
    explicit WorldForces(const WorldSetup& setup, std::shared_ptr<const ElasticWall> made = {});
    ~WorldForces();
    /// Contact with the wall and between instruments.
    void make_contacts(const WorldSetup& setup, const SystemList& systems, RodArrays& rods);

    std::unique_ptr<device::Context> context;        // none without a vessel and without instruments that touch
    std::optional<WallModel> wall;                   // none without a vessel
    std::shared_ptr<const ElasticWall> elastic_wall;  // only of an elastic vessel, and so the next two; twins share it
    std::unique_ptr<RodArrays> unmoved_rods;         // the wires as the wall sees them where it has not moved
    std::unique_ptr<ContactMethod> contact;          // none without a vessel
    std::unique_ptr<ElasticContact> elastic;          // in front of it, of an elastic vessel
    WallContact* wall_contact = nullptr;             // contact as the wires feel it, one of the two
    std::unique_ptr<InstrumentContact> instruments;  // of those that can touch each other
    std::unique_ptr<CoaxialFriction> coaxial_friction;  // between those that share a centreline
    std::unique_ptr<LineHolds> line_holds;              // of instruments that share a centreline; none without
    ForceTerms terms;                                // all of them

    /// Contacts of the accepted state, in an order that does not depend on the device.
    [[nodiscard]] std::vector<ContactRow> rows(RodArrays& rods) const;
};

}  // namespace seldinger
