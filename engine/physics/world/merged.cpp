// Instruments that share one centreline: placed, fed, held.
#include "world/world_rod.h"

#include "contact/contact_system.h"
#include "contact/rods/coaxial_friction.h"
#include "nodes/coaxial_nodes.h"
#include "rod/place.h"
#include "solve/line_holds.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Edge of the line of a group.
double merged_edge(const WorldSetup& setup, const CoaxialSpec& spec)
{
    double edge = INFINITY;
    for (const int w : spec.order) edge = std::min(edge, uniform_edge(setup.wires[w].wire));
    return edge;
}

/// Bounds of the line's edges where they are adaptive, `nodes` = 0: all instruments ask for that.
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

/// Most nodes of the line of a group.
int merged_capacity(const WorldSetup& setup, const CoaxialSpec& spec)
{
    const WireSpec nodes = merged_nodes(setup, spec);
    const double shortest = nodes.nodes == 0 ? nodes.min_edge : merged_edge(setup, spec);
    return static_cast<int>(std::ceil(1.01 * nodes.length / shortest)) + 6;
}

const WireSpec& spec_of(const WorldSetup& setup, const MergedGroup& group, int k)
{
    return setup.wires[group.wires()[k]].wire;
}

int ahead_of_all(const WorldState& state, const MergedGroup& group)
{
    int first = group.leader;
    for (int k = 0; k < group.shared.count(); ++k)
        if (state.feed(group.wires()[k]).advance > state.feed(group.wires()[first]).advance) first = k;
    return first;
}

/// The leader's tip is where the line's is; the others have been fed as far as they are beyond the hub.
double offset_of(WorldData& world, const MergedGroup& group, int k)
{
    const double advance = world.feed(group.wires()[k]).advance;
    if (!group.feed.inside || k == group.leader) return advance - group.feed.advance;
    const RodView line = world.rod(group.line());
    return advance - line.material_s[line.n - 1];
}

void set_offsets(WorldData& world, MergedGroup& group)
{
    for (int k = 0; k < group.shared.count(); ++k)
        group.shared.rod.instrument[k] = {&spec_of(world.setup, group, k), offset_of(world, group, k)};
}

/// Angles at the clamps, or of the hands that hold the lengths behind them.
void set_angles(WorldData& world, MergedGroup& group)
{
    for (int k = 0; k < group.shared.count(); ++k) {
        const int w = group.wires()[k];
        const FeedSpec& from = world.setup.wires[w].feed;
        group.shared.clamp[k] = group.shared.base.hand[k] = -world.feed(w).turn;
        const double behind = from.behind > 0 ? from.behind - (world.feed(w).advance - from.advance) : 0.0;
        group.shared.base.behind[k] = std::max(behind, 0.0) / spec_of(world.setup, group, k).shaft.twist_stiffness;
    }
}

void set_inside(WorldState& state, const MergedGroup& group)
{
    for (const int w : group.wires()) state.feed(w).inside = group.feed.inside;
}

/// Passengers as long as the line; angles of all as the hubs are turned. @param rate  of each [rad/s]
void level(WorldData& world, MergedGroup& group, std::span<const double> angle, std::span<const double> rate)
{
    for (std::size_t k = 0; k < group.wires().size(); ++k) {
        world.state.rods.set_node_count(group.wires()[k], world.state.rods.node_count(group.line()));
        world.state.rods.set_curvature(group.wires()[k], spec_of(world.setup, group, 0).curvature);
        const RodView own = world.rod(group.wires()[k]);
        std::ranges::fill(own.theta, angle[k]);
        std::ranges::fill(own.spin_rate, rate[k]);
        std::ranges::fill(own.spin_acc, 0.0);
    }
    follow_line(world.state.rods, group.wires());
}

/// Angles of an instrument that is still outside follow its hub.
void level_absent(RodArrays& rods, MergedGroup& group)
{
    const RodView line = rods.view(group.line());
    const int hub = line.n - 1;
    for (int k = 0; k < group.shared.count(); ++k) {
        if (!coaxial_idle(group.shared.rod, hub, k) || !coaxial_idle(group.shared.rod, hub - 1, k)) continue;
        const RodView own = rods.view(group.wires()[k]);
        own.theta[hub] = group.shared.clamp[k];
        own.theta[hub - 1] = own.theta[hub] + line.clamp_twist_a[hub];
        for (int j = hub - 2; j >= 0; --j) own.theta[j] = own.theta[j + 1] + line.ref_twist[j + 1];
        std::ranges::fill(own.spin_rate, 0.0);
    }
}

}  // namespace

double elastic_now(RodArrays& rods, MergedGroup& group)
{
    const RodView line = rods.view(group.line());
    const CoaxialTrial now = accepted_trial(rods, group.wires());
    RodFrames& frames = group.frames;
    const bool usable = update_coaxial(group.shared.rod, line, now, group.shared.base, frames);
    const double energy = usable ? coaxial_energy({group.shared.rod, line, now, group.shared.base, frames}) : 0.0;
    return energy;
}

namespace {

/// Slides the line's nodes along it by so much faster [m/s]: on the bisector of both edges at a node, where none is stretched.
/// The hub stands, but has the velocity of the material that enters there.
void slide_faster(const RodView& line, double speed, const Vec3& inwards)
{
    line.set_vel(line.n - 1, line.vel(line.n - 1) + speed * inwards);
    for (int i = 0; i < line.n - 1; ++i) {
        const Vec3 after = -line.tangent(i), before = i > 0 ? Vec3(-line.tangent(i - 1)) : after;
        line.set_vel(i, line.vel(i) + speed / (1 + before.dot(after)) * (before + after));
    }
}

/// How fast a hub goes in the sub-step of h that is to come [m/s].
double hub_speed(const WorldData& world, int wire, double h)
{
    const HubPath path = world.work.wires[wire].hub.path();
    const double now = world.state.wires[wire].time;
    return (path.at(now + h).advance - path.at(now).advance) / h;
}

/// Another instrument has got ahead: the line continues straight to its tip, and counts from there. The stretch is that
/// instrument's material now and has its speed. At the speed of the old leader, a push of the hands would stop all of it within
/// the sub-step of h.
void change_leader(WorldData& world, MergedGroup& group, int leader, double h)
{
    const int next = group.wires()[leader], last = group.wires()[group.leader];
    if (world.setup.integrator.scheme != Scheme::Static)
        slide_faster(world.rod(group.line()), hub_speed(world, next, h) - hub_speed(world, last, h), group.feed.direction);
    const RodView line = world.rod(group.line());
    const double before = elastic_now(world.state.rods, group);
    const double longer = world.feed(next).advance - line.material_s[line.n - 1];
    const Vec3 forwards = (line.pos(0) - line.pos(1)).normalized();
    line.set_pos(0, line.pos(0) + longer * forwards);
    for (int i = 1; i < line.n; ++i) line.material_s[i] += longer;
    group.leader = leader;
    group.feed.advance = world.feed(next).advance;
    group.feed.surplus = group.feed.surplus_rate = 0;
    set_offsets(world, group);
    prepare_group(world.state.rods, group.wires(), group.shared.rod);
    follow_line(world.state.rods, group.wires());
    world.state.wires[group.line()].remesh_energy += elastic_now(world.state.rods, group) - before;
}

/// Into the introducer, with as much inside as the feeds say.
void place_group(WorldData& world, MergedGroup& group)
{
    const WorldSetup& setup = world.setup;
    const int line = group.line(), count = group.shared.count(), capacity = world.state.rods.capacity(line);
    group.shared.rod = CoaxialRod(capacity, count);
    group.frames = coaxial_frames(capacity);
    group.moment.resize(capacity);
    group.turning.resize(capacity);
    std::array<double, most_coaxial> angle{}, still{};
    for (int k = 0; k < count; ++k) {
        const FeedSpec& from = setup.wires[group.wires()[k]].feed;
        FeedState& feed = world.feed(group.wires()[k]);
        feed.on = 1;
        feed.advance = from.advance;
        feed.turn = from.turn;
        feed.edge = group.feed.edge;
        angle[k] = -from.turn;
    }
    group.leader = ahead_of_all(world.state, group);
    FeedSpec spec = setup.wires[line].feed;
    spec.advance = world.feed(group.wires()[group.leader]).advance;
    spec.turn = 0;
    start_feed(group.feed, spec, spec_of(world.setup, group, group.leader), world.state.rods, line);
    for (const int w : group.wires()) {
        world.feed(w).point = group.feed.point;
        world.feed(w).direction = group.feed.direction;
        world.feed(w).director = group.feed.director;
    }
    group.shared.base.tangent = -group.feed.direction;
    group.shared.base.director = group.feed.director;
    level(world, group, angle, still);
    set_inside(world.state, group);
    refresh_group(world, group);
}

}  // namespace

void refresh_group(WorldData& world, MergedGroup& group)
{
    set_offsets(world, group);
    set_angles(world, group);
    prepare_group(world.state.rods, group.wires(), group.shared.rod);
}

void feed_group(WorldData& world, MergedGroup& group, double step, double h)
{
    std::array<double, most_coaxial> angle{}, rate{}, offset{};
    const int count = group.shared.count();
    for (int k = 0; k < count; ++k) {
        const int w = group.wires()[k];
        FeedState& feed = world.feed(w);
        const FeedKey end = world.work.wires[w].hub.path().at(world.state.wires[w].time + step);
        angle[k] = -feed.turn;
        group.turned[k] = feed.turn - end.turn;
        rate[k] = group.turned[k] / h;
        offset[k] = offset_of(world, group, k);
        feed.speed = (end.advance - feed.advance) / h;
        feed.grown = end.advance - feed.advance;
        feed.advance = end.advance;
        feed.turn = end.turn;
    }
    const int leader = group.wires()[group.leader];
    const bool was_inside = group.feed.inside;
    feed_to(group.feed, {0, world.feed(leader).advance, 0}, spec_of(world.setup, group, group.leader), world.state.rods,
            group.line(), h);
    if (!was_inside || !group.feed.inside) level(world, group, angle, rate);
    set_inside(world.state, group);
    set_offsets(world, group);
    set_angles(world, group);
    for (int k = 0; k < count; ++k) {
        group.slid[k] = group.shared.rod.instrument[k].offset - offset[k];
        group.shared.fed[k] = world.feed(group.wires()[k]).grown;
    }
    prepare_group(world.state.rods, group.wires(), group.shared.rod);
    level_absent(world.state.rods, group);
}

double lead_change_after(const WorldData& world, const MergedGroup& group, double dt)
{
    if (!group.feed.inside) return 0;
    constexpr double least_share = 0.01;          // of the step; what is gained in so much of it may be continued straight
    constexpr int halvings = 30;                  // to 1e-9 of the step
    const double least = 1e-6 * group.feed.edge;  // beyond rounding, so that the cut finds another one ahead [m]
    const auto ahead = [&](double after) {
        double others = -INFINITY, leader = 0;
        for (int k = 0; k < group.shared.count(); ++k) {
            const int w = group.wires()[k];
            const double advance = world.work.wires[w].hub.path().at(world.state.wires[w].time + after).advance;
            if (k == group.leader) leader = advance + std::max(group.feed.surplus, 0.0);
            else others = std::max(others, advance);
        }
        return others > leader + least;
    };
    if (ahead(0) || !ahead(dt)) return 0;
    double before = 0, after = dt;
    for (int k = 0; k < halvings; ++k) {
        const double middle = 0.5 * (before + after);
        (ahead(middle) ? after : before) = middle;
    }
    return after > (1 - least_share) * dt ? 0 : std::max(after, least_share * dt);
}

void lead_group(WorldData& world, MergedGroup& group, double h)
{
    if (!group.feed.inside) {  // a rigid piece in the introducer: its tip is the leader's
        group.leader = ahead_of_all(world.state, group);
        group.feed.advance = world.feed(group.wires()[group.leader]).advance;
        return;
    }
    const int leader = ahead_of_all(world.state, group);
    const RodView line = world.rod(group.line());
    if (leader != group.leader && world.feed(group.wires()[leader]).advance > line.material_s[line.n - 1])
        change_leader(world, group, leader, h);
}

void stop_hands(WorldData& world)
{
    for (const auto& group : world.groups.list) group->shared.fed = {};
}

void set_exposures(WorldData& world)
{
    if (!world.forces.contact) return;
    for (const auto& group : world.groups.list) {
        double farthest = -INFINITY;  // of those around
        for (int k = 0; k < group->shared.count(); ++k) {
            const int w = group->wires()[k];
            const double advance = world.feed(w).advance, out = k == 0 ? INFINITY : advance - farthest;
            world.forces.contact->set_exposure(w, offset_of(world, *group, k), out > 0 ? out : -1.0);
            farthest = std::max(farthest, advance);
        }
    }
}

MergedGroups::MergedGroups() = default;
MergedGroups::~MergedGroups() = default;

void set_group_capacities(const WorldSetup& setup, std::span<int> capacities)
{
    for (const CoaxialSpec& spec : setup.coaxial)
        for (const int w : spec.order)
            if (spec.model == CoaxialSpec::Model::Merged) capacities[w] = merged_capacity(setup, spec);
}

void make_groups(WorldData& world)
{
    MergedGroups& groups = world.groups;
    groups.place.assign(world.setup.wires.size(), -1);
    groups.line.assign(world.setup.wires.size(), -1);
    for (const CoaxialSpec& spec : world.setup.coaxial) {
        if (spec.model != CoaxialSpec::Model::Merged) continue;
        MergedGroup& group = *groups.list.emplace_back(std::make_unique<MergedGroup>());
        group.spec = &spec;
        group.shared.wires = spec.order;
        group.feed.edge = merged_edge(world.setup, spec);
        group.nodes = merged_nodes(world.setup, spec);
        for (const int w : spec.order) {
            groups.place[w] = static_cast<int>(groups.list.size()) - 1;
            groups.line[w] = group.line();
        }
    }
}

void place_groups(WorldData& world)
{
    MergedGroups& groups = world.groups;
    for (const auto& group : groups.list) {
        NodeAdapter& adapter = world.adapter(group->line());
        adapter.on = group->adapts();
        if (adapter.on) adapter.planner = NodePlanner(group->nodes, world.state.rods.capacity(group->line()));
        place_group(world, *group);
    }
    if (groups.list.empty()) return;
    groups.shown = std::make_unique<RodArrays>(world.state.rods);
    groups.shown_from.assign(world.setup.wires.size(), 0);
}

namespace {

void make_group_friction(WorldData& world)
{
    WorldForces& forces = world.forces;
    for (const auto& group : world.groups.list) {
        const CoaxialSpec& spec = *group->spec;
        const double pressed = spec.lumen_friction ? 1 : 0;
        const CoaxialFrictionSpec friction{spec.drag, spec.viscous, pressed * spec.mu_static, pressed * spec.mu_sliding};
        if (!friction.any()) continue;
        if (!forces.coaxial_friction) forces.coaxial_friction = std::make_unique<CoaxialFriction>(world.state.rods);
        forces.coaxial_friction->add(group->shared, friction, group->adapts() ? group->nodes.min_edge : group->feed.edge);
    }
    if (forces.coaxial_friction) forces.terms.add(*forces.coaxial_friction);
}

void make_line_holds(WorldData& world)
{
    WorldForces& forces = world.forces;
    for (const auto& group : world.groups.list) {
        std::vector<int> held;
        for (const int w : group->wires()) held.push_back(static_cast<int>(world.setup.wires[w].holds.size()));
        if (std::ranges::all_of(held, [](int count) { return count == 0; })) continue;
        take_holds(world, *group);
        if (!forces.line_holds) forces.line_holds = std::make_unique<LineHolds>(world.state.rods, world.work.constraints);
        forces.line_holds->add(group->shared, held);
    }
    if (forces.line_holds) forces.terms.add(*forces.line_holds);
}

}  // namespace

void join_groups(WorldData& world)
{
    for (const auto& group : world.groups.list) world.solver->join(group->shared);
    make_group_friction(world);
    make_line_holds(world);
}

}  // namespace seldinger
