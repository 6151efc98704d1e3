// What of a world must survive a step, row by row, and the walks over these rows: saving, restoring, hashing, keeping a wire for
// an attempt and putting it back.
#include "core/state_walk.h"
#include "world/world_rod.h"

#include <cmath>

namespace seldinger {
namespace {

constexpr double longest = 1e4;      // [m] places, lengths
constexpr double most_turned = 1e9;  // [rad]
constexpr double latest = 1e12;      // [s]
constexpr double least_edge = 1e-9;  // [m] an edge: a thousandth of what a wire is thick

/// First of the saved bytes: the rows below and their order. Another table, another number.
constexpr std::uint64_t state_layout = 0x374554415453454C;  // "LESTATE7"

void walk_layout(StateWalk& walk)
{
    std::uint64_t written = state_layout;
    walk({"the layout", "", "", 0, INFINITY}, written);
    if (written != state_layout)
        throw Error(ErrorKind::BadFile,
                    "the saved state: got one that another version has written; expected one of this version. Fix: resume with "
                    "that version, or run again");
}

// What of a FeedState changes; the rest follows from the scene. There is a surplus only where nodes come and go.
void walk_feed(StateWalk& walk, FeedState& feed, bool nodes_change)
{
    walk({"a fed length", "m", "feed_hubs", -longest, longest}, feed.advance);
    walk({"a turn", "rad", "feed_hubs", -most_turned, most_turned}, feed.turn);
    walk({"a fed length", "m", "feed_hubs, adapt_nodes", -longest, longest}, feed.surplus);
    walk({"a feed's flag", "", "feed_hubs", 0, 1}, feed.inside);
    if (nodes_change) walk({"a feed's speed", "m/s", "feed_hubs, adapt_nodes"}, feed.surplus_rate);
    if (!walk.of_attempt()) return;
    walk({"a feed's speed", "m/s", "feed_hubs"}, feed.speed);
    walk({"a fed length", "m", "feed_hubs"}, feed.grown);
}

/// Only where a force drives it: other worlds have no such rows.
void walk_hub(StateWalk& walk, HubState& hub)
{
    const StateRow row{"a hub's motion", "m/s, m/s^2, N, kg, N/m", "accept"};
    for (double* value : {&hub.speed, &hub.acceleration, &hub.answer, &hub.mass, &hub.stiffness}) walk(row, *value);
}

void walk_node_count(StateWalk& walk, RodArrays& rods, int wire)
{
    std::int32_t n = rods.node_count(wire);
    walk({"a number of nodes", "", "adapt_nodes"}, n);
    if (n < 2 || n > rods.capacity(wire))
        throw Error(ErrorKind::BadFile, "the saved state has another number of nodes than this scene's wire can have");
    if (walk.reads()) rods.set_node_count(wire, n);
}

/// @param rod  the feed's own, null where it has none
void check_saved_feed(const FeedState& feed, double length, const RodView* rod)
{
    if (!feed.on) return;
    StateWalk::need(feed.advance >= 0 && feed.advance <= length * (1 + 1e-9), "a fed length");
    if (!feed.inside || !rod) return;
    const double inside = rod->material_s[rod->n - 1];  // what is there is what was fed and the surplus
    StateWalk::need(std::abs(inside - (feed.advance + feed.surplus)) <= 1e-6 * length, "a fed length");
}

void check_saved_edges(const RodView& rod)
{
    for (int j = 0; j + 1 < rod.n; ++j) {
        const double length = rod.material_s[j + 1] - rod.material_s[j];
        StateWalk::need(length > least_edge && std::abs(rod.rest_length[j] - length) <= 1e-6 * length, "an edge's length");
    }
}

void walk_group(StateWalk& walk, MergedGroup& group)
{
    std::int32_t leader = group.leader;
    walk({"a leader", "", "feed_hubs"}, leader);
    if (leader < 0 || leader >= group.shared.count())
        throw Error(ErrorKind::BadFile, "the saved state names an instrument that this scene does not have");
    if (walk.reads()) group.leader = leader;
    walk_feed(walk, group.feed, true);
    if (walk.checks()) check_saved_feed(group.feed, longest, nullptr);
}

void walk_wire(StateWalk& walk, WorldData& world, int wire)
{
    WireState& own = world.state.wires[wire];
    walk_node_count(walk, world.state.rods, wire);
    walk({"the time", "s", "accept", -latest, latest}, own.time);
    walk({"an energy", "J", "adapt_nodes"}, own.remesh_energy);
    walk_feed(walk, own.feed, own.feed.on || world.adapter(wire).on);
    if (world.is_driven(wire)) walk_hub(walk, own.hub);
    if (!walk.of_attempt()) {  // what a failed attempt has found out of the spins is not forgotten
        Solver::SpinRecord& spins = world.solver->spin_record(wire);
        walk({"a count of steps", "", "solve", 0, 256}, spins.wait);
        walk({"a count of steps", "", "solve", 0, 256}, spins.last_wait);
    }
    // lines and passengers of a common centreline: values in use follow from others, and the remaining ones may be zero
    const bool alone = !world.groups.has(wire);
    world.state.rods.walk_state(walk, wire, alone);
    if (walk.checks()) {
        const RodView rod = world.rod(wire);
        if (alone) check_saved_edges(rod);
        check_saved_feed(own.feed, world.setup.wires[wire].wire.length, alone ? &rod : nullptr);
    }
    if (!alone && world.is_line(wire)) walk_group(walk, *world.groups.of(wire));
}

// Affects no motion, and so is not part of the hashed state.
void walk_audit(StateWalk& walk, EnergyAudit& audit)
{
    const StateRow energy{"an energy", "J", "accept"};
    std::uint8_t known = audit.known;
    walk({"an energy's flag", "", "accept"}, known);
    audit.known = known != 0;
    walk.numbers(energy, audit.balance);
    walk.numbers(energy, audit.ledger);
    for (double* value : {&audit.wire_then, &audit.elastic_then, &audit.moving, &audit.remeshed}) walk(energy, *value);
    walk({"a hand's force", "N", "accept"}, audit.hand_force);
    walk({"a feed's speed", "m/s", "accept"}, audit.speed);
    for (auto* list : {&audit.held, &audit.held_speed, &audit.torque, &audit.turns})
        walk.list<std::int32_t>({"a reaction", "N, m/s, N m, rad", "accept"}, *list);
}

void walk_wires(StateWalk& walk, WorldData& world, std::span<const int> wires, bool with_audits)
{
    for (const int w : wires) walk_wire(walk, world, w);
    if (walk.reads()) {
        world.output.loads_known = false;
        for (const int w : wires)
            if (MergedGroup* group = world.groups.of(w); group && world.is_line(w)) refresh_group(world, *group);
        set_exposures(world);
        show_instruments(world);
    }
    for (const int w : wires) world.forces.terms.walk_state(walk, w);
    for (const int w : wires)
        if (with_audits) {
            walk_audit(walk, world.audit(w));
            if (world.is_driven(w)) walk.numbers({"an energy", "J", "accept"}, world.state.wires[w].hub.readings);
        }
    walk_carried(walk, world.state.wires, wires);  // the last rows: where no wire carries anything there are none
}

void walk_all(StateWalk& walk, WorldData& world, bool with_audits)
{
    walk({"the time", "s", "check_state", 0, latest}, world.state.time);
    std::int64_t taken = world.state.steps;
    walk({"the number of steps", "", "step", 0}, taken);
    if (walk.reads()) world.state.steps = static_cast<long>(taken);
    walk_wires(walk, world, world.systems.all(), with_audits);
}

/// @param system  -1: the whole world
void walk_saved(WorldData& world, StateWalk& walk, int system)
{
    walk_layout(walk);
    if (system < 0) walk_all(walk, world, true);
    else walk_wires(walk, world, world.systems.wires_of(system), true);
    if (walk.reads() && walk.left() > 0)
        throw Error(ErrorKind::BadFile,
                    "the saved state is longer than this scene's; it was written by another scene or version");
}

std::vector<std::uint8_t> saved_bytes(WorldData& world, int system)
{
    std::vector<std::uint8_t> bytes;
    StateWalk walk(bytes);
    walk_saved(world, walk, system);
    return bytes;
}

void take_saved(WorldData& world, std::span<const std::uint8_t> bytes, int system, bool trusted)
{
    StateWalk walk(bytes, trusted);
    walk_saved(world, walk, system);
}

void restore_saved(WorldData& world, std::span<const std::uint8_t> bytes, int system)
{
    const std::vector<std::uint8_t> before = saved_bytes(world, system);
    try {
        take_saved(world, bytes, system, false);
    } catch (...) {
        take_saved(world, before, system, true);
        throw;
    }
}

}  // namespace

void keep_wire(WorldData& world, int wire)
{
    std::vector<std::uint8_t>& kept = world.work.wires[wire].kept;
    kept.clear();
    StateWalk walk(kept, StateWalk::Of::Attempt);
    walk_wire(walk, world, wire);
}

void put_back_wire(WorldData& world, int wire)
{
    StateWalk walk(world.work.wires[wire].kept, true, StateWalk::Of::Attempt);
    walk_wire(walk, world, wire);
}

void put_back_wires(WorldData& world, const WireMask& wires)
{
    for (int w = 0; w < world.wire_count(); ++w)
        if (wires[w]) put_back_wire(world, w);
    for (const auto& group : world.groups.list)
        if (wires[group->line()]) refresh_group(world, *group);
}

void save_state(WorldData& world, std::vector<std::uint8_t>& to)
{
    to.clear();
    StateWalk walk(to);
    walk_saved(world, walk, -1);
}

void put_back_saved(WorldData& world, std::span<const std::uint8_t> bytes) { take_saved(world, bytes, -1, true); }

std::vector<std::uint8_t> World::save_state() const { return saved_bytes(*data_, -1); }
std::vector<std::uint8_t> World::save_state(int system) const { return saved_bytes(*data_, system); }
void World::restore_state(const std::vector<std::uint8_t>& bytes) { restore_saved(*data_, bytes, -1); }
void World::restore_state(int system, const std::vector<std::uint8_t>& bytes)
{
    restore_saved(*data_, bytes, system);
    data_->systems.retire(system, false);
}

std::string World::state_hash() const
{
    std::uint64_t hash = fnv1a_start;
    StateWalk walk(hash);
    walk_all(walk, *data_, false);
    return fmt::format("{:016x}", hash);
}

std::string World::state_hash(int system) const
{
    const std::span<const int> wires = data_->systems.wires_of(system);
    std::uint64_t hash = fnv1a_start;
    StateWalk walk(hash);
    double time = this->time(wires.front());  // alone, its time is the world's
    std::int64_t taken = data_->state.steps;
    walk({"the time", "s", "check_state"}, time);
    walk({"the number of steps", "", "step"}, taken);
    walk_wires(walk, *data_, wires, false);
    return fmt::format("{:016x}", hash);
}

}  // namespace seldinger
