// Instruments that share one centreline: forces at their hands, how wrong nodes make these, and each instrument alone.
#include "contact/rods/coaxial_friction.h"
#include "contact/contact_system.h"
#include "world/node_errors.h"
#include "world/world_rod.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace seldinger {
namespace {

/// Force of the surroundings on an instrument along the line, + towards the tip: the wall's, that of loads and links [N].
double axial_contact(WorldData& world, const MergedGroup& group, int k)
{
    const double load = axial_load(world, group, k);
    return world.forces.contact ? world.forces.contact->along(group.wires()[k]) + load : load;
}

/// Friction of the others on an instrument, + towards the tip. In a group it adds up to nothing: the line does not feel it.
double axial_friction(const WorldForces& forces, int wire)
{
    return forces.coaxial_friction ? forces.coaxial_friction->along(wire) : 0;
}

double mass_rate(const WireSection* section)
{
    return section ? section->density * std::numbers::pi * section->radius * section->radius : 0.0;
}

/// A push removes part of the twisted length behind the inlet: d(twist energy there)/d(length) at the angle that the hand holds
/// [N].
double twist_behind(const WorldData& world, const MergedGroup& group, const CoaxialHands& hands, int k)
{
    const double torque = hands.torque[k];
    const double stiffness = world.setup.wires[group.wires()[k]].wire.shaft.twist_stiffness;
    return group.shared.base.behind[k] > 0 ? 0.5 * torque * torque / stiffness : 0.0;
}

/// Weight against a push of instrument k alone: each change of its section moves into the cell that it lies in.
double weight_of(WorldData& world, const MergedGroup& group, int k)
{
    const RodView line = world.rod(group.line());
    double force = 0;
    const auto& pieces = group.shared.rod.pieces;
    for (std::size_t p = 0; p + 1 < pieces.size(); ++p) {
        const double more = mass_rate(pieces[p + 1].section[k]) - mass_rate(pieces[p].section[k]);
        if (more == 0) continue;
        const double s = pieces[p].end;
        int i = 0;  // cell that it is in
        while (i < line.n - 1 && s >= 0.5 * (line.material_s[i] + line.material_s[i + 1])) ++i;
        force -= more * world.setup.gravity.dot(line.pos(i) - group.feed.point);
    }
    return force;
}

}  // namespace

void read_hands(const WorldRod& rod)
{
    WorldData& world = rod.world();
    const MergedGroup& group = *rod.group();
    const CoaxialHands hands = world.solver->coaxial_hands(group.line());
    const RodView line = world.rod(group.line());
    const int count = group.shared.count(), base = line.n - 2;
    const double stretched = (line.pos(base + 1) - line.pos(base)).norm() / line.rest_length[base];
    double of_leader = hands.push(group.leader, group.leader, count) + twist_behind(world, group, hands, group.leader) +
                       line.mass[base + 1] * stretched * world.setup.gravity.dot(line.tangent(base));
    for (int k = 0; k < count; ++k) {
        WireResult& result = world.output.results[group.wires()[k]];
        result.hand_torque = -hands.torque[k];
        if (world.forces.coaxial_friction)
            world.forces.coaxial_friction->set_outside(group.wires()[k], axial_contact(world, group, k));
        if (k == group.leader) continue;
        const double beside = weight_of(world, group, k) - axial_contact(world, group, k);
        result.hand_force = hands.push(k, group.leader, count) + beside + twist_behind(world, group, hands, k) -
                            axial_friction(world.forces, group.wires()[k]);
        of_leader -= beside;
    }
    of_leader -= axial_friction(world.forces, group.wires()[group.leader]);
    world.output.results[group.wires()[group.leader]].hand_force = of_leader;
}

MergedForces merged_forces(WorldData& world, const MergedGroup& group)
{
    const CoaxialHands hands = world.solver->coaxial_hands(group.line());
    MergedForces forces(group.shared.count());
    auto to = forces.value.begin();
    *to++ = hands.line_force;
    for (int k = 0; k < group.shared.count(); ++k)
        for (const double force :
             {hands.offset_force[k], axial_contact(world, group, k), axial_friction(world.forces, group.wires()[k]),
              twist_behind(world, group, hands, k), hands.torque[k]})
            *to++ = force;
    return forces;
}

MergedWork merged_work(const WorldData& world, const MergedGroup& group, const MergedForces& forces)
{
    MergedWork work;
    work.feed = forces.value[0] * group.feed.grown;
    work.hand = group.weight_work;
    for (int k = 0; k < group.shared.count(); ++k) {
        const double* of = &forces.value[1 + MergedForces::each * static_cast<std::size_t>(k)];
        const double pushed = of[0], around = of[1], friction = of[2], behind = of[3], torque = of[4];
        work.feed += pushed * group.slid[k];
        if (group.slid[k] != 0) work.hand -= around * group.slid[k];
        if (group.shared.fed[k] != 0) work.hand -= friction * group.shared.fed[k];
        work.feed += behind * world.feed(group.wires()[k]).grown;
        work.turning += torque * group.turned[k];
    }
    work.hand += work.feed;
    return work;
}

namespace {

/// One that is not in yet: the last half edge of it, in the introducer.
void show_outside(WorldData& world, const MergedGroup& group, int k)
{
    const int w = group.wires()[k];
    world.groups.shown->set_node_count(w, 2);
    const RodView own = world.groups.shown->view(w);
    const FeedState& feed = world.feed(w);
    for (const std::span<double>& array : world.groups.shown->arrays(w)) std::ranges::fill(array, 0.0);
    for (int i = 0; i < 2; ++i) {
        own.material_s[i] = i * group.feed.edge / 2;
        own.set_pos(i, feed.point + (feed.advance - own.material_s[i]) * feed.direction);
        own.set_vel(i, feed.speed * feed.direction);
        own.theta[i] = -feed.turn;
        own.set_tangent(i, -feed.direction);
        own.set_ref_d1(i, feed.director);
    }
    own.rest_length[0] = group.feed.edge / 2;
    own.radius[0] = own.radius[1] = world.setup.wires[w].wire.shaft.radius;
}

/// Its own stiffness, mass and radius.
void show_section(const RodView& own, const WireSpec& spec)
{
    for (int i = 0; i < own.n; ++i) {
        const double s = own.material_s[i];
        const int j = std::min(i, own.n - 2);
        const WireSection& at = spec.at(std::clamp(s, 0.0, spec.length));
        const WireSection& along = spec.at(std::clamp(0.5 * (own.material_s[j] + own.material_s[j + 1]), 0.0, spec.length));
        own.bend_stiffness[i] = at.bend_stiffness;
        own.twist_stiffness[i] = at.twist_stiffness;
        own.stretch_stiffness[i] = along.stretch_stiffness;
        own.radius[i] = along.radius;
        own.mass[i] = mass_rate(&at) * own.voronoi_length(i);
        own.rest_kappa1[i] = at.rest_curvature[0] * own.voronoi_length(i);
        own.rest_kappa2[i] = at.rest_curvature[1] * own.voronoi_length(i);
    }
}

void show(WorldData& world, const MergedGroup& group, int k)
{
    const int w = group.wires()[k];
    const RodView line = world.rod(group.line()), angles = world.rod(w);
    const double tip = -group.shared.rod.instrument[k].offset, hub = line.material_s[line.n - 1];
    const double least = 1e-6 * group.feed.edge;
    world.groups.shown_from[w] = 0;
    if (!group.feed.inside || !(hub - tip > least)) return show_outside(world, group, k);
    int edge = 0;  // that its tip is on
    while (edge < line.n - 2 && line.material_s[edge + 1] - tip <= least) ++edge;
    world.groups.shown_from[w] = edge;
    const int n = line.n - edge;
    world.groups.shown->set_node_count(w, n);
    const RodView own = world.groups.shown->view(w);
    const auto to = world.groups.shown->arrays(w);
    const auto from = world.state.rods.arrays(group.line());
    for (std::size_t a = 0; a < to.size(); ++a) std::ranges::copy(from[a].subspan(edge, n), to[a].begin());
    for (int i = 0; i < n; ++i) {
        own.material_s[i] -= tip;
        own.theta[i] = angles.theta[i + edge];
        own.spin_rate[i] = angles.spin_rate[i + edge];
        own.spin_acc[i] = angles.spin_acc[i + edge];
    }
    const double share = std::clamp((tip - line.material_s[edge]) / line.rest_length[edge], 0.0, 1.0);
    own.set_pos(0, (1 - share) * line.pos(edge) + share * line.pos(edge + 1));
    own.set_vel(0, (1 - share) * line.vel(edge) + share * line.vel(edge + 1));
    own.material_s[0] = 0;
    own.rest_length[0] = own.material_s[1];
    own.ref_twist[0] = own.clamp_twist_a[0] = 0;
    show_section(own, world.setup.wires[w].wire);
    for (int j = 0; j < n - 1; ++j) own.spin_inertia[j] = angles.spin_inertia[j + edge];
}

}  // namespace

void show_instruments(WorldData& world)
{
    for (const auto& group : world.groups.list)
        for (int k = 0; k < group->shared.count(); ++k) {
            const int w = group->wires()[k];
            world.groups.shown->set_curvature(w, world.rod(group->line()).curvature);
            show(world, *group, k);
        }
}

namespace {

/// Jumps where a piece ends and instrument k with it, or its section: of the compliance of all together, and of their natural
/// curvature.
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
    WorldData& world = data_of(given);
    const MergedGroup* group = world.groups.of(wire);
    if (!group || !group->feed.inside) return 0;
    const WorldRod rod(world, group->line());
    const NodeDemands demands = rod.demands();
    const auto wires = group->wires();
    double sum = 0;
    for (int k = 0; k < group->shared.count(); ++k)
        if (k != group->leader && (wires[k] == wire || wires[group->leader] == wire))
            sum += boundary_error(*group, rod.view(), demands.moment, k);
    return sum;
}

}  // namespace seldinger
