// One rod of a world, of K >= 1 instruments: what its stages ask of the accepted state.
#include "world/world_rod.h"

#include <algorithm>

namespace seldinger {
namespace {

/// Moments and torques of instruments on one centreline; a wire's planner has its own.
void measure(WorldData& world, MergedGroup& group, NodeDemands& demands)
{
    refresh_group(world, group);
    const RodView line = world.rod(group.line());
    const CoaxialTrial now = accepted_trial(world.state.rods, group.wires());
    const auto n = static_cast<std::size_t>(line.n);
    const std::span<Vec3> moment = std::span(group.moment).first(n);
    const std::span<double> turning = std::span(group.turning).first(n);
    if (update_coaxial(group.shared.rod, line, now, group.shared.base, group.frames)) {
        measure_coaxial({group.shared.rod, line, now, group.shared.base, group.frames}, moment, turning);
    } else {
        std::ranges::fill(moment, Vec3::Zero());
        std::ranges::fill(turning, 0.0);
    }
    demands.moment = moment;
    demands.turning = turning;
}

}  // namespace

void WorldRod::lead(double h) const
{
    if (group_) lead_group(world_, *group_, h);
}

double WorldRod::lead_change(double dt) const { return group_ ? lead_change_after(world_, *group_, dt) : 0; }

void WorldRod::push(double step, double h) const
{
    if (group_) return feed_group(world_, *group_, step, h);
    feed_to(feed(), hub().at(world_.state.wires[line_].time + step), bounds(), world_.state.rods, line_, h);
}

void WorldRod::constrain(int wire, double t) const
{
    if (group_) return constrain_member(world_, *group_, wire, t);
    world_.holds[wire].fill(t, view(), world_.constraints(wire));
    if (feed().on) add_feed_constraints(feed(), view(), world_.constraints(wire));
}

void WorldRod::load() const
{
    if (group_) return load_members(world_, *group_);
    for (const LoadSpec& load : world_.work.wires[line_].loads)
        WireHolds::add_load(load, 0, view(), 0, 0, world_.constraints(line_));
}

void WorldRod::refresh() const
{
    if (group_) refresh_group(world_, *group_);
    else constrain(line_, world_.state.wires[line_].time);
}

double WorldRod::elastic_energy() const
{
    if (group_) return elastic_now(world_.state.rods, *group_);
    world_.work.split.provide(world_.state.rods.capacity(line_));
    return energy_now(view(), world_.constraints(line_).clamps, world_.work.split.frames);
}

NodeDemands WorldRod::demands() const
{
    NodeDemands demands;
    demands.kept = world_.adapter(line_).kept;
    demands.fed = feed().on;
    for (const RodClamp& clamp : world_.constraints(line_).clamps)
        if (clamp.direction && clamp.node == view().n - 1) demands.hub_tangent = clamp.tangent;
    if (!group_) return demands;
    demands.hub_tangent = group_->shared.base.tangent;
    measure(world_, *group_, demands);
    return demands;
}

std::span<const Vec3> WorldRod::contact() const
{
    const auto n = static_cast<std::size_t>(view().n);
    const auto force_on = [&](int w) { return std::span<const Vec3>(world_.output.results[w].nodal_contact).first(n); };
    if (!group_) return force_on(line_);
    group_->contact.assign(n, Vec3::Zero());
    for (const int w : wires())
        for (std::size_t i = 0; i < n; ++i) group_->contact[i] += force_on(w)[i];
    return group_->contact;
}

}  // namespace seldinger
