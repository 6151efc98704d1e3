// Sums and worst values over the instruments of a system.
#include "setup/joint_readings.h"

#include "engine.h"

#include <algorithm>

namespace seldinger {
namespace {

void add(EnergyLedger& to, const EnergyLedger& e)
{
    for (double EnergyLedger::*entry :
         {&EnergyLedger::hand, &EnergyLedger::outside, &EnergyLedger::forces, &EnergyLedger::material, &EnergyLedger::remesh,
          &EnergyLedger::wire, &EnergyLedger::friction, &EnergyLedger::contact, &EnergyLedger::wall, &EnergyLedger::damping,
          &EnergyLedger::scheme})
        to.*entry += e.*entry;
}

void add(MomentumBalance& to, const MomentumBalance& m)
{
    for (Vec3 MomentumBalance::*entry : {&MomentumBalance::held, &MomentumBalance::weight, &MomentumBalance::contact,
                                         &MomentumBalance::loads, &MomentumBalance::fed, &MomentumBalance::rate})
        to.*entry += m.*entry;
}

void add(WireReadings& to, const WireReadings& r)
{
    to.nodes += r.nodes;
    to.contacts += r.contacts;
    for (double WireReadings::*sum :
         {&WireReadings::contact_length, &WireReadings::normal, &WireReadings::normal_between, &WireReadings::friction,
          &WireReadings::sliding, &WireReadings::sticking, &WireReadings::rolling, &WireReadings::kinetic, &WireReadings::elastic,
          &WireReadings::gravitational, &WireReadings::force_energy, &WireReadings::remesh_energy, &WireReadings::energy_made})
        to.*sum += r.*sum;
    for (double WireReadings::*worst : {&WireReadings::overlap, &WireReadings::outside, &WireReadings::force_residual})
        to.*worst = std::max(to.*worst, r.*worst);
    if (r.overlap_share > to.overlap_share) {
        to.overlap_share = r.overlap_share;
        to.overlap_at = r.overlap_at;
    }
    to.base_force += r.base_force;
    add(to.energy, r.energy);
    add(to.momentum, r.momentum);
}

}  // namespace

WireReadings joint_readings(const World& world, int system)
{
    const auto [first, end] = world.wires_of(system);
    WireReadings joint = world.readings(first);
    for (int w = first + 1; w < end; ++w) add(joint, world.readings(w));
    return joint;
}

WireReadings joint_readings(std::span<const WireOutput> wires)
{
    WireReadings joint = wires.front().readings;
    for (const WireOutput& wire : wires.subspan(1)) add(joint, wire.readings);
    return joint;
}

ContactAlong joint_along(std::span<const WireOutput> wires, ContactAlong WireOutput::*which)
{
    ContactAlong joint = wires.front().*which;
    for (const WireOutput& wire : wires.subspan(1)) {
        const ContactAlong& one = wire.*which;
        if (one.per_length_max > joint.per_length_max) {
            joint.per_length_max = one.per_length_max;
            joint.per_length_at = one.per_length_at;
            joint.window = one.window;
            joint.widened = one.widened;
        }
        if (one.patch_force > joint.patch_force) {
            joint.patch_force = one.patch_force;
            joint.patch_at = one.patch_at;
        }
        joint.regions += one.regions;
        joint.extent += one.extent;
    }
    return joint;
}

WireReport joint_report(const World& world, int system)
{
    const auto [first, end] = world.wires_of(system);
    WireReport joint = world.report(first);
    for (int w = first + 1; w < end; ++w) {
        const WireReport& own = world.report(w);
        joint.flags |= own.flags;
        joint.newton_iterations = std::max(joint.newton_iterations, own.newton_iterations);
        joint.sub_steps = std::max(joint.sub_steps, own.sub_steps);
    }
    return joint;
}

}  // namespace seldinger
