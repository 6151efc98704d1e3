// Contact between instruments in the order in which a step calls it.
#include "contact/rods/instrument_contact.h"

#include "contact/programs.h"
#include "contact/wall_law.h"
#include "core/clock.h"
#include "core/parallel.h"
#include "shared/instrument_near.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {
namespace {

constexpr std::size_t pool_work = 400;  // listed slots from which a launch on all cores pays (a slot takes a microsecond)

device::Queue queue_for_slots(std::size_t count) { return count < pool_work ? device::Queue::Inline : device::Queue::Pool; }

template <class T>
device::Buffer filled(device::Context& context, const std::vector<T>& from)
{
    device::Buffer buffer(context, std::max<std::size_t>(from.size(), 1) * sizeof(T));
    if (!from.empty()) context.write(device::Queue::Inline, buffer, from.data(), from.size() * sizeof(T));
    context.finish(device::Queue::Inline);
    return buffer;
}

std::vector<int> firsts(std::span<const int> system_of)
{
    std::vector<int> list;
    for (std::size_t w = 0; w < system_of.size(); ++w)
        if (w == 0 || system_of[w] != system_of[w - 1]) list.push_back(static_cast<int>(w));
    list.push_back(static_cast<int>(system_of.size()));
    return list;
}

}  // namespace

InstrumentContact::Nodes::Nodes(device::Context& context, int capacity)
    : count(static_cast<std::size_t>(capacity) + 2),  // a rod of two nodes may have a third named, without weight
      all(5 * count),
      position(all.data(), 3 * count),
      material(all.data() + 3 * count, count),
      theta(all.data() + 4 * count, count),
      buffer(context, all.data(), all.size() * sizeof(double))
{
}

void InstrumentContact::Nodes::upload(device::Context& context, device::Queue queue)
{
    context.write(queue, buffer, all.data(), all.size() * sizeof(double));
}

void InstrumentContact::Nodes::upload_moved(device::Context& context, device::Queue queue, int begin, int end)
{
    const auto write = [&](std::span<const double> moved) {
        context.write(queue, buffer, moved.data(), moved.size_bytes(),
                      static_cast<std::size_t>(moved.data() - all.data()) * sizeof(double));
    };
    const auto first = static_cast<std::size_t>(begin), moved = static_cast<std::size_t>(end - begin);
    write(position.subspan(3 * first, 3 * moved));
    write(theta.subspan(first, moved));
}

InstrumentContact::InstrumentContact(device::Context& context, const InstrumentSetup& setup, RodArrays& rods)
    : context_(context),
      rods_(rods),
      cells_(setup),
      system_of_(setup.system_of),
      first_wire_(firsts(setup.system_of)),
      evaluate_(context, programs::instruments, InstrumentKernels::Of::Others),
      evaluate_self_(context, programs::instruments, InstrumentKernels::Of::Itself),
      nodes_(context, rods.total_capacity()),
      nodes_t0_(context, rods.total_capacity()),
      rods_buffer_(context, cells_.rods.size() * sizeof(InstrumentRod)),
      pairs_(filled(context, cells_.pairs)),
      surfaces_(filled(context, cells_.surfaces)),
      rod_of_(filled(context, cells_.rod_of)),
      axes_(cells_.surfaces.size() * SEL_AXIS_POINTS * 3),
      slots_(context, cells_.surfaces.size() * SEL_INSTRUMENT_SLOTS * sizeof(InstrumentSlot)),
      host_t0_(cells_.surfaces.size() * SEL_INSTRUMENT_SLOTS),
      host_(host_t0_.size()),
      touching_(setup.wires.size()),
      states_t0_(context, host_t0_.data(), host_t0_.size() * sizeof(InstrumentState)),
      states_(context, host_.data(), host_.size() * sizeof(InstrumentState)),
      slots_host_(cells_.surfaces.size() * SEL_INSTRUMENT_SLOTS),
      no_states_(slots_host_.size())
{
    traits_.may_jump = false;
    traits_.most_move = cells_.move_limit;
    picked_.reserve(slots_host_.size());  // and never grows: the buffer is its memory
    list_buffer_ = device::Buffer(context, picked_.data(), slots_host_.size() * sizeof(std::uint32_t));
    const std::size_t systems = first_wire_.size() - 1;
    for (std::size_t s = 0; s < systems; ++s) sums_.emplace_back(rods, first_wire_[s], first_wire_[s + 1] - first_wire_[s]);
    found_.of.assign(systems + 1, 0);
    found_before_.of = found_.of;
    picked_of_.assign(systems + 1, 0);
    cleared_.assign(systems, 0);
    searching_.assign(systems, 1);
    searched_position_.assign(nodes_.position.begin(), nodes_.position.end());
    cleared_position_ = searched_position_;
    moved_.assign(nodes_.count, 0);
    written_.assign(systems, 0);
    with_states_.assign(setup.system_of.size(), 0);
    straight_.assign(setup.system_of.size(), 0);
    for (std::size_t w = 0; w < touching_.size(); ++w)
        touching_[w].reserve(static_cast<std::size_t>(cells_.of_wire[w + 1] - cells_.of_wire[w]));
    std::memset(no_states_.data(), 0, no_states_.size() * sizeof(InstrumentState));
    double least = cells_.surfaces.front().radius;
    for (const InstrumentSurface& surface : cells_.surfaces) least = std::min(least, surface.radius);
    params_.skin = least;
    params_.friction = kernel_law(setup.contacts.front().friction);
    params_.smooth_speed = smooth_friction_speed;
    params_.node_count = static_cast<uint>(nodes_.count);
}

void InstrumentContact::set_nodes(Nodes& nodes, const RodView& rod, int begin) const
{
    for (int i = 0; i < rod.n; ++i) {
        const auto at = static_cast<std::size_t>(begin + i);
        nodes.position[3 * at] = rod.x[i];
        nodes.position[3 * at + 1] = rod.y[i];
        nodes.position[3 * at + 2] = rod.z[i];
        nodes.material[at] = rod.material_s[i];
        nodes.theta[at] = i + 1 < rod.n ? rod.theta[i] : 0.0;
    }
}

void InstrumentContact::begin_step(RodArrays& rods, Settling how)
{
    params_.settling = settling_flag(how);
    for (int w = 0; w < rods.wire_count(); ++w) {
        set_nodes(nodes_t0_, rods.view(w), rods.node_begin(w));
        cells_.rods[w].count_t0 = static_cast<uint>(rods.node_count(w));
    }
}

void InstrumentContact::prepare(RodArrays& rods, std::span<const std::uint8_t> live)
{
    const auto start = Clock::now();
    for (int w = 0; w < rods.wire_count(); ++w) {
        const RodView rod = rods.view(w);
        set_nodes(nodes_, rod, rods.node_begin(w));
        InstrumentRod& known = cells_.rods[w];
        known.node = static_cast<uint>(rods.node_begin(w));
        known.count = static_cast<uint>(rod.n);
        known.inside = rod.material_s[rod.n - 1];
        const int cells = cells_.of_wire[w + 1] - cells_.of_wire[w];
        known.live = live[w] ? static_cast<uint>(std::clamp(static_cast<int>(known.inside / known.spacing + 1e-9), 0, cells)) : 0;
    }
    uploaded_ = false;
    // in every step, stale or not: where the nearest place is looked for from decides its last bits, and a run that is resumed
    // knows nothing of searches before
    std::fill(searching_.begin(), searching_.end(), std::uint8_t{1});
    search();
    times.detect += seconds_since(start);
}

void InstrumentContact::set_trial(const TrialState& trial)
{
    for (int w = 0; w < rods_.wire_count(); ++w) {
        const int begin = rods_.node_begin(w);
        for (int i = begin; i < begin + rods_.node_count(w); ++i) {
            const auto at = static_cast<std::size_t>(i);
            nodes_.position[3 * at] = trial.x[at];
            nodes_.position[3 * at + 1] = trial.y[at];
            nodes_.position[3 * at + 2] = trial.z[at];
            nodes_.theta[at] = trial.theta[at];
        }
    }
}

// ---- at a trial -------------------------------------------------------------------------------------------------------------

/// Neighbours in the systems that are evaluated. Most of it does not touch, and moves by micrometres from trial to trial. A slot
/// is not evaluated if the first trial of a step found it farther apart than the nodes on both sides have moved since. (This is
/// known in a lumen and of one rod with itself. The distance to b's curve grows by no more than the moves of its nearest point
/// and of the searching point.)
void InstrumentContact::pick(std::span<const std::uint8_t> active)
{
    picked_.clear();
    place_.clear();
    for (std::size_t s = 0; s + 1 < first_wire_.size(); ++s) {
        picked_of_[s] = picked_.size();
        bool any = false;
        for (int w = first_wire_[s]; w < first_wire_[s + 1]; ++w) any = any || active[w];
        if (!any) continue;
        sums_[s].clear();
        for (int w = first_wire_[s]; w < first_wire_[s + 1] && cleared_[s]; ++w) measure_moves(w);
        for (std::size_t k = found_.of[s]; k < found_.of[s + 1]; ++k) {
            if (cleared_[s] && found_.clear[k] > 0 && moved_together(k) < found_.clear[k]) {
                // an earlier trial may have touched here: its record must not pass for the last one's, and follow() writes
                // another
                if (found_.touch[k] == FoundSlots::Touching) found_.touch[k] = FoundSlots::Touched;
                continue;
            }
            picked_.push_back(found_.slot[k]);
            place_.push_back(static_cast<std::uint32_t>(k));
        }
    }
    picked_of_.back() = picked_.size();
}

/// What the trial has told of touching; its first one also how far apart the others are.
void InstrumentContact::note_clear()
{
    for (std::size_t s = 0; s < cleared_.size(); ++s) {
        for (std::size_t k = picked_of_[s]; k < picked_of_[s + 1]; ++k)
            found_.touch[place_[k]] = forces_[k].count > 0 ? FoundSlots::Touching : FoundSlots::Apart;
        written_[s] = written_[s] || picked_of_[s] < picked_of_[s + 1];
        if (cleared_[s] || picked_of_[s] == picked_of_[s + 1]) continue;
        cleared_[s] = 1;
        for (std::size_t k = picked_of_[s]; k < picked_of_[s + 1]; ++k) found_.clear[place_[k]] = forces_[k].clear;
        for (int w = first_wire_[s]; w < first_wire_[s + 1]; ++w) {
            const auto begin = 3 * static_cast<std::ptrdiff_t>(rods_.node_begin(w)),
                       count = 3 * static_cast<std::ptrdiff_t>(rods_.node_count(w));
            std::copy_n(nodes_.position.begin() + begin, count, cleared_position_.begin() + begin);
        }
    }
}

void InstrumentContact::evaluate(const TermTrial& trial)
{
    auto start = Clock::now();
    set_trial(trial.at);
    bool any = false;
    for (std::size_t s = 0; s < searching_.size(); ++s) {
        searching_[s] = trial.active[first_wire_[s]] && search_is_stale(s);
        any = any || searching_[s];
    }
    if (any) search();
    pick(trial.active);
    times.detect += seconds_since(start);
    if (picked_.empty()) return;
    start = Clock::now();
    params_.inv_dt = trial.h > 0 ? 1 / trial.h : 0;
    const device::Queue queue = queue_for_slots(picked_.size());
    provide_records(picked_.size());
    launch(queue, forces_buffer_);
    context_.read(queue, forces_buffer_, forces_.data(), picked_.size() * sizeof(InstrumentForce));
    context_.read(queue, points_buffer_, points_.data(), picked_.size() * SEL_INSTRUMENT_POINTS * sizeof(InstrumentPoint));
    times.evaluate += seconds_since(start);
    start = Clock::now();
    take_records();
    times.reduce += seconds_since(start);
}

void InstrumentContact::launch(device::Queue queue, const device::Buffer& forces)
{
    context_.enter(queue);
    if (!uploaded_) upload(queue);
    for (std::size_t s = 0; s + 1 < first_wire_.size(); ++s) {
        const int last = first_wire_[s + 1] - 1;
        if (picked_of_[s] < picked_of_[s + 1])
            nodes_.upload_moved(context_, queue, rods_.node_begin(first_wire_[s]),
                                rods_.node_begin(last) + rods_.node_count(last));
    }
    context_.write(queue, list_buffer_, picked_.data(), picked_.size() * sizeof(std::uint32_t));
    params_.item_count = static_cast<uint>(picked_.size());
    const auto of_itself = static_cast<std::size_t>(std::count_if(picked_.begin(), picked_.end(), [&](std::uint32_t slot) {
        return slots_host_[slot].touch == SEL_TOUCH_SELF;
    }));
    const auto evaluate = [&](InstrumentKernels& kernels) {
        kernels.provide(picked_.size());
        kernels.launch(queue, picked_.size(), params_, list_buffer_, rods_buffer_, pairs_, surfaces_, rod_of_,
                       slots_, nodes_.buffer, nodes_t0_.buffer, states_t0_, states_, forces, points_buffer_);
    };
    if (of_itself < picked_.size()) evaluate(evaluate_);
    if (of_itself > 0) evaluate(evaluate_self_);
}

/// Rods, nodes and slots of this step, for the first launch after a search.
void InstrumentContact::upload(device::Queue queue)
{
    context_.write(queue, rods_buffer_, cells_.rods.data(), cells_.rods.size() * sizeof(InstrumentRod));
    nodes_.upload(context_, queue);
    nodes_t0_.upload(context_, queue);
    const std::size_t first = found_.slot.front(), count = found_.slot.back() - first + 1;
    context_.write(queue, slots_, slots_host_.data() + first, count * sizeof(InstrumentSlot), first * sizeof(InstrumentSlot));
    uploaded_ = true;
}

/// Room for so many slots, in the host's memory: few of them touch, and only their output is read.
void InstrumentContact::provide_records(std::size_t slots)
{
    if (forces_.size() >= slots) return;
    forces_buffer_ = {};
    points_buffer_ = {};
    forces_.resize(2 * slots);
    points_.resize(2 * slots * SEL_INSTRUMENT_POINTS);
    forces_buffer_ = device::Buffer(context_, forces_.data(), forces_.size() * sizeof(InstrumentForce));
    points_buffer_ = device::Buffer(context_, points_.data(), points_.size() * sizeof(InstrumentPoint));
}

void InstrumentContact::take_records()
{
    note_clear();
    const InstrumentMoves moves{nodes_.position, nodes_t0_.position, nodes_.theta, nodes_t0_.theta};
    for_each_item(static_cast<int>(sums_.size()), 1, [&](int s) {
        for (std::size_t k = picked_of_[s]; k < picked_of_[s + 1]; ++k) {
            const InstrumentPair& pair = cells_.pairs[forces_[k].pair];
            sums_[s].take(forces_[k], points_.data() + k * SEL_INSTRUMENT_POINTS, static_cast<int>(pair.a),
                          static_cast<int>(pair.b), moves);
        }
    });
}

TermAnswer InstrumentContact::answer(int wire, Ask what)
{
    const InstrumentSums& sums = sums_of(wire);
    TermAnswer answer;
    if (what == Ask::Trial) {
        answer.admissible = !sums.blocked();
        answer.acts = sums.acts();
        answer.unsymmetric = sums.sliding();
        answer.largest_force = sums.largest_force(wire);
    } else if (what == Ask::Energies) {
        answer.energies = {sums.totals(wire).work, sums.from_other(wire), sums.stored(wire)};
    }
    return answer;
}

void InstrumentContact::couple(const SystemUnknowns& system, std::span<double> /*residual*/, BandedSolver* tangent,
                               bool symmetric) const
{
    if (tangent) sums_of(system.wires.front()).couple(system, *tangent, symmetric);
}

// ---- the accepted state -----------------------------------------------------------------------------------------------------

void InstrumentContact::commit(std::span<const std::uint8_t> active)
{
    const auto start = Clock::now();
    note_touching(active);
    follow(active);
    context_.enter(device::Queue::Inline);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) {
            cells_.rods[w].epoch++;
            with_states_[w] = static_cast<int>(cells_.rods[w].live);
        }
    // records of earlier steps that stay where nothing is found are known by their epoch
    if (std::all_of(active.begin(), active.begin() + rods_.wire_count(), [](std::uint8_t on) { return on != 0; })) {
        std::swap(states_, states_t0_);
        host_.swap(host_t0_);
    } else {
        for_each_stretch(found_.slot, cells_.of_wire, [&](int wire, std::size_t first, std::size_t count) {
            if (!active[wire]) return;
            context_.copy(device::Queue::Inline, states_, states_t0_, count * sizeof(InstrumentState),
                          first * sizeof(InstrumentState));
        });
        context_.finish(device::Queue::Inline);
    }
    for (std::size_t s = 0; s < written_.size(); ++s)
        if (active[first_wire_[s]]) written_[s] = 0;
    times.detect += seconds_since(start);
}

/// Whose states are contacts of the step that is taken.
void InstrumentContact::note_touching(std::span<const std::uint8_t> active)
{
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (active[w]) touching_[static_cast<std::size_t>(w)].clear();
    for (std::size_t k = 0; k < found_.slot.size(); ++k) {
        const uint wire = cells_.rod_of[found_.slot[k] / SEL_INSTRUMENT_SLOTS];
        if (found_.touch[k] == FoundSlots::Touching && active[wire]) touching_[wire].push_back(found_.slot[k]);
    }
}

/// States of near slots that do not touch; trials do not write them. Those that are known to be too far apart have none.
void InstrumentContact::follow(std::span<const std::uint8_t> active)
{
    picked_.clear();
    for (std::size_t s = 0; s + 1 < first_wire_.size(); ++s) {
        picked_of_[s] = picked_.size();
        if (!active[first_wire_[s]] || !cleared_[s]) continue;
        for (int w = first_wire_[s]; w < first_wire_[s + 1]; ++w) measure_moves(w);
        for (std::size_t k = found_.of[s]; k < found_.of[s + 1]; ++k) {
            const double followed = SEL_FOLLOWED * cells_.surfaces[found_.slot[k] / SEL_INSTRUMENT_SLOTS].radius;
            const bool far_away = found_.touch[k] == FoundSlots::Apart && found_.clear[k] - moved_together(k) > followed;
            if (found_.touch[k] != FoundSlots::Touching && !far_away) picked_.push_back(found_.slot[k]);
        }
    }
    picked_of_.back() = picked_.size();
    if (picked_.empty()) return;
    const device::Queue queue = queue_for_slots(picked_.size());
    if (followed_buffer_.bytes() < picked_.size() * sizeof(InstrumentForce))
        followed_buffer_ = device::Buffer(context_, 2 * picked_.size() * sizeof(InstrumentForce));
    params_.follow = 1;
    launch(queue, followed_buffer_);  // nothing of it is read: none touches, and the trial's records may be asked for a tangent
    params_.follow = 0;
    context_.finish(queue);
}

}  // namespace seldinger
