// The adapt stage: splits and merges edges of rods between steps, and births at the inlet of a fed rod.
#include "contact/wall_contact.h"
#include "core/clock.h"
#include "stages/step_stages.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// Nodes come at once and go slowly: a wire that shivers is not to lose and get the same node over and over.
constexpr int merge_period = 16;  // steps

/// Readings of the nodes follow them, sums kept, until the next step reads them anew. @param n  nodes before
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

/// Carries a change of the nodes out. @param change  calls for the nodes what `what` says
template <class Change>
void change_nodes(const WorldRod& rod, std::span<const NodeChange> what, Change change)
{
    WorldData& world = rod.world();
    double& energy = world.state.wires[rod.line()].remesh_energy;
    const int before = rod.view().n;
    rod.refresh();
    const double elastic = rod.elastic_energy();
    rod.with_nodes(change);
    rod.refresh();
    energy += rod.elastic_energy() - elastic;
    for (const int w : rod.wires()) {
        int n = before;
        for (const NodeChange& one : what) renumber_forces(world.output.results[w].nodal_contact, one.split ? n++ : n--, one);
    }
}

// A law that never overlaps takes no change of nodes that would put the rod into the wall: it waits until the rod has moved on.
// @return whether the change stands
template <class Change>
bool where_clear(const WorldRod& rod, Change change)
{
    WorldData& world = rod.world();
    if (!world.forces.terms.traits().never_overlaps) return change(), true;
    for (const int w : rod.wires()) {
        keep_wire(world, w);
        world.work.wires[w].nodal_backup = world.output.results[w].nodal_contact;
    }
    change();
    set_exposures(world);
    if (std::ranges::all_of(rod.wires(), [&](int w) { return world.forces.wall_contact->is_clear(world.state.rods, w); }))
        return true;
    for (const int w : rod.wires()) {
        put_back_wire(world, w);
        world.output.results[w].nodal_contact = world.work.wires[w].nodal_backup;
    }
    rod.refresh();
    return false;
}

// When a fed rod's base edge changes: a node is born when `whole` is inside, and goes when it is pulled back to the inlet.
BaseEdge base_limits(const WorldRod& rod, double whole, double dt)
{
    const double t = rod.world().state.wires[rod.line()].time, next = std::isfinite(dt) ? t + dt : t;
    // symplectic Euler follows no axial wave along an edge that is much shorter than the others, and one linearised step no turn
    // of it
    const Scheme scheme = rod.world().setup.integrator.scheme;
    if (scheme == Scheme::Explicit || scheme == Scheme::Linearised) return {whole, 0.5 * whole, 0.5 * whole};
    return base_edge_limits(whole, rod.hub().travel(t, next, +1), rod.hub().travel(t, next, -1));
}

/// A birth or a merge at the hub, where the base edge has left its limits for edges that become `whole` [m].
bool adapt_base(const WorldRod& rod, double whole, double dt)
{
    const BaseEdge limits = base_limits(rod, whole, dt);
    const RodView line = rod.view();
    const BaseChange change = base_change(line, limits, rod.world().state.rods.capacity(rod.line()));
    if (change == BaseChange::None) return false;
    const NodeChange what{change == BaseChange::Split, line.n - 2, 0};
    return where_clear(rod, [&] {
        change_nodes(rod, {&what, 1}, [&](const RodNodes& nodes) {
            change_base(rod.feed(), nodes, change, limits, rod.world().work.split);
        });
    });
}

void apply(const WorldRod& rod, std::span<const NodeChange> changes)
{
    change_nodes(rod, changes, [&](const RodNodes& nodes) { rod.feed().surplus += apply_changes(nodes, changes); });
}

/// Even nodes: births at the hub, and at the tip where another instrument has got ahead time after time.
bool adapt_ends(const WorldRod& rod, double dt)
{
    const RodView line = rod.view();
    const double edge = rod.feed().edge;
    const bool long_tip = line.n > 2 && line.rest_length[0] > 1.75 * edge && line.n < rod.world().state.rods.capacity(rod.line());
    const NodeChange halves{true, 0, 0.5};
    const bool changed = long_tip && where_clear(rod, [&] { apply(rod, {&halves, 1}); });
    const RodView now = rod.view();
    return adapt_base(rod, even_edge(rod.bounds(), now.material_s[now.n - 2], edge), dt) || changed;
}

/// Between two nodes the displacement of a wall is taken to be linear (coupling/wall_stations.h).
void note_wall(const WorldRod& rod, NodeDemands& demands)
{
    WorldData& world = rod.world();
    const WallContact* wall = world.forces.wall_contact;
    if (!wall || !std::isfinite(wall->edge_touched())) return;
    demands.contact = rod.contact();
    demands.touching_edge = std::max(rod.bounds().min_edge, wall->edge_touched());
    if (!demands.may_merge) return;
    world.work.bowed.assign(static_cast<std::size_t>(rod.view().n), 0);
    for (const int w : rod.wires()) wall->mark_bowed(world.state.rods, w, world.work.bowed);
    demands.bowed = world.work.bowed;
}

}  // namespace

void fade_surplus_of(WorldData& world, int w, double dt)
{
    const WireSpec& spec = world.setup.wires[w].wire;
    const double added = fade_surplus(world.feed(w), dt);
    if (added != 0) shorten_evenly(world.rod(w), spec, -added, spec.place.rest_is_placed);
}

bool adapt_rod(const WorldRod& rod, double dt, bool may_merge)
{
    WorldData& world = rod.world();
    NodePlanner& planner = world.adapter(rod.line()).planner;
    const int capacity = world.state.rods.capacity(rod.line());
    const bool fed = rod.feed().on;
    if (!fed) fade_surplus_of(world, rod.line(), dt);
    NodeDemands demands = rod.demands();
    const bool changed = fed && adapt_base(rod, planner.base_edge(rod.view(), rod.bounds(), demands), dt);
    if (changed) demands = rod.demands();
    demands.may_merge = may_merge && !changed;
    // the moments beside a new node settle within the next step; until then only lengths are judged
    demands.may_refine = !changed;
    note_wall(rod, demands);
    const std::span<const NodeChange> changes = planner.plan(rod.view(), rod.bounds(), demands, capacity);
    // each by itself where it may be refused, or moves offsets
    const std::size_t at_once = world.forces.terms.traits().never_overlaps || rod.wires().size() > 1 ? 1 : changes.size();
    bool stands = changed;
    for (std::size_t k = 0; k < changes.size(); k += at_once)
        stands = where_clear(rod, [&] { apply(rod, changes.subspan(k, at_once)); }) || stands;
    return stands;
}

void adapt_nodes_of(WorldData& world, int w, double dt)
{
    if (!world.is_line(w)) return;
    const FeedState& feed = world.feed(w);
    if (feed.on && !feed.inside) return;
    const WorldRod rod(world, w);
    if (rod.adapts()) (void)adapt_rod(rod, dt, world.state.steps % merge_period == 0);
    else if (feed.on) (void)adapt_ends(rod, dt);
}

void adapt_nodes(WorldData& world, double dt)
{
    const auto start = Clock::now();
    for (int w = 0; w < world.wire_count(); ++w)
        if (!world.systems.is_retired(w)) adapt_nodes_of(world, w, dt);
    world.work.adapt_time += seconds_since(start);
}

}  // namespace seldinger
