// Search of contact between instruments: which cells are near to each other, and how far they have moved since.
#include "contact/rods/instrument_contact.h"

#include "core/parallel.h"
#include "shared/instrument_near.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Square of the distance of node i in two arrays of positions [m^2].
double apart_square(std::span<const double> now, std::span<const double> before, std::size_t i)
{
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double d = now[3 * i + c] - before[3 * i + c];
        sum += d * d;
    }
    return sum;
}

}  // namespace

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
    // as search_cells() asks of a cell
    const double share = (1 + (rod.widest + params_.skin) / cells_.narrowest[wire]) / SEL_SELF_APART;
    straight_[wire] = is_straight(spline(wire), 0, rod.inside, share);
    const auto pairs = std::span(cells_.pairs).subspan(rod.pair, rod.pairs);
    const bool others =
        std::any_of(pairs.begin(), pairs.end(), [](const InstrumentPair& pair) { return pair.touch != SEL_TOUCH_SELF; });
    if (!straight_[wire] || others) set_axes(wire);
}

SplineView InstrumentContact::spline(int wire) const
{
    const InstrumentRod& rod = cells_.rods[wire];
    return spline_of(nodes_.view(), rod.node, rod.count);
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
    for_each_stretch(found_.slot, cells_.of_wire, [&](int wire, std::size_t first, std::size_t count) {
        const auto system = static_cast<std::size_t>(system_of_[wire]);
        if (!searching_[system] || !written_[system]) return;
        if (!any) context_.enter(device::Queue::Inline);
        any = true;
        context_.write(device::Queue::Inline, states_, no_states_.data(), count * sizeof(InstrumentState),
                       first * sizeof(InstrumentState));
    });
    uploaded_ = false;
    list_found();
}

/// Slots of a system's cells, and where its nodes are.
void InstrumentContact::find_slots(std::size_t system)
{
    const int begin = first_wire_[system], end = first_wire_[system + 1];
    for (int w = begin; w < end; ++w) measure_rod(w);
    const InstrumentNodes nodes = nodes_.view();
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

/// Those on which the curve lies between two material coordinates, and one more on both sides. @param near  where to begin
NodeRange InstrumentContact::nodes_between(const InstrumentRod& rod, double from, double until, int near) const
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

/// Nodes of b within two cells and a skin of the slot's last point. A slot's cell is shorter than this range, and no trial moves
/// it farther along b without another search. On the same rod: the nodes of the slot's cells. @param near  a node of all that is
/// before a's
NearNodes InstrumentContact::near_nodes(std::uint32_t slot, int near) const
{
    const InstrumentSlot& found = slots_host_[slot];
    const InstrumentPair& pair = cells_.pairs[found.pair];
    const InstrumentRod &a = cells_.rods[pair.a], &b = cells_.rods[pair.b];
    const double from = a.spacing * (slot / SEL_INSTRUMENT_SLOTS - a.cell);
    if (found.touch == SEL_TOUCH_SELF) {
        const NodeRange own = nodes_between(a, from, from + a.spacing, near - static_cast<int>(a.node));
        return {own, nodes_between(a, a.spacing * found.at, a.spacing * (found.at + found.cells),
                                   own.first - static_cast<int>(a.node))};
    }
    const int edge = std::clamp(static_cast<int>(found.at), 0, static_cast<int>(b.count) - 2);
    const double *ends = nodes_.material.data() + b.node + edge, margin = 2 * a.spacing + params_.skin;
    return {nodes_between(a, from, from + a.spacing, near - static_cast<int>(a.node)),
            nodes_between(b, ends[0] - margin, ends[1] + margin, edge)};
}

void InstrumentContact::list_found()
{
    std::swap(found_, found_before_);
    found_.clear_all();
    for (std::size_t s = 0; s < searching_.size(); ++s) {
        found_.of[s] = found_.slot.size();
        if (!searching_[s]) {
            found_.keep(found_before_, found_before_.of[s], found_before_.of[s + 1]);
            continue;
        }
        const CellRange cells = searched_cells(s);
        const std::uint32_t first = SEL_INSTRUMENT_SLOTS * cells.first, last = first + SEL_INSTRUMENT_SLOTS * cells.count;
        int near = 0;  // cells come in order, and so do the nodes that they lie on
        for (std::uint32_t k = first; k < last; ++k) {
            if (slots_host_[k].touch == SEL_TOUCH_NONE) continue;
            found_.add(k, near_nodes(k, near));
            near = found_.near.back().a.first;
        }
        cleared_[s] = written_[s] = 0;
    }
    found_.of.back() = found_.slot.size();
}

double InstrumentContact::most_moved(NodeRange nodes) const
{
    return nodes.first < nodes.end ? *std::max_element(moved_.begin() + nodes.first, moved_.begin() + nodes.end) : 0.0;
}

/// How far both sides of a slot have moved since its clearance was found.
double InstrumentContact::moved_together(std::size_t found) const
{
    return most_moved(found_.near[found].a) + most_moved(found_.near[found].b);
}

/// Movement of nodes since the first trial evaluated with these neighbours.
void InstrumentContact::measure_moves(int wire)
{
    const auto begin = static_cast<std::size_t>(rods_.node_begin(wire)), count = static_cast<std::size_t>(rods_.node_count(wire));
    for (std::size_t i = begin; i < begin + count; ++i)
        moved_[i] = std::sqrt(apart_square(nodes_.position, cleared_position_, i));
}

}  // namespace seldinger
