// The adapt stage: splits and merges edges between steps, and births at the inlet of a fed wire.

#include "contact/yielding_wall.h"
#include "core/clock.h"
#include "wall/elastic_wall.h"
#include "world/merged.h"
#include "world/step_stages.h"
#include "world/world.h"

#include <cmath>

namespace seldinger {

namespace {

// Nodes come at once and go slowly: a wire that shivers is not to lose and get the same node over and over.
constexpr int merge_period = 16;  // steps

// @return whether it did anything
bool adapt_base(WorldData& world, int w, const BaseEdge& limits)
{
    const int n = world.state.rods.node_count(w);
    const HubChange change = adapt_hub(world.feed(w), world.setup.wires[w].wire, world.state.rods, w, limits, world.work.hub_scratch);
    if (!change.changed) return false;
    world.state.wires[w].remesh_energy += change.energy;
    renumber_forces(world.output.results[w].nodal_contact, n, {world.state.rods.node_count(w) > n, n - 2, 0});
    return true;
}

// When a fed wire's base edge changes: a node is born when `whole` is inside, and goes when it is pulled back to the inlet.
BaseEdge base_limits(const WorldData& world, int w, double whole, double dt)
{
    const HubPath hub = world.work.wires[w].hub.path();
    const double t = world.state.wires[w].time, next = std::isfinite(dt) ? t + dt : t;
    // symplectic Euler follows no axial wave along an edge that is much shorter than the others, and one linearised step no turn of it
    const Scheme scheme = world.setup.integrator.scheme;
    if (scheme == Scheme::Explicit || scheme == Scheme::Linearised) return {whole, 0.5 * whole, 0.5 * whole};
    return base_edge_limits(whole, hub.travel(t, next, +1), hub.travel(t, next, -1));
}

void change_nodes(WorldData& world, int w, std::span<const NodeChange> changes)
{
    const WireSpec& spec = world.setup.wires[w].wire;
    NodeAdapter& adapter = world.adapter(w);
    constrain_now(world, w);
    const double before = energy_now(world.rod(w), world.constraints(w).clamps, adapter.frames);
    const WireNodes nodes(world.state.rods, w, spec, world.constraints(w).clamps, spec.place.rest_is_placed && !world.feed(w).on);
    world.feed(w).surplus += apply_changes(nodes, changes);
    constrain_now(world, w);
    int n = world.state.rods.node_count(w) - static_cast<int>(changes.size()) * (changes.front().split ? 1 : -1);
    for (const NodeChange& change : changes) renumber_forces(world.output.results[w].nodal_contact, change.split ? n++ : n--, change);
    world.state.wires[w].remesh_energy += energy_now(world.rod(w), world.constraints(w).clamps, adapter.frames) - before;
}

// A law that never overlaps takes no change of nodes that would put the wire into the wall: it waits until the wire has moved on.
// @param change  returns whether it did anything     @return whether something was done, and stands
template <class Change>
bool where_clear(WorldData& world, int w, Change change)
{
    if (!world.forces.terms.traits().never_overlaps) return change();
    keep_wire(world, w);
    world.work.nodal_backup = world.output.results[w].nodal_contact;
    if (!change()) return false;
    if (world.forces.is_clear(world.state.rods, w)) return true;
    put_back_wire(world, w);
    world.output.results[w].nodal_contact = world.work.nodal_backup;
    return false;
}

}  // namespace

void renumber_forces(std::vector<Vec3>& force, int n, const NodeChange& change)
{
    const auto at = force.begin() + change.at;
    if (change.split) {
        std::copy_backward(at + 1, force.begin() + n, force.begin() + n + 1);
        *(at + 1) = Vec3::Zero();
    } else {
        *(at - 1) += 0.5 * *at;
        *(at + 1) += 0.5 * *at;
        std::copy(at + 1, force.begin() + n, at);
    }
}

void fade_surplus_of(WorldData& world, int w, double dt)
{
    const WireSpec& spec = world.setup.wires[w].wire;
    const double added = fade_surplus(world.feed(w), dt);
    if (added != 0) shorten_evenly(world.rod(w), spec, -added, spec.place.rest_is_placed);
}

bool adapt_wire(WorldData& world, int w, double dt, bool may_merge)
{
    if (MergedGroup* group = world.groups.of(w)) return adapt_group(world, *group, dt, may_merge);
    const WireSpec& spec = world.setup.wires[w].wire;
    const bool fed = world.feed(w).on;
    NodeAdapter& adapter = world.adapter(w);
    if (!fed) fade_surplus_of(world, w, dt);
    NodeDemands demands;
    demands.kept = adapter.kept;
    demands.fed = fed;
    demands.may_merge = may_merge;
    for (const RodClamp& clamp : world.constraints(w).clamps)
        if (clamp.direction && clamp.node == world.state.rods.node_count(w) - 1) demands.hub_tangent = clamp.tangent;
    // the moments beside a new node settle within the next step; until then only lengths are judged
    bool changed = fed && where_clear(world, w, [&] {
                       const double whole = adapter.planner.base_edge(world.rod(w), spec, demands);
                       return adapt_base(world, w, base_limits(world, w, whole, dt));
                   });
    if (changed) demands.may_refine = demands.may_merge = false;
    if (world.forces.elastic_wall) {  // between two nodes its displacement is linear (contact/wall_stations.h)
        demands.contact = std::span(world.output.results[w].nodal_contact).first(static_cast<std::size_t>(world.state.rods.node_count(w)));
        demands.touching_edge = std::max(spec.min_edge, world.forces.elastic_wall->edge_touched());
        if (may_merge && !changed) {
            world.forces.yielding->note_bowed(world.state.rods, w, world.work.bowed);
            demands.bowed = world.work.bowed;
        }
    }
    const auto changes = adapter.planner.plan(world.rod(w), spec, demands, world.state.rods.capacity(w));
    if (changes.empty()) return changed;
    if (!world.forces.terms.traits().never_overlaps) return change_nodes(world, w, changes), true;
    for (std::size_t k = 0; k < changes.size(); ++k)
        changed = where_clear(world, w, [&] { return change_nodes(world, w, changes.subspan(k, 1)), true; }) || changed;
    return changed;
}

void adapt_nodes_of(WorldData& world, int w, double dt)
{
    FeedState& feed = world.feed(w);
    if (feed.on && !feed.inside) return;
    if (world.groups.is_passenger(w)) return;
    if (world.adapter(w).on || world.groups.of(w)) (void)adapt_wire(world, w, dt, world.state.steps % merge_period == 0);
    else if (feed.on) (void)where_clear(world, w, [&] { return adapt_base(world, w, base_limits(world, w, feed.edge, dt)); });
}

void adapt_nodes(WorldData& world, double dt)
{
    const auto start = Clock::now();
    for (int w = 0; w < world.wire_count(); ++w)
        if (!world.systems.is_retired(w)) adapt_nodes_of(world, w, dt);
    world.work.adapt_time += seconds_since(start);
}

}  // namespace seldinger
