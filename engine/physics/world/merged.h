#pragma once
// Instruments that share one centreline in a world (D12, CoaxialSpec::Model::Merged): how they are placed, fed, held and read.
// Private to the engine, as world.h is. What the solver makes of them: solve/coaxial_group.h.
//
// The centreline is as long as the instrument inserted farthest, the leader; its coordinate s counts from the leader's tip, which
// is the line's node 0. Instrument k's material at s is s + o_k, o_k = advance_k - advance of the leader (<= 0). A push of the
// leader makes the base edge longer, as a wire's own feed does (solve/feed.h). It also lowers the offsets of the others, which
// stay at the hub. A push of another instrument moves its offset alone.
//
// Who leads may change: a catheter is pushed beyond the wire's tip, or the wire drawn back into it. The step is cut there, so
// that the new leader continues from the very place of the old one's tip, and is pushed forwards by the material behind it. What
// little it has got ahead by all the same (the time is found without the surplus of rest length) continues the line straight,
// where nothing bends it. A step that was not cut put millimetres there at once: through the wall, where the line points at it.
// The line's material is the new leader's from then on, and as fast: that its kinetic energy and momentum change is counted as of
// material and remeshing.
//
// Each instrument touches the wall only where no other one is around it, with its own radius, friction and stiffness. Its slip is
// that of the instrument's material, so feed past the line counts (contact/quadrature.h, `offset` and `exposed`).
//
// Hands. E is the elastic energy (rod/coaxial.h), w_k the weight of the moved material and L the length of the line at fixed
// offsets. The term a_k is the axial force of wall, loads and links on instrument k, + towards the tip. The force at the hand
// is
//     F_k = dE/do_k + w_k - a_k                                        for an instrument that does not lead,
//     F_l = dE/dL + w_L - sum over the others of (dE/do_k + w_k - a_k)   for the leader.
// Friction between the instruments follows the laws per length of CoaxialSpec (contact/rods/coaxial_friction.h). It pushes back
// on each hand as much as it pulls at another one, and does not act on the line. The force a_k is along the edges that the
// material lies on (EdgeSums::along), and slip counts no turn at their corners. On the outside of a bend the rod's surface
// slides by 1 + kappa r, in a vessel some per cent more. Both sides leave this out, so the hands' work equals the loss by
// friction. CoaxialSpec's mu and stiffness are the separate model's. Axial inertia of sliding material is not included: all
// material of a place moves with the line's.

#include "solve/coaxial_group.h"
#include "solve/feed.h"
#include "world/world.h"

namespace seldinger {

struct MergedGroup {
    const CoaxialSpec* spec = nullptr;  // of WorldData::setup
    CoaxialGroup shared;
    FeedState feed;  // of the line, as of one wire; its advance is the leader's
    int leader = 0;  // place in the group
    WireSpec nodes;  // bounds of the line's edges: those of the instrument that asks for most
    // of the present sub-step
    std::array<double, most_coaxial> slid{}, turned{};  // change of the offsets [m], of the angles that hands hold [rad]
    double weight_work = 0;                             // that hands do on what is moved [J]
    RodFrames frames;                 // scratch, as all that follow
    std::vector<Vec3> moment;         // NodeDemands::moment, and so on
    std::vector<double> turning;
    std::vector<Vec3> contact;

    [[nodiscard]] std::span<const int> wires() const { return shared.wires; }
    [[nodiscard]] int line() const { return shared.line(); }
    [[nodiscard]] bool adapts() const { return nodes.nodes == 0; }
};

/// Before a sub-step of h [s]: whoever is in farthest leads.
void lead_group(WorldData& world, MergedGroup& group, double h);
/// How long it takes from now until another instrument gets ahead of the leader; 0: not within dt, or so near one of its ends
/// that the step need not be cut there [s].
[[nodiscard]] double lead_change_after(const WorldData& world, const MergedGroup& group, double dt);
/// Advances and turns all hubs of the group to the end of the sub-step of `step`. @param h  in which time; infinite: at rest all
/// the way [s]
void feed_group(WorldData& world, MergedGroup& group, double step, double h);
/// Constraints: the line gets its hold at the hub and the loads and links of all instruments in the group at time t; each
/// instrument gets its own holds.
void constrain_member(WorldData& world, const MergedGroup& group, int wire, double t);
/// Loads of the control on its instruments, added to them.
void load_members(WorldData& world, const MergedGroup& group);
/// What its instruments' holds keep, of the line as placed. @throws Error BadScene: they cannot be held there
void take_holds(WorldData& world, MergedGroup& group);
/// Force of loads, links and holds on an instrument along the line, + towards the tip [N].
[[nodiscard]] double axial_load(WorldData& world, const MergedGroup& group, int k);
/// Elastic energy of the accepted state [J].
[[nodiscard]] double elastic_now(RodArrays& rods, MergedGroup& group);
/// After arrays and feeds have been put back: offsets, angles and integrals.
void refresh_group(WorldData& world, MergedGroup& group);

/// Forces by which a group's hands do work [N], [N m]. First dE/dL; then for each instrument dE/do, the forces along the line of
/// its surroundings, of friction and of the twisted length behind the inlet, and its torque.
struct MergedForces {
    static constexpr std::size_t each = 5;
    explicit MergedForces(int instruments) : count(1 + each * static_cast<std::size_t>(instruments)) {}
    std::size_t count;
    std::array<double, 1 + each * most_coaxial> value{};
};
[[nodiscard]] MergedForces merged_forces(WorldData& world, const MergedGroup& group);
/// Elastic work of the feed in the last sub-step, and that of hands in all; of turning, by such forces [J].
struct MergedWork {
    double feed = 0, hand = 0, turning = 0;
};
[[nodiscard]] MergedWork merged_work(const WorldData& world, const MergedGroup& group, const MergedForces& forces);

}  // namespace seldinger
