#pragma once
// One rod of a world: K >= 1 instruments on one centreline. A wire by itself is a rod of one instrument: its arrays are the
// line's, its feed is the rod's. Stages of a step ask the rod, so each is written once. What only K > 1 instruments have
// (offsets, a leader, hands that slide on each other) is in merged.h.

#include "nodes/coaxial_nodes.h"
#include "world/merged.h"

namespace seldinger {

class WorldRod {
public:
    /// @param line  a wire by itself, or the line of a group; no passenger
    WorldRod(WorldData& world, int line) : world_(world), group_(world.groups.of(line)), line_(line)
    {
        SEL_ASSERT(world.is_line(line));
    }

    [[nodiscard]] WorldData& world() const { return world_; }
    [[nodiscard]] int line() const { return line_; }
    /// What K > 1 instruments have besides; null: one wire.
    [[nodiscard]] MergedGroup* group() const { return group_; }
    [[nodiscard]] std::span<const int> wires() const { return group_ ? group_->wires() : world_.systems.all().subspan(line_, 1); }
    [[nodiscard]] RodView view() const { return world_.rod(line_); }
    [[nodiscard]] FeedState& feed() const { return group_ ? group_->feed : world_.feed(line_); }
    /// Path of the hub that feeds the line.
    [[nodiscard]] HubPath hub() const { return world_.work.wires[group_ ? group_->wires()[group_->leader] : line_].hub.path(); }
    /// Whether nodes come and go anywhere along it.
    [[nodiscard]] bool adapts() const { return world_.adapter(line_).on; }
    /// Bounds of its edges.
    [[nodiscard]] const WireSpec& bounds() const { return group_ ? group_->nodes : world_.setup.wires[line_].wire; }

    // ---- input of its hubs
    /// Before a sub-step of h [s]: of several instruments the one that is in farthest leads.
    void lead(double h) const;
    /// Where a step of dt is to be cut, as another instrument gets ahead of the leader; 0: nowhere [s].
    [[nodiscard]] double lead_change(double dt) const;
    /// Advances and turns all hubs to the end of the sub-step of `step`. @param h  in which time; infinite: at rest all the way
    /// [s]
    void push(double step, double h) const;
    /// Constraints of one of its instruments at time t.
    void constrain(int wire, double t) const;
    /// Adds the control's loads to them.
    void load() const;

    // ---- of the accepted state
    /// After nodes or feeds have changed: constraints of a wire; offsets, angles and integrals of a group.
    void refresh() const;
    /// Elastic energy [J]; refresh() has been called. Not for two rods at once.
    [[nodiscard]] double elastic_energy() const;
    /// What its nodes are judged by, but for contact. Valid until the next call, as contact().
    [[nodiscard]] NodeDemands demands() const;
    /// Force of contact on its nodes, by all of its instruments [nodes] [N].
    [[nodiscard]] std::span<const Vec3> contact() const;
    /// Calls `change` with its nodes, to be split and merged.
    template <class Change>
    void with_nodes(Change change) const
    {
        RodArrays& rods = world_.state.rods;
        if (group_) return change(CoaxialNodes(rods, wires(), group_->shared.rod, group_->shared.base, group_->frames));
        change(WireNodes(rods, line_, bounds(), world_.constraints(line_).clamps, bounds().place.rest_is_placed && !feed().on));
    }

private:
    WorldData& world_;
    MergedGroup* group_;  // null: one wire
    int line_;
};

// ---- rods of K > 1 instruments, all at once: merged.cpp, merged_read.cpp

/// Capacities of their wires; the groups of the setup; their lines placed, once each wire has arrays; their unknowns joined, and
/// the force terms of friction and holds made, after those of contact.
void set_group_capacities(const WorldSetup& setup, std::span<int> capacities);
void make_groups(WorldData& world);
void place_groups(WorldData& world);
void join_groups(WorldData& world);
/// Where the instruments lie in their rods now, for contact.
void set_exposures(WorldData& world);
/// Nothing is pushed while an equilibrium is looked for.
void stop_hands(WorldData& world);
/// Force and torque of the hand at each instrument of such a rod [N], [N m], + pushes and turns right-handed about the direction
/// of insertion.
void read_hands(const WorldRod& rod);
/// Each instrument alone, from its own tip to the hub: the view of World::rod(). After a step, and where the state was put back.
void show_instruments(WorldData& world);

}  // namespace seldinger
