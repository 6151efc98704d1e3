// Forces between instruments that share a centreline, from their moments in the accepted state (rod/lumen_press.h).
#include "contact/rods/coaxial_friction.h"

#include "nodes/coaxial_nodes.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

using Complex = LumenPress::Complex;

// Newton steps in one time step: they start from the last solution, which is near.
constexpr int most_press_steps = 4;

/// Edge of the line that s lies on; at a node the one hubwards.
int edge_at(const RodView& line, double s)
{
    const auto nodes = line.material_s.first(line.n);
    const auto after = static_cast<int>(std::ranges::upper_bound(nodes, s) - nodes.begin());
    return std::clamp(after - 1, 0, line.n - 2);
}

/// The line's moment, linear between nodes.
Complex moment_at(const RodView& line, const CoaxialMoments& moments, int edge, double s)
{
    const double share = (s - line.material_s[edge]) / line.rest_length[edge];
    return (1 - share) * moments.moment[edge] + share * moments.moment[edge + 1];
}

}  // namespace

void CoaxialFriction::find_pressing(Group& group)
{
    const RodView line = rods_.view(group.shared->line());
    for (Pair& pair : group.pairs)
        if (pair.parts.empty()) {
            std::ranges::fill(pair.pressing, 0.0);
            std::ranges::fill(pair.off, Complex(0));
        }
    if (std::ranges::all_of(group.pairs, [](const Pair& pair) { return pair.parts.empty(); })) return;
    const CoaxialTrial now = accepted_trial(rods_, group.shared->wires);
    if (!update_coaxial(group.shared->rod, line, now, group.shared->base, group.frames)) return;  // what pressed goes on to
    measure_moments({group.shared->rod, line, now, group.shared->base, group.frames}, group.moments);
    for (Pair& pair : group.pairs)
        if (!pair.parts.empty()) find_pressing(group, now, pair);
}

void CoaxialFriction::find_pressing(const Group& group, const CoaxialTrial& now, Pair& pair)
{
    const Overlap lap = overlap_of(group, pair);
    const double d = pair.cell;
    // places are ends of cells: the mouth is one, an inner tip moves between them
    const int first = lap.mouth ? 0 : static_cast<int>(std::ceil((lap.begin + lap.offset) / d - 1e-9));
    const int last = static_cast<int>(std::floor((lap.end + lap.offset) / d + 1e-9));
    press_.places.clear();
    press_.off.clear();
    for (int i = first; i <= last; ++i) {
        press_.places.push_back(place_at(group, now, pair, lap, i * d - lap.offset));
        press_.off.push_back(pair.off[static_cast<std::size_t>(i)]);
    }
    set_lateral(group, pair, lap, first);
    press_.end = lap.mouth ? end_of(group, now, pair, lap) : LumenPress::End{};
    std::ranges::fill(pair.pressing, 0.0);
    std::ranges::fill(pair.off, Complex(0));
    if (last - first < 2) return;
    press_.solve(d, most_press_steps);
    for (int i = first; i <= last; ++i) {
        const double force = press_.force[static_cast<std::size_t>(i - first)];
        pair.off[static_cast<std::size_t>(i)] = press_.off[static_cast<std::size_t>(i - first)];
        // half to the cells on both sides; there is none before the first
        pair.pressing[static_cast<std::size_t>(i)] += (i == first ? 1.0 : 0.5) * force / d;
        if (i > first) pair.pressing[static_cast<std::size_t>(i - 1)] += 0.5 * force / d;
    }
}

/// Tension of the inner instruments, from the tip on: outside pulls and friction of all around; times the curvature that
/// place_at() left in `lateral`.
void CoaxialFriction::set_lateral(const Group& group, const Pair& pair, const Overlap& lap, int first)
{
    double outside = 0;
    for (int k = pair.inner; k < group.shared->count(); ++k) outside += group.outside[static_cast<std::size_t>(k)];
    tension_.assign(press_.places.size(), outside);
    for (const Pair& other : group.pairs) {
        if (other.inner < pair.inner || other.outer >= pair.inner) continue;  // both are inside, or both around
        std::size_t next = 0;
        double sum = 0;
        for (std::size_t i = 0; i < tension_.size(); ++i) {
            const double s = (first + static_cast<int>(i)) * pair.cell - lap.offset;
            for (; next < other.parts.size() && other.parts[next].at < s; ++next) sum += other.parts[next].along;
            tension_[i] += sum;
        }
    }
    for (std::size_t i = 0; i < tension_.size(); ++i) press_.places[i].lateral *= tension_[i];
}

/// Means over the half cells on both sides of s, as far as they are in the overlap; `lateral` is the curvature still.
LumenPress::Place CoaxialFriction::place_at(const Group& group, const CoaxialTrial& now, const Pair& pair, const Overlap& lap,
                                            double s)
{
    const CoaxialRod& rod = group.shared->rod;
    const RodView line = rods_.view(group.shared->line());
    const double from = std::max(lap.begin, s - 0.5 * pair.cell), to = std::min(lap.end, s + 0.5 * pair.cell);
    LumenPress::Place place;
    double length = 0;
    const auto first = std::ranges::lower_bound(rod.pieces, from, {}, &CoaxialPiece::end);
    for (auto piece = first; piece != rod.pieces.end() && piece->begin < to; ++piece) {
        const double begin = std::max(from, piece->begin), part = std::min(to, piece->end) - begin, middle = begin + 0.5 * part;
        if (!(part > 0)) continue;
        const int edge = edge_at(line, middle);
        const CoaxialShare in = share_in(rod, *piece, now, group.moments, edge, pair.inner, rod.instruments);
        place.stiffness += part * in.stiffness * in.others / (in.stiffness + in.others);
        const Complex moment = moment_at(line, group.moments, edge, middle);
        place.moment += part * in.of(moment);
        place.lateral += part * in.curvature(moment);
        length += part;
    }
    if (length > 0) {
        place.stiffness /= length;
        place.moment /= length;
        place.lateral /= length;
    }
    const CoaxialInstrument& inner = rod.instrument[pair.inner];
    place.clearance = rod.instrument[pair.outer].spec->lumen_radius - inner.spec->at(s + inner.offset).radius;
    return place;
}

/// The inner instruments' parts beyond the mouth.
LumenPress::End CoaxialFriction::end_of(const Group& group, const CoaxialTrial& now, const Pair& pair, const Overlap& lap)
{
    const CoaxialRod& rod = group.shared->rod;
    const RodView line = rods_.view(group.shared->line());
    const auto piece = std::ranges::lower_bound(rod.pieces, lap.begin, {}, &CoaxialPiece::end);
    if (piece == rod.pieces.end() || !(piece->begin < lap.begin)) return {};
    const int edge = edge_at(line, lap.begin);
    const CoaxialShare in = share_in(rod, *piece, now, group.moments, edge, pair.inner, rod.instruments);
    if (!(in.stiffness > 0)) return {};
    const Complex slope = (group.moments.moment[edge + 1] - group.moments.moment[edge]) / line.rest_length[edge];
    return {in.of(moment_at(line, group.moments, edge, lap.begin)), in.stiffness / (in.stiffness + in.others) * slope};
}

}  // namespace seldinger
