// Nodes of a common centreline: births at the hub, and where all of its instruments ask for adaptive nodes, anywhere along it.

#include "contact/yielding_wall.h"
#include "rod/coaxial_nodes.h"
#include "wall/elastic_wall.h"
#include "world/merged.h"
#include "world/node_errors.h"
#include "world/step_stages.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace seldinger {

WireSpec merged_nodes(const WorldSetup& setup, const CoaxialSpec& spec)
{
    WireSpec line;
    line.nodes = 0;
    line.length = 0;
    line.min_edge = line.max_edge = line.edge_error = INFINITY;
    for (const int w : spec.order) {
        const WireSpec& wire = setup.wires[w].wire;
        if (!nodes_adapt(setup.wires[w])) line.nodes = 1;
        line.length = std::max(line.length, wire.length);
        line.min_edge = std::min(line.min_edge, wire.min_edge);
        line.max_edge = std::min(line.max_edge, wire.max_edge);
        line.edge_error = std::min(line.edge_error, wire.edge_error);
    }
    return line;
}

namespace {

/// Carries a change of the nodes out. @param change  carries `what` out, of the nodes that it is called with
template <class Change>
void change_nodes(WorldData& world, MergedGroup& group, const NodeChange& what, Change change)
{
    const int line = group.line(), n = world.state.rods.node_count(line);
    refresh_group(world, group);
    const double before = elastic_now(world.state.rods, group);
    change(CoaxialNodes(world.state.rods, group.wires(), group.shared.rod, group.shared.base));
    refresh_group(world, group);
    world.state.wires[line].remesh_energy += elastic_now(world.state.rods, group) - before;
    for (const int w : group.wires()) renumber_forces(world.output.results[w].nodal_contact, n, what);
}

/// As where_clear() of step_nodes.cpp, for a group. @return whether the change stands
template <class Change>
bool where_clear(WorldData& world, MergedGroup& group, Change change)
{
    if (!world.forces.terms.traits().never_overlaps) return change(), true;
    std::vector<std::vector<Vec3>> forces;
    for (const int w : group.wires()) {
        keep_wire(world, w);
        forces.push_back(world.output.results[w].nodal_contact);
    }
    change();
    set_exposures(world);
    if (std::ranges::all_of(group.wires(), [&](int w) { return world.forces.is_clear(world.state.rods, w); })) return true;
    for (std::size_t k = 0; k < forces.size(); ++k) {
        put_back_wire(world, group.wires()[k]);
        world.output.results[group.wires()[k]].nodal_contact = forces[k];
    }
    refresh_group(world, group);
    return false;
}

/// A birth or a merge at the hub, where the base edge has left its limits for edges that become `whole` [m].
bool adapt_base(WorldData& world, MergedGroup& group, double whole, double dt)
{
    const int leader = group.wires()[group.leader], line = group.line();
    const HubPath hub = world.work.wires[leader].hub.path();
    const double t = world.state.wires[leader].time, next = std::isfinite(dt) ? t + dt : t;
    const BaseEdge limits = base_edge_limits(whole, hub.travel(t, next, +1), hub.travel(t, next, -1));
    const RodView rod = world.rod(line);
    const BaseChange change = base_change(rod, limits, world.state.rods.capacity(line));
    if (change == BaseChange::None) return false;
    return where_clear(world, group, [&] {
        change_nodes(world, group, {change == BaseChange::Split, rod.n - 2, 0}, [&](const RodNodes& nodes) {
            change_base(group.feed, nodes, change, limits, world.work.hub_scratch.split);
        });
    });
}

/// Even nodes: births at the hub, and at the tip where another instrument has got ahead time after time.
bool adapt_ends(WorldData& world, MergedGroup& group, double dt)
{
    const int line = group.line();
    bool changed = false;
    if (world.rod(line).rest_length[0] > 1.75 * group.feed.edge &&
        world.state.rods.node_count(line) < world.state.rods.capacity(line))
        changed = where_clear(world, group, [&] {
            change_nodes(world, group, {true, 0, 0.5},
                         [&](const RodNodes& nodes) { group.feed.surplus += split_edge(nodes, 0, 0.5).rest_length_added; });
        });
    return adapt_base(world, group, group.feed.edge, dt) || changed;
}

/// Moments and torques of the accepted state.
void measure(WorldData& world, MergedGroup& group, NodeDemands& demands)
{
    refresh_group(world, group);
    const RodView line = world.rod(group.line());
    const CoaxialTrial now = accepted_trial(world.state.rods, group.wires());
    const auto n = static_cast<std::size_t>(line.n);
    const std::span<Vec3> moment = std::span(group.moment).first(n);
    const std::span<double> turning = std::span(group.turning).first(n);
    if (update_coaxial(group.shared.rod, line, now, group.shared.base, group.frames)) {
        measure_coaxial(group.shared.rod, line, now, group.shared.base, group.frames, moment, turning);
    } else {
        std::ranges::fill(moment, Vec3::Zero());
        std::ranges::fill(turning, 0.0);
    }
    demands.moment = moment;
    demands.turning = turning;
}

/// Contact of all its instruments on the line's nodes.
void sum_contact(WorldData& world, MergedGroup& group, NodeDemands& demands)
{
    const auto n = static_cast<std::size_t>(world.state.rods.node_count(group.line()));
    group.contact.assign(n, Vec3::Zero());
    for (const int w : group.wires()) {
        const std::vector<Vec3>& force = world.output.results[w].nodal_contact;
        for (std::size_t i = 0; i < n; ++i)
            group.contact[i] += force[i];
    }
    demands.contact = group.contact;
}

/// Where any of the instruments touches an elastic wall, and the wall below.
void note_yielding(WorldData& world, MergedGroup& group, bool may_merge, NodeDemands& demands)
{
    const auto n = static_cast<std::size_t>(world.state.rods.node_count(group.line()));
    demands.touching_edge = std::max(group.nodes.min_edge, world.forces.elastic_wall->edge_touched());
    sum_contact(world, group, demands);
    group.bowed.assign(n, 0);
    for (const int w : group.wires()) {
        if (!may_merge) continue;
        world.forces.yielding->note_bowed(world.state.rods, w, world.work.bowed);
        for (std::size_t i = 0; i < n; ++i) group.bowed[i] |= world.work.bowed[i];
    }
    demands.bowed = group.bowed;
}

/// Adaptive nodes; as adapt_wire() of step_nodes.cpp.
bool adapt_line(WorldData& world, MergedGroup& group, double dt, bool may_merge)
{
    NodePlanner& planner = world.adapter(group.line()).planner;
    NodeDemands demands;
    demands.fed = true;
    demands.may_merge = may_merge;
    demands.hub_tangent = group.shared.base.tangent;
    measure(world, group, demands);
    const auto line = [&] { return world.rod(group.line()); };
    bool changed = adapt_base(world, group, planner.base_edge(line(), group.nodes, demands), dt);
    if (changed) {  // the moments beside a new node settle within the next step; until then only lengths are judged
        demands.may_refine = demands.may_merge = false;
        measure(world, group, demands);
    }
    if (world.forces.elastic_wall) note_yielding(world, group, demands.may_merge, demands);
    for (const NodeChange& change : planner.plan(line(), group.nodes, demands, world.state.rods.capacity(group.line()))) {
        const auto carry_out = [&] {
            change_nodes(world, group, change,
                         [&](const RodNodes& nodes) { group.feed.surplus += apply_changes(nodes, {&change, 1}); });
        };
        changed = where_clear(world, group, carry_out) || changed;
    }
    return changed;
}

}  // namespace

NodeDemands group_demands(WorldData& world, MergedGroup& group)
{
    NodeDemands demands;
    demands.hub_tangent = group.shared.base.tangent;
    measure(world, group, demands);
    sum_contact(world, group, demands);
    return demands;
}

namespace {

/// Jumps where a piece ends and instrument k with it, or its section: of the compliance of all together, and of their natural curvature.
std::pair<double, double> jumps_between(const CoaxialPiece& a, const CoaxialPiece& b, int k, int count)
{
    const auto stiffness_of = [&](const CoaxialPiece& piece) {
        double sum = 0;
        for (int j = 0; j < count; ++j) sum += piece.section[j] ? piece.section[j]->bend_stiffness : 0.0;
        return sum;
    };
    const double of_a = stiffness_of(a), of_b = stiffness_of(b);
    if (a.section[k] == b.section[k] || !(of_a > 0 && of_b > 0)) return {0, 0};
    const auto natural = [](const WireSection* section, double all) {
        return section ? Vec2(section->bend_stiffness / all * section->rest_curvature) : Vec2(Vec2::Zero());
    };
    double turn = 0;
    for (int j = 0; j < count; ++j) turn += (natural(a.section[j], of_a) - natural(b.section[j], of_b)).norm();
    return {std::abs(1 / of_a - 1 / of_b), turn};
}

/// hand_error() of instrument k, as if it did not lead.
double boundary_error(const MergedGroup& group, const RodView& line, std::span<const Vec3> moment, int k)
{
    const auto& pieces = group.shared.rod.pieces;
    const int hub = line.n - 1;
    double sum = 0;
    for (std::size_t p = 0; p + 1 < pieces.size(); ++p) {
        const auto [compliance, turn] = jumps_between(pieces[p], pieces[p + 1], k, group.shared.count());
        int i = 0;  // the cell that it is in
        while (i < hub && pieces[p].end >= 0.5 * (line.material_s[i] + line.material_s[i + 1])) ++i;
        double step = 0;
        if (i > 0) step = std::max(step, (moment[i] - moment[i - 1]).norm());
        if (i < hub) step = std::max(step, (moment[i + 1] - moment[i]).norm());
        sum += compliance * (moment[i].norm() * step + step * step / 4) / 2 + turn * step / 2;
    }
    return sum;
}

}  // namespace

double hand_error(const World& given, int wire)
{
    WorldData& world = data_of(const_cast<World&>(given));  // scratch of the group is made anew; the state is only read
    MergedGroup* group = world.groups.of(wire);
    if (!group || !group->feed.inside) return 0;
    const NodeDemands demands = group_demands(world, *group);
    const RodView line = world.rod(group->line());
    const auto wires = group->wires();
    double sum = 0;
    for (int k = 0; k < group->shared.count(); ++k)
        if (k != group->leader && (wires[k] == wire || wires[group->leader] == wire)) sum += boundary_error(*group, line, demands.moment, k);
    return sum;
}

bool adapt_group(WorldData& world, MergedGroup& group, double dt, bool may_merge)
{
    if (!group.feed.inside) return false;
    return group.adapts() ? adapt_line(world, group, dt, may_merge) : adapt_ends(world, group, dt);
}

}  // namespace seldinger
