// Contact of a world's wires: made from its setup, asked for what wall and instruments do together.
#include "world/world_forces.h"

#include "contact/contact_system.h"
#include "contact/rods/coaxial_friction.h"
#include "contact/rods/instrument_contact.h"
#include "contact/wall_body.h"
#include "device/enumerate.h"
#include "solve/given_forces.h"
#include "solve/line_holds.h"
#include "world/systems.h"

#include <algorithm>
#include <tuple>

namespace seldinger {

ContactSetup contact_setup(const WorldSetup& setup, const WallModel& wall)
{
    ContactSetup made{{}, {}, wall, false};
    for (const WireSetup& wire : setup.wires) {
        made.wires.push_back(wire.wire);
        made.contacts.push_back(wire.contact);
    }
    const Scheme scheme = setup.integrator.scheme;
    made.known_velocities = scheme == Scheme::Linearised || scheme == Scheme::Explicit;
    return made;
}

InstrumentSetup instrument_setup(const WorldSetup& setup, std::span<const int> system_of)
{
    InstrumentSetup made;
    for (const WireSetup& wire : setup.wires) {
        made.wires.push_back(wire.wire);
        made.contacts.push_back(wire.contact);
    }
    made.system_of.assign(system_of.begin(), system_of.end());
    for (const CoaxialSpec& nest : setup.coaxial)
        if (nest.model == CoaxialSpec::Model::Separate)
            made.nested.push_back({nest.order, nest.mu_static, nest.mu_sliding, nest.stiffness, nest.exchanged});
    made.from_outside = setup.instruments_touch;
    return made;
}

WorldForces::WorldForces(const WorldSetup& setup, std::shared_ptr<const WallBody> made) : wall_body(std::move(made))
{
    if (setup.mesh.triangles.empty()) return;
    wall.emplace(setup.vessel, setup.mesh, setup.centreline);
    if (setup.vessel.elastic && !wall_body) wall_body = make_wall_body(*wall);
}

WorldForces::~WorldForces() = default;

void WorldForces::make_contacts(const WorldSetup& setup, const SystemList& systems, RodArrays& rods)
{
    if (setup.device_index >= 0) device::check_device_index(setup.device_index);  // also where no vessel needs one
    if (wall) {
        context = std::make_unique<device::Context>(setup.device_index, setup.wires[0].contact.precision == Precision::Float32);
        if (wall_body) unmoved_rods = std::make_unique<RodArrays>(rods);
        contact = make_contact(*context, contact_setup(setup, *wall), unmoved_rods ? *unmoved_rods : rods);
        wall_contact = contact.get();
        if (wall_body) {
            with_body = wall_body->contact(*contact, rods, *unmoved_rods, systems.of_each());
            wall_contact = with_body.get();
        }
        terms.add(*wall_contact);
    }
    const InstrumentSetup touching = instrument_setup(setup, systems.of_each());
    if (!touching.any()) return;
    if (!context) context = std::make_unique<device::Context>(setup.device_index);
    instruments = std::make_unique<InstrumentContact>(*context, touching, rods);
    terms.add(*instruments);
}

void WorldForces::set_time(int wire, double time, double dt) const
{
    if (given) given->set_time(wire, time, dt);
}

bool WorldForces::conclude(std::span<const std::uint8_t> wires) const
{
    if (given) given->conclude(wires);
    return !raised();
}

bool WorldForces::raised() const { return given && given->raised(); }

void WorldForces::raise() const
{
    if (given) given->raise();
}

std::vector<ContactRow> WorldForces::rows(RodArrays& rods) const
{
    std::vector<ContactRow> list;
    if (wall_contact) list = wall_contact->rows(rods);
    if (!instruments) return list;
    for (ContactRow& row : instruments->rows(rods)) list.push_back(row);
    std::sort(list.begin(), list.end(), [](const ContactRow& p, const ContactRow& q) {
        const auto key = [](const ContactRow& row) {
            return std::tuple(row.a.body, row.a.element, row.b.kind, row.b.body, row.b.element, row.point.x(), row.point.y());
        };
        return key(p) < key(q);
    });
    return list;
}

}  // namespace seldinger
