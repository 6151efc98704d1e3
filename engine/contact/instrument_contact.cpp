// Contact between instruments in the order in which a step calls it.

#include "contact/instrument_contact.h"

#include "contact/programs.h"
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

/// Calls f(wire, first, count) with the stretch of slots in which a wire's cells, of which of_wire tells the first, are listed.
template <class F>
void for_each_stretch(std::span<const std::uint32_t> listed, std::span<const int> of_wire, const F& f)
{
    auto from = listed.begin();
    for (std::size_t w = 0; w + 1 < of_wire.size(); ++w) {
        const auto end = static_cast<std::uint32_t>(SEL_INSTRUMENT_SLOTS * of_wire[w + 1]);
        const auto until = std::lower_bound(from, listed.end(), end);
        if (from != until) f(static_cast<int>(w), std::size_t{*from}, std::size_t{*(until - 1)} - *from + 1);
        from = until;
    }
}

/// Square of the distance of node i in two arrays of positions [m^2].
double apart_square(const std::vector<double>& now, const std::vector<double>& before, std::size_t i)
{
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double d = now[3 * i + c] - before[3 * i + c];
        sum += d * d;
    }
    return sum;
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
    : position(3 * (capacity + 2)),  // a rod of two nodes may have a third named, without weight
      material(capacity + 2),
      theta(capacity + 2),
      position_buffer(context, position.data(), position.size() * sizeof(double)),
      material_buffer(context, material.data(), material.size() * sizeof(double)),
      theta_buffer(context, theta.data(), theta.size() * sizeof(double))
{
}

void InstrumentContact::Nodes::upload(device::Context& context, device::Queue queue)
{
    context.write(queue, position_buffer, position.data(), position.size() * sizeof(double));
    context.write(queue, material_buffer, material.data(), material.size() * sizeof(double));
    context.write(queue, theta_buffer, theta.data(), theta.size() * sizeof(double));
}

void InstrumentContact::Nodes::upload_moved(device::Context& context, device::Queue queue, int begin, int end)
{
    const auto first = static_cast<std::size_t>(begin), count = static_cast<std::size_t>(end - begin);
    context.write(queue, position_buffer, position.data() + 3 * first, 3 * count * sizeof(double), 3 * first * sizeof(double));
    context.write(queue, theta_buffer, theta.data() + first, count * sizeof(double), first * sizeof(double));
}

InstrumentContact::InstrumentContact(device::Context& context, const InstrumentSetup& setup, RodArrays& rods)
    : context_(context),
      rods_(rods),
      cells_(setup),
      system_of_(setup.system_of),
      first_wire_(firsts(setup.system_of)),
      evaluate_(context, programs::instruments, "instruments_evaluate", device::Items::Branching),
      evaluate_self_(context, programs::instruments, "instruments_evaluate_self", device::Items::Branching),
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
    found_of_.assign(systems + 1, 0);
    picked_of_.assign(systems + 1, 0);
    cleared_.assign(systems, 0);
    searching_.assign(systems, 1);
    searched_position_ = nodes_.position;
    moved_.assign(nodes_.material.size(), 0);
    cleared_position_ = nodes_.position;
    written_.assign(systems, 0);
    with_states_.assign(setup.system_of.size(), 0);
    straight_.assign(setup.system_of.size(), 0);
    for (std::size_t w = 0; w < touching_.size(); ++w)
        touching_[w].reserve(static_cast<std::size_t>(cells_.of_wire[w + 1] - cells_.of_wire[w]));
    std::memset(no_states_.data(), 0, no_states_.size() * sizeof(InstrumentState));
    double least = cells_.surfaces.front().radius;
    for (const InstrumentSurface& surface : cells_.surfaces) least = std::min(least, surface.radius);
    params_.skin = least;
    params_.friction = static_cast<uint>(setup.contacts.front().friction);
    params_.smooth_speed = 1e-3;
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
    // in every step, stale or not: where the nearest place is looked for from decides its last bits, and a run that is resumed knows
    // nothing of searches before
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

// ---- searching --------------------------------------------------------------------------------------------------------------

void InstrumentContact::measure_rod(int wire)
{
    double square = 0;
    const auto begin = static_cast<std::size_t>(rods_.node_begin(wire));
    for (std::size_t i = begin; i + 1 < begin + static_cast<std::size_t>(rods_.node_count(wire)); ++i) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double d = nodes_.position[3 * i + 3 + c] - nodes_.position[3 * i + c];
            sum += d * d;
        }
        square = std::max(square, sum);
    }
    InstrumentRod& rod = cells_.rods[wire];
    rod.longest_edge = std::sqrt(square);
    const double share = (1 + (rod.widest + params_.skin) / cells_.narrowest[wire]) / SEL_SELF_APART;  // as search_cells() asks of a cell
    straight_[wire] = is_straight(spline(wire), 0, rod.inside, share);
    const auto pairs = std::span(cells_.pairs).subspan(rod.pair, rod.pairs);
    const bool others = std::any_of(pairs.begin(), pairs.end(), [](const InstrumentPair& pair) { return pair.touch != SEL_TOUCH_SELF; });
    if (!straight_[wire] || others) set_axes(wire);
}

SplineView InstrumentContact::spline(int wire) const
{
    const InstrumentRod& rod = cells_.rods[wire];
    return spline_of(instrument_nodes(nodes_.position.data(), nodes_.material.data(), nodes_.theta.data()), rod.node, rod.count);
}

/// Points of the cells' axes, which cells of the same rod are compared by.
void InstrumentContact::set_axes(int wire)
{
    const InstrumentRod& rod = cells_.rods[wire];
    const SplineView view = spline(wire);
    double* to = axes_.data() + 3 * SEL_AXIS_POINTS * std::size_t{rod.cell};
    uint edge = 0;
    const auto put = [&](double s, double* into) {
        edge = edge_near(view, s, edge);
        const SplinePlace at = spline_place(spline_at_edge(view, s, edge), view.count);
        store_vec(into, spline_sum(view, at.node, at.w));
    };
    for (uint k = 0; k < cells_inside(rod); ++k, to += 3 * SEL_AXIS_POINTS) {
        if (k == 0) put(0, to);
        else std::copy_n(to - 3, 3, to);  // where the cell before ends
        for (int i = 1; i < SEL_AXIS_POINTS; ++i) put(std::min(rod.spacing * (k + 0.5 * i), rod.inside), to + 3 * i);
    }
}

/// Whether nodes of a system have moved by half of the skin since its last search in this step.
bool InstrumentContact::search_is_stale(std::size_t system) const
{
    const double farthest = 0.25 * params_.skin * params_.skin;
    for (int w = first_wire_[system]; w < first_wire_[system + 1]; ++w) {
        const InstrumentRod& rod = cells_.rods[w];
        for (std::size_t i = rod.node; i < rod.node + rod.count; ++i)
            if (!(apart_square(nodes_.position, searched_position_, i) <= farthest)) return true;
    }
    return false;
}

/// Cells of a system that may be near to something: from the first to the last live one of instruments that touch any.
InstrumentContact::CellRange InstrumentContact::searched_cells(std::size_t system) const
{
    std::uint32_t first = 0, until = 0;
    for (int w = first_wire_[system]; w < first_wire_[system + 1]; ++w) {
        const InstrumentRod& rod = cells_.rods[w];
        if (rod.live == 0 || rod.pairs == 0) continue;
        if (until == 0) first = rod.cell;
        until = rod.cell + rod.live;
    }
    return {first, until - first};
}

/// Searches for the systems in searching_. The others, which may be done with this step, keep their neighbours and the traces of
/// their trials.
void InstrumentContact::search()
{
    for_each_item(static_cast<int>(searching_.size()), 1, [&](int s) {
        if (searching_[static_cast<std::size_t>(s)]) find_slots(static_cast<std::size_t>(s));
    });
    // slots that now represent other contacts still have the forces of earlier trials
    bool any = false;
    for_each_stretch(found_, cells_.of_wire, [&](int wire, std::size_t first, std::size_t count) {
        const auto system = static_cast<std::size_t>(system_of_[wire]);
        if (!searching_[system] || !written_[system]) return;
        if (!any) context_.enter(device::Queue::Inline);
        any = true;
        context_.write(device::Queue::Inline, states_, no_states_.data(), count * sizeof(InstrumentState), first * sizeof(InstrumentState));
    });
    uploaded_ = false;
    list_found();
}

/// Slots of a system's cells, and where its nodes are.
void InstrumentContact::find_slots(std::size_t system)
{
    const int begin = first_wire_[system], end = first_wire_[system + 1];
    for (int w = begin; w < end; ++w) measure_rod(w);
    const InstrumentNodes nodes = instrument_nodes(nodes_.position.data(), nodes_.material.data(), nodes_.theta.data());
    const InstrumentBodies bodies =
        instrument_bodies(cells_.rods.data(), cells_.pairs.data(), cells_.surfaces.data(), cells_.rod_of.data());
    const CellRange cells = searched_cells(system);
    for (std::uint32_t cell = cells.first; cell < cells.first + cells.count; ++cell) {
        const SlotList list = near_slots(cell, bodies, nodes, axes_.data(), straight_[cells_.rod_of[cell]], params_);
        std::copy_n(list.slots, SEL_INSTRUMENT_SLOTS, slots_host_.begin() + SEL_INSTRUMENT_SLOTS * std::ptrdiff_t{cell});
    }
    const auto first = 3 * static_cast<std::ptrdiff_t>(rods_.node_begin(begin));
    const auto until = 3 * static_cast<std::ptrdiff_t>(rods_.node_begin(end - 1) + rods_.node_count(end - 1));
    std::copy(nodes_.position.begin() + first, nodes_.position.begin() + until, searched_position_.begin() + first);
}

void InstrumentContact::list_found()
{
    std::swap(found_, found_before_);
    std::swap(touches_, touches_before_);
    std::swap(clear_, clear_before_);
    std::swap(near_nodes_, near_nodes_before_);
    found_.clear();
    touches_.clear();
    clear_.clear();
    near_nodes_.clear();
    for (std::size_t s = 0, before = 0, end; s < searching_.size(); ++s, before = end) {
        end = found_of_[s + 1];
        found_of_[s] = found_.size();
        if (!searching_[s]) {
            const auto keep = [&](auto& to, const auto& from) {
                to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(before), from.begin() + static_cast<std::ptrdiff_t>(end));
            };
            keep(found_, found_before_), keep(touches_, touches_before_), keep(clear_, clear_before_);
            keep(near_nodes_, near_nodes_before_);
            continue;
        }
        const CellRange cells = searched_cells(s);
        const std::uint32_t first = SEL_INSTRUMENT_SLOTS * cells.first, last = first + SEL_INSTRUMENT_SLOTS * cells.count;
        int near = 0;  // cells come in order, and so do the nodes that they lie on
        for (std::uint32_t k = first; k < last; ++k) {
            if (slots_host_[k].touch == SEL_TOUCH_NONE) continue;
            found_.push_back(k);
            near_nodes_.push_back(near_nodes(k, near));
            near = near_nodes_.back().a.first;
        }
        cleared_[s] = written_[s] = 0;
        touches_.resize(found_.size());
        clear_.resize(found_.size());
    }
    found_of_.back() = found_.size();
}

// ---- at a trial -------------------------------------------------------------------------------------------------------------

/// Those on which the curve lies between two material coordinates, and one more on both sides. @param near  where to begin
InstrumentContact::NodeRange InstrumentContact::nodes_between(const InstrumentRod& rod, double from, double until, int near) const
{
    const double* material = nodes_.material.data() + rod.node;
    const int last = static_cast<int>(rod.count) - 1;
    int first = std::clamp(near, 0, last);
    while (first > 0 && material[first] > from) --first;
    while (first < last && material[first + 1] <= from) ++first;
    int end = first;
    while (end < last && material[end] < until) ++end;
    const int begin = static_cast<int>(rod.node);
    return {begin + std::max(first - 1, 0), begin + std::min(end + 1, last) + 1};
}

/// Nodes of b within two cells and a skin of the slot's last point. A cell is no longer, and no trial moves it farther along b
/// without another search. Of the same rod: those of the slot's cells. @param near  a node of all that is before a's
InstrumentContact::NearNodes InstrumentContact::near_nodes(std::uint32_t slot, int near) const
{
    const InstrumentSlot& found = slots_host_[slot];
    const InstrumentPair& pair = cells_.pairs[found.pair];
    const InstrumentRod &a = cells_.rods[pair.a], &b = cells_.rods[pair.b];
    const double from = a.spacing * (slot / SEL_INSTRUMENT_SLOTS - a.cell);
    if (found.touch == SEL_TOUCH_SELF) {
        const NodeRange own = nodes_between(a, from, from + a.spacing, near - static_cast<int>(a.node));
        return {own, nodes_between(a, a.spacing * found.at, a.spacing * (found.at + found.cells), own.first - static_cast<int>(a.node))};
    }
    const int edge = std::clamp(static_cast<int>(found.at), 0, static_cast<int>(b.count) - 2);
    const double *ends = nodes_.material.data() + b.node + edge, margin = 2 * a.spacing + params_.skin;
    return {nodes_between(a, from, from + a.spacing, near - static_cast<int>(a.node)),
            nodes_between(b, ends[0] - margin, ends[1] + margin, edge)};
}

double InstrumentContact::most_moved(NodeRange nodes) const
{
    return nodes.first < nodes.end ? *std::max_element(moved_.begin() + nodes.first, moved_.begin() + nodes.end) : 0.0;
}

/// How far both sides of a slot have moved since its clearance was found.
double InstrumentContact::moved_together(std::size_t found) const
{
    return most_moved(near_nodes_[found].a) + most_moved(near_nodes_[found].b);
}

/// Neighbours in the systems that are evaluated. Most of it does not touch, and moves by micrometres from trial to trial. A slot is
/// not evaluated if the first trial of a step found it farther apart than the nodes on both sides have moved since. (This is known
/// in a lumen and of one rod with itself. The distance to b's curve grows by no more than the moves of its nearest point and of the
/// searching point.)
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
        for (std::size_t k = found_of_[s]; k < found_of_[s + 1]; ++k) {
            if (cleared_[s] && clear_[k] > 0 && moved_together(k) < clear_[k]) {
                // a trial before this one may have touched here: its record must not pass for the last one's, and follow() writes another
                if (touches_[k] == Touching) touches_[k] = Touched;
                continue;
            }
            picked_.push_back(found_[k]);
            place_.push_back(static_cast<std::uint32_t>(k));
        }
    }
    picked_of_.back() = picked_.size();
}

/// Movement of nodes since the first trial evaluated with these neighbours.
void InstrumentContact::measure_moves(int wire)
{
    const auto begin = static_cast<std::size_t>(rods_.node_begin(wire)), count = static_cast<std::size_t>(rods_.node_count(wire));
    for (std::size_t i = begin; i < begin + count; ++i)
        moved_[i] = std::sqrt(apart_square(nodes_.position, cleared_position_, i));
}

/// What the trial has told of touching; its first one also how far apart the others are.
void InstrumentContact::note_clear()
{
    for (std::size_t s = 0; s < cleared_.size(); ++s) {
        for (std::size_t k = picked_of_[s]; k < picked_of_[s + 1]; ++k) touches_[place_[k]] = forces_[k].count > 0 ? Touching : Apart;
        written_[s] = written_[s] || picked_of_[s] < picked_of_[s + 1];
        if (cleared_[s] || picked_of_[s] == picked_of_[s + 1]) continue;
        cleared_[s] = 1;
        for (std::size_t k = picked_of_[s]; k < picked_of_[s + 1]; ++k) clear_[place_[k]] = forces_[k].clear;
        for (int w = first_wire_[s]; w < first_wire_[s + 1]; ++w) {
            const auto begin = 3 * static_cast<std::ptrdiff_t>(rods_.node_begin(w)), count = 3 * static_cast<std::ptrdiff_t>(rods_.node_count(w));
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
    const auto evaluate = [&](device::Kernel& kernel, std::size_t items) {
        kernel.launch(queue, items, params_, list_buffer_, rods_buffer_, pairs_, surfaces_, rod_of_, slots_, nodes_, nodes_t0_,
                      states_t0_, states_, forces, points_buffer_);
    };
    const std::size_t block = context_.workgroup(device::Items::Branching) == 1 ? SEL_BLOCK : 1;  // of the kernel
    if (of_itself < picked_.size()) evaluate(evaluate_, (picked_.size() + block - 1) / block);
    if (of_itself > 0) evaluate(evaluate_self_, picked_.size());
}

/// Rods, nodes and slots of this step, for the first launch after a search.
void InstrumentContact::upload(device::Queue queue)
{
    context_.write(queue, rods_buffer_, cells_.rods.data(), cells_.rods.size() * sizeof(InstrumentRod));
    nodes_.upload(context_, queue);
    nodes_t0_.upload(context_, queue);
    const std::size_t first = found_.front(), count = found_.back() - first + 1;
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
            sums_[s].take(forces_[k], points_.data() + k * SEL_INSTRUMENT_POINTS, static_cast<int>(pair.a), static_cast<int>(pair.b), moves);
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
        for_each_stretch(found_, cells_.of_wire, [&](int wire, std::size_t first, std::size_t count) {
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
    for (std::size_t k = 0; k < found_.size(); ++k) {
        const uint wire = cells_.rod_of[found_[k] / SEL_INSTRUMENT_SLOTS];
        if (touches_[k] == Touching && active[wire]) touching_[wire].push_back(found_[k]);
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
        for (std::size_t k = found_of_[s]; k < found_of_[s + 1]; ++k) {
            const double followed = SEL_FOLLOWED * cells_.surfaces[found_[k] / SEL_INSTRUMENT_SLOTS].radius;
            const bool far_away = touches_[k] == Apart && clear_[k] - moved_together(k) > followed;
            if (touches_[k] != Touching && !far_away) picked_.push_back(found_[k]);
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
