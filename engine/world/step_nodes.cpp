// The adapt stage: splits and merges edges between steps, and births at the inlet of a fed wire.

#include "core/clock.h"
#include "world/merged.h"
#include "world/step_stages.h"
#include "world/world.h"

#include <cmath>

namespace seldinger {

namespace {

// Nodes come at once and go slowly: a wire that shivers is not to lose and get the same node over and over.
constexpr int merge_period = 16;  // steps

// @return whether it did anything
bool adapt_base(World::Impl& state, int w, const BaseEdge& limits)
{
    const int n = state.rods.node_count(w);
    const HubChange change = adapt_hub(state.feeds[w], state.setup.wires[w].wire, state.rods, w, limits, state.hub_scratch);
    if (!change.changed) return false;
    state.remesh_energy[w] += change.energy;
    renumber_forces(state.results[w].nodal_contact, n, {state.rods.node_count(w) > n, n - 2, 0});
    return true;
}

// When a fed wire's base edge changes: a node is born when `whole` is inside, and goes when it is pulled back to the inlet.
BaseEdge base_limits(const World::Impl& state, int w, double whole, double dt)
{
    const HubPath hub = state.hub_requests[w].path();
    const double t = state.wire_time[w], next = std::isfinite(dt) ? t + dt : t;
    // symplectic Euler follows no axial wave along an edge that is much shorter than the others, and one linearised step no turn of it
    const Scheme scheme = state.setup.integrator.scheme;
    if (scheme == Scheme::Explicit || scheme == Scheme::Linearised) return {whole, 0.5 * whole, 0.5 * whole};
    return base_edge_limits(whole, hub.travel(t, next, +1), hub.travel(t, next, -1));
}

void change_nodes(World::Impl& state, int w, std::span<const NodeChange> changes)
{
    const WireSpec& spec = state.setup.wires[w].wire;
    NodeAdapter& adapter = state.adapters[w];
    constrain_now(state, w);
    const double before = energy_now(state.rods.view(w), state.constraints[w].clamps, adapter.frames);
    const WireNodes nodes(state.rods, w, spec, state.constraints[w].clamps, spec.place.rest_is_placed && !state.feeds[w].on);
    state.feeds[w].surplus += apply_changes(nodes, changes);
    constrain_now(state, w);
    int n = state.rods.node_count(w) - static_cast<int>(changes.size()) * (changes.front().split ? 1 : -1);
    for (const NodeChange& change : changes) renumber_forces(state.results[w].nodal_contact, change.split ? n++ : n--, change);
    state.remesh_energy[w] += energy_now(state.rods.view(w), state.constraints[w].clamps, adapter.frames) - before;
}

// A law that never overlaps takes no change of nodes that would put the wire into the wall: it waits until the wire has moved on.
// @param change  returns whether it did anything     @return whether something was done, and stands
template <class Change>
bool where_clear(World::Impl& state, int w, Change change)
{
    if (!state.terms.traits().never_overlaps) return change();
    state.keep_wire(w);
    state.nodal_backup = state.results[w].nodal_contact;
    if (!change()) return false;
    if (state.is_clear(w)) return true;
    state.put_back_wire(w);
    state.results[w].nodal_contact = state.nodal_backup;
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

void fade_surplus_of(World::Impl& state, int w, double dt)
{
    const WireSpec& spec = state.setup.wires[w].wire;
    const double added = fade_surplus(state.feeds[w], dt);
    if (added != 0) shorten_evenly(state.rods.view(w), spec, -added, spec.place.rest_is_placed);
}

bool adapt_wire(World::Impl& state, int w, double dt, bool may_merge)
{
    if (MergedGroup* group = state.group_of(w)) return adapt_group(state, *group, dt, may_merge);
    const WireSpec& spec = state.setup.wires[w].wire;
    const bool fed = state.feeds[w].on;
    NodeAdapter& adapter = state.adapters[w];
    if (!fed) fade_surplus_of(state, w, dt);
    NodeDemands demands;
    demands.kept = adapter.kept;
    demands.fed = fed;
    demands.may_merge = may_merge;
    for (const RodClamp& clamp : state.constraints[w].clamps)
        if (clamp.direction && clamp.node == state.rods.node_count(w) - 1) demands.hub_tangent = clamp.tangent;
    // the moments beside a new node settle within the next step; until then only lengths are judged
    bool changed = fed && where_clear(state, w, [&] {
                       const double whole = adapter.planner.base_edge(state.rods.view(w), spec, demands);
                       return adapt_base(state, w, base_limits(state, w, whole, dt));
                   });
    if (changed) demands.may_refine = demands.may_merge = false;
    if (state.elastic_wall) {  // between two nodes its displacement is linear (contact/wall_stations.h)
        demands.contact = std::span(state.results[w].nodal_contact).first(static_cast<std::size_t>(state.rods.node_count(w)));
        demands.touching_edge = std::max(spec.min_edge, state.elastic_wall->edge_touched());
        if (may_merge && !changed) {
            state.yielding->note_bowed(state.rods, w, state.bowed);
            demands.bowed = state.bowed;
        }
    }
    const auto changes = adapter.planner.plan(state.rods.view(w), spec, demands, state.rods.capacity(w));
    if (changes.empty()) return changed;
    if (!state.terms.traits().never_overlaps) return change_nodes(state, w, changes), true;
    for (std::size_t k = 0; k < changes.size(); ++k)
        changed = where_clear(state, w, [&] { return change_nodes(state, w, changes.subspan(k, 1)), true; }) || changed;
    return changed;
}

void adapt_nodes_of(World::Impl& state, int w, double dt)
{
    FeedState& feed = state.feeds[w];
    if (feed.on && !feed.inside) return;
    if (state.is_passenger(w)) return;
    if (state.adapters[w].on || state.group_of(w)) (void)adapt_wire(state, w, dt, state.steps % merge_period == 0);
    else if (feed.on) (void)where_clear(state, w, [&] { return adapt_base(state, w, base_limits(state, w, feed.edge, dt)); });
}

void adapt_nodes(World::Impl& state, double dt)
{
    const auto start = Clock::now();
    for (int w = 0; w < state.wire_count(); ++w)
        if (!state.retired[w]) adapt_nodes_of(state, w, dt);
    state.adapt_time += seconds_since(start);
}

}  // namespace seldinger
