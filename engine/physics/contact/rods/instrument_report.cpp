// State of contact between instruments from step to step: saved, restored, reported.
#include "contact/loads/contact_patch.h"
#include "contact/rods/instrument_contact.h"

#include "contact/point_states.h"
#include "core/state_walk.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

constexpr double farthest = 1e3;  // along an instrument [m]

}  // namespace

/// The slots of a wire's cells as far as they were inside, those zero that no contact of the last step has written.
std::vector<InstrumentState> InstrumentContact::living(int wire)
{
    const auto first = static_cast<std::size_t>(cells_.of_wire[wire]);
    std::vector<InstrumentState> states(static_cast<std::size_t>(with_states_[wire]) * SEL_INSTRUMENT_SLOTS);
    context_.enter(device::Queue::Inline);
    context_.read(device::Queue::Inline, states_t0_, states.data(), states.size() * sizeof(InstrumentState),
                  first * SEL_INSTRUMENT_SLOTS * sizeof(InstrumentState));
    for (InstrumentState& state : states)
        if (state.contact.epoch + 1 != cells_.rods[wire].epoch) std::memset(&state, 0, sizeof state);
    return states;
}

void InstrumentContact::walk_state(StateWalk& walk, int wire)
{
    InstrumentRod& rod = cells_.rods[wire];
    if (rod.pairs == 0) return;  // touches none: its bytes must not tell whether others of the world do
    const auto first = static_cast<std::size_t>(SEL_INSTRUMENT_SLOTS * cells_.of_wire[wire]);
    const auto size = static_cast<std::size_t>(SEL_INSTRUMENT_SLOTS * cells_.of_wire[wire + 1]) - first;
    std::vector<InstrumentState> states;
    if (walk.reads()) states.assign(no_states_.begin(), no_states_.begin() + static_cast<std::ptrdiff_t>(size));
    else states = living(wire);
    const auto lives = [](const InstrumentState& state) { return state.contact.epoch != 0; };
    auto count = static_cast<std::uint32_t>(std::count_if(states.begin(), states.end(), lives));
    walk({"the number of a step", "", "accept"}, rod.epoch);
    walk({"the number of contacts", "", "accept", 0, static_cast<double>(size)}, count);
    for (std::uint32_t k = 0, next = 0; k < count; ++k, ++next) {
        while (!walk.reads() && !lives(states[next])) ++next;
        walk({"a contact's cell", "", "accept", 0, static_cast<double>(size) - 1}, next);
        InstrumentState& state = states[next];
        state.pair -= rod.pair;  // a system's bytes do not depend on those before it
        walk({"a contact between instruments", "", "accept"}, state);
        if (walk.reads()) check_state(state, rod);
        state.pair += rod.pair;
    }
    if (walk.reads()) take_states(wire, states);
}

/// Checks a contact that was read; its pair is counted from the rod's first. @throws Error BadFile
void InstrumentContact::check_state(const InstrumentState& state, const InstrumentRod& rod) const
{
    StateWalk::need(state.pair < rod.pairs, "which instruments touch");
    // its edge of the other one is where that is looked along from, as are the places along both
    check_contact_states({&state.contact, 1}, static_cast<std::size_t>(rods_.total_capacity()));
    StateWalk::need(std::abs(state.along_a) <= farthest && std::abs(state.along_b) <= farthest, "where instruments touch");
}

/// Takes the states of all slots of a wire's cells, as they were read.
void InstrumentContact::take_states(int wire, std::span<const InstrumentState> states)
{
    const auto first = static_cast<std::size_t>(SEL_INSTRUMENT_SLOTS * cells_.of_wire[wire]);
    std::vector<std::uint32_t>& touching = touching_[static_cast<std::size_t>(wire)];
    touching.clear();
    for (std::size_t k = 0; k < states.size(); ++k)
        if (states[k].contact.flags & SEL_CONTACT_ACTIVE) touching.push_back(static_cast<std::uint32_t>(first + k));
    with_states_[wire] = cells_.of_wire[wire + 1] - cells_.of_wire[wire];
    context_.enter(device::Queue::Inline);
    context_.write(device::Queue::Inline, states_t0_, states.data(), states.size_bytes(), first * sizeof(InstrumentState));
    // a repeated epoch must not find marks of an earlier one
    context_.write(device::Queue::Inline, states_, no_states_.data(), states.size_bytes(), first * sizeof(InstrumentState));
    context_.finish(device::Queue::Inline);
}

namespace {

const InstrumentSurface& surface_at(const InstrumentCells& cells, int wire, double along)
{
    const int first = cells.of_wire[wire], last = cells.of_wire[wire + 1] - 1;
    return cells.surfaces[std::clamp(first + static_cast<int>(along / cells.rods[wire].spacing), first, last)];
}

}  // namespace

/// Calls f(state) with each contact of the last step, in the order of its cells.
template <class F>
void InstrumentContact::for_each_contact(int wire, const F& f)
{
    const std::vector<std::uint32_t>& slots = touching_[static_cast<std::size_t>(wire)];
    if (slots.empty()) return;
    const std::size_t first = slots.front(), count = slots.back() + 1 - first;
    context_.enter(device::Queue::Inline);
    context_.read(device::Queue::Inline, states_t0_, host_t0_.data() + first, count * sizeof(InstrumentState),
                  first * sizeof(InstrumentState));
    for (const std::uint32_t slot : slots) {
        const InstrumentState& state = host_t0_[slot];
        if (state.contact.epoch + 1 == cells_.rods[wire].epoch && (state.contact.flags & SEL_CONTACT_ACTIVE)) f(state);
    }
}

void InstrumentContact::add_loads(std::span<WireLoads> loads)
{
    for (int w = 0; w < rods_.wire_count(); ++w)
        for_each_contact(w, [&](const InstrumentState& state) {
            const double *f = state.contact.friction, rubs = std::hypot(f[0], f[1], f[2]);
            const uint other = cells_.pairs[state.pair].b;
            loads[static_cast<std::size_t>(w)].add({state.along_a, state.length, state.contact.normal_force}, rubs);
            const LoadSample there{state.along_b, state.length, state.contact.normal_force};
            // a wire that touches itself bears it on both strands, and its sums count it once
            if (other == static_cast<uint>(w)) loads[other].samples.push_back(there);
            else loads[other].add(there, rubs);
        });
}

std::vector<ContactRow> InstrumentContact::rows(RodArrays& rods)
{
    std::vector<ContactRow> list;
    for (int w = 0; w < rods.wire_count(); ++w) {
        const RodView rod = rods.view(w);
        for_each_contact(w, [&](const InstrumentState& state) {
            const ContactState& contact = state.contact;
            const auto edge = std::upper_bound(rod.material_s.begin(), rod.material_s.begin() + rod.n - 1, state.along_a);
            ContactRow row;
            row.a = {BodyKind::Rod, w, std::max(0, static_cast<int>(edge - rod.material_s.begin()) - 1)};
            row.b = {BodyKind::Rod, static_cast<int>(cells_.pairs[state.pair].b), static_cast<int>(contact.triangle)};
            row.point = {contact.point[0], contact.point[1], contact.point[2]};
            row.normal = {contact.normal[0], contact.normal[1], contact.normal[2]};
            row.gap = contact.gap;
            row.normal_force = contact.normal_force;
            row.friction = {contact.friction[0], contact.friction[1], contact.friction[2]};
            row.stuck = contact.flags & SEL_CONTACT_STUCK;
            row.length = state.length;
            row.along_a = state.along_a;
            row.along_b = state.along_b;
            const bool inside = state.touch == SEL_TOUCH_INSIDE;
            const InstrumentSurface &a = surface_at(cells_, w, row.along_a), &b = surface_at(cells_, row.b.body, row.along_b);
            row.area = overlap_width(-row.gap, a.radius, inside ? b.lumen : b.radius, inside) * row.length;
            list.push_back(row);
        });
    }
    return list;
}

}  // namespace seldinger
