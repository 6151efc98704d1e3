// The bytes of a world: saving, restoring, hashing.

#include "core/bytes.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "world/merged.h"
#include "world/state_check.h"
#include "world/world.h"

#include <fmt/format.h>

namespace seldinger {

namespace {

// What of a FeedState changes; the rest follows from the scene. There is a surplus only where nodes come and go.
void put_feed(std::vector<std::uint8_t>& bytes, const FeedState& feed, bool nodes_change)
{
    put_bytes(bytes, &feed.advance, 1);
    put_bytes(bytes, &feed.turn, 1);
    put_bytes(bytes, &feed.surplus, 1);
    put_bytes(bytes, &feed.inside, 1);
    if (nodes_change) put_bytes(bytes, &feed.surplus_rate, 1);
}

void take_feed(const std::uint8_t*& bytes, const std::uint8_t* end, FeedState& feed, bool nodes_change)
{
    take_bytes(bytes, end, &feed.advance, 1);
    take_bytes(bytes, end, &feed.turn, 1);
    take_bytes(bytes, end, &feed.surplus, 1);
    take_bytes(bytes, end, &feed.inside, 1);
    if (nodes_change) take_bytes(bytes, end, &feed.surplus_rate, 1);
}

}  // namespace

void World::Impl::put_wire(std::vector<std::uint8_t>& bytes, int wire) const
{
    const std::int32_t n = rods.node_count(wire);
    put_bytes(bytes, &n, 1);
    put_bytes(bytes, &wire_time[wire], 1);
    put_bytes(bytes, &remesh_energy[wire], 1);
    put_feed(bytes, feeds[wire], feeds[wire].on || adapters[wire].on);
    const Solver::SpinRecord& spins = solver->spin_record(wire);
    const std::int32_t waits[2] = {spins.wait, spins.last_wait};
    put_bytes(bytes, waits, 2);
    // views are of changeable arrays; these only read
    for (const std::span<double>& array : const_cast<RodArrays&>(rods).arrays(wire)) put_bytes(bytes, array.data(), array.size());
    if (merged_of[wire] < 0 || is_passenger(wire)) return;
    const MergedGroup& group = *merged[merged_of[wire]];
    const std::int32_t leader = group.leader;
    put_bytes(bytes, &leader, 1);
    put_feed(bytes, group.feed, true);
}

std::vector<std::uint8_t> World::Impl::state_bytes() const
{
    std::vector<std::uint8_t> bytes;
    put_bytes(bytes, &time, 1);
    const std::int64_t taken = steps;
    put_bytes(bytes, &taken, 1);
    for (int w = 0; w < wire_count(); ++w) put_wire(bytes, w);
    terms.save(bytes);
    return bytes;
}

std::vector<std::uint8_t> World::save_state() const
{
    std::vector<std::uint8_t> bytes = impl_->state_bytes();
    for (const EnergyAudit& audit : impl_->audits) put_audit(bytes, audit);
    put_carried(bytes, impl_->carried, impl_->wire_list);
    return bytes;
}

void World::Impl::take_wire(const std::uint8_t*& at, const std::uint8_t* end, int wire)
{
    std::int32_t n = 0;
    take_bytes(at, end, &n, 1);
    if (n < 2 || n > rods.capacity(wire))
        throw Error(ExitCode::BadFile, "the saved state has another number of nodes than this scene's wire can have");
    rods.set_node_count(wire, n);
    take_bytes(at, end, &wire_time[wire], 1);
    take_bytes(at, end, &remesh_energy[wire], 1);
    take_feed(at, end, feeds[wire], feeds[wire].on || adapters[wire].on);
    std::int32_t waits[2] = {};
    take_bytes(at, end, waits, 2);
    solver->spin_record(wire).wait = waits[0];
    solver->spin_record(wire).last_wait = waits[1];
    for (const std::span<double>& array : rods.arrays(wire)) take_bytes(at, end, array.data(), array.size());
    if (merged_of[wire] < 0 || is_passenger(wire)) return;
    MergedGroup& group = *group_of(wire);
    std::int32_t leader = 0;
    take_bytes(at, end, &leader, 1);
    if (leader < 0 || leader >= group.shared.count())
        throw Error(ExitCode::BadFile, "the saved state names an instrument that this scene does not have");
    group.leader = leader;
    take_feed(at, end, group.feed, true);
}

namespace {

enum class Origin { File, Own };  // Own: saved a moment ago, and restored whatever it holds

void take_state(World::Impl& s, const std::vector<std::uint8_t>& bytes, Origin origin)
{
    const std::uint8_t* at = bytes.data();
    const std::uint8_t* end = at + bytes.size();
    s.loads_known = false;
    take_bytes(at, end, &s.time, 1);
    std::int64_t steps = 0;
    take_bytes(at, end, &steps, 1);
    if (origin == Origin::File) check_saved_time(s.time, steps);
    s.steps = static_cast<long>(steps);
    for (int w = 0; w < s.wire_count(); ++w) {
        s.take_wire(at, end, w);
        if (origin == Origin::File) check_saved_wire(s, w);
    }
    for (const auto& group : s.merged) refresh_group(s, *group);
    set_exposures(s);
    show_groups(s);
    s.terms.restore(at, end);
    for (EnergyAudit& audit : s.audits) {
        take_audit(at, end, audit);
        if (origin == Origin::File) check_saved_audit(audit);
    }
    take_carried(at, end, s.carried, s.wire_list);
    if (at != end)
        throw Error(ExitCode::BadFile, "the saved state is longer than this scene's; it was written by another scene or version");
}

}  // namespace

void World::restore_state(const std::vector<std::uint8_t>& bytes)
{
    const std::vector<std::uint8_t> before = save_state();
    try {
        take_state(*impl_, bytes, Origin::File);
    } catch (...) {
        take_state(*impl_, before, Origin::Own);
        throw;
    }
}

void World::Impl::put_back(const std::vector<std::uint8_t>& bytes) { take_state(*this, bytes, Origin::Own); }

std::vector<std::uint8_t> World::save_state(int system) const
{
    const Impl& s = *impl_;
    std::vector<std::uint8_t> bytes;
    for (const int w : s.wires_of(system)) s.put_wire(bytes, w);
    for (const int w : s.wires_of(system)) s.terms.save_wire(bytes, w);
    for (const int w : s.wires_of(system)) put_audit(bytes, s.audits[w]);
    put_carried(bytes, s.carried, s.wires_of(system));
    return bytes;
}

namespace {

void take_system(World::Impl& s, int system, const std::vector<std::uint8_t>& bytes, Origin origin)
{
    const std::uint8_t* at = bytes.data();
    const std::uint8_t* end = at + bytes.size();
    s.loads_known = false;
    for (const int w : s.wires_of(system)) {
        s.take_wire(at, end, w);
        if (origin == Origin::File) check_saved_wire(s, w);
    }
    for (const int w : s.wires_of(system))
        if (MergedGroup* group = s.group_of(w); group && !s.is_passenger(w)) refresh_group(s, *group);
    if (!s.merged.empty()) {
        set_exposures(s);
        show_groups(s);
    }
    for (const int w : s.wires_of(system)) s.terms.restore_wire(at, end, w);
    for (const int w : s.wires_of(system)) {
        take_audit(at, end, s.audits[w]);
        if (origin == Origin::File) check_saved_audit(s.audits[w]);
    }
    take_carried(at, end, s.carried, s.wires_of(system));
    if (at != end) throw Error(ExitCode::BadFile, "the saved state is longer than this system's; it was written by another one");
}

}  // namespace

void World::restore_state(int system, const std::vector<std::uint8_t>& bytes)
{
    const std::vector<std::uint8_t> before = save_state(system);
    try {
        take_system(*impl_, system, bytes, Origin::File);
    } catch (...) {
        take_system(*impl_, system, before, Origin::Own);
        throw;
    }
}

namespace {

std::string hash_of(const std::vector<std::uint8_t>& bytes) { return fmt::format("{:016x}", fnv1a(bytes.data(), bytes.size())); }

}  // namespace

std::string World::state_hash() const
{
    if (system_count() == 1 && wire_count() > 1) return state_hash(0);  // what it is beside others too
    std::vector<std::uint8_t> bytes = impl_->state_bytes();
    put_carried(bytes, impl_->carried, impl_->wire_list);
    return hash_of(bytes);
}

std::string World::state_hash(int system) const
{
    const Impl& s = *impl_;
    std::vector<std::uint8_t> bytes;
    put_bytes(bytes, &s.wire_time[s.wires_of(system).front()], 1);  // alone, its time is the world's
    const std::int64_t steps = s.steps;
    put_bytes(bytes, &steps, 1);
    for (const int w : s.wires_of(system)) s.put_wire(bytes, w);
    for (const int w : s.wires_of(system)) s.terms.save_wire(bytes, w);
    put_carried(bytes, s.carried, s.wires_of(system));
    return hash_of(bytes);
}

}  // namespace seldinger
