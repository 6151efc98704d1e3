#pragma once
// One rod of a world: K >= 1 instruments on one centreline. A wire by itself is a rod of one instrument: its arrays are the line's,
// its feed is the rod's. Stages of a step ask the rod, so each is written once. What only K > 1 instruments have (offsets, a leader,
// hands that slide on each other) is in merged.h.

#include "rod/coaxial_nodes.h"
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

}  // namespace seldinger
