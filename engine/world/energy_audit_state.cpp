// State of the watch over a wire's energy, from which a run resumes.

#include "core/state_walk.h"
#include "world/energy_audit.h"

namespace seldinger {

void walk_audit(StateWalk& walk, EnergyAudit& audit)
{
    const StateRow energy{"an energy", "J", "accept"};
    std::uint8_t known = audit.known;
    walk({"an energy's flag", "", "accept"}, known);
    audit.known = known != 0;
    walk.numbers(energy, audit.balance);
    walk.numbers(energy, audit.ledger);
    for (double* value : {&audit.wire_then, &audit.elastic_then, &audit.moving, &audit.remeshed}) walk(energy, *value);
    walk({"a hand's force", "N", "accept"}, audit.hand_force);
    walk({"a feed's speed", "m/s", "accept"}, audit.speed);
    for (auto* list : {&audit.held, &audit.held_speed, &audit.torque, &audit.turns})
        walk.list<std::int32_t>({"a reaction", "N, m/s, N m, rad", "accept"}, *list);
}

}  // namespace seldinger
