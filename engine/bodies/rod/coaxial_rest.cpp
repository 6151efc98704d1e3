// Integrals of instruments that share a centreline, over cells and edges, and how they change when an instrument is pushed.
#include "core/check.h"
#include "rod/coaxial.h"

#include <algorithm>
#include <numbers>

namespace seldinger {

CoaxialRod::CoaxialRod(int nodes, int instrument_count) : instruments(instrument_count)
{
    SEL_ASSERT(instruments >= 1 && instruments <= most_coaxial);
    const auto size = static_cast<std::size_t>(nodes);
    cells.resize(size);
    stretch_covered.resize(size);
    stretch_compliance.resize(size);
    for (int k = 0; k < instruments; ++k) {
        theta[k].resize(size);
        spin_inertia[k].resize(size);
    }
}

void CoaxialCell::add(std::span<const WireSection* const> section, double ds)
{
    const int count = static_cast<int>(section.size());
    const auto natural = [&](int k) { return Complex(section[k]->rest_curvature[0], section[k]->rest_curvature[1]); };
    double bend = 0;
    for (int k = 0; k < count; ++k) {
        if (!section[k]) continue;
        bend += section[k]->bend_stiffness;
        twist_covered[k] += ds;
        twist_compliance[k] += ds / section[k]->twist_stiffness;
    }
    if (bend == 0) return;
    covered += ds;
    compliance += ds / bend;
    for (int l = 0; l < count; ++l) {
        if (!section[l]) continue;
        rest[l] += (section[l]->bend_stiffness / bend * ds) * natural(l);
        for (int k = 0; k < l; ++k) {
            if (!section[k]) continue;
            const double both = section[k]->bend_stiffness * section[l]->bend_stiffness / bend * ds;
            couple[coaxial_pair(k, l)] += both * std::conj(natural(k)) * natural(l);
            forced += 0.5 * both * (std::norm(natural(k)) + std::norm(natural(l)));
        }
    }
}

namespace {

/// Material of instrument k at centreline coordinate s, null where it is not.
const WireSection* section_at(const CoaxialInstrument& instrument, double s)
{
    const double own = s + instrument.offset;
    return own >= 0 && own <= instrument.spec->length ? &instrument.spec->at(own) : nullptr;
}

/// Cuts [begin, end] at s, if that is inside.
void cut_at(std::vector<CoaxialPiece>& pieces, double s)
{
    if (!(s > pieces.front().begin && s < pieces.back().end)) return;
    const auto after = std::ranges::lower_bound(pieces, s, {}, &CoaxialPiece::end);
    if (s <= after->begin || s >= after->end) return;
    CoaxialPiece first = *after;
    first.end = after->begin = s;
    pieces.insert(after, first);
}

void find_pieces(CoaxialRod& rod, const RodView& line)
{
    rod.pieces.clear();
    rod.pieces.push_back({line.material_s[0], line.material_s[line.n - 1], {}});
    for (int k = 0; k < rod.instruments; ++k) {
        const CoaxialInstrument& instrument = rod.instrument[k];
        cut_at(rod.pieces, -instrument.offset);
        cut_at(rod.pieces, instrument.spec->length - instrument.offset);
        instrument.spec->for_each_end([&](double end) { cut_at(rod.pieces, end - instrument.offset); });
    }
    for (CoaxialPiece& piece : rod.pieces)
        for (int k = 0; k < rod.instruments; ++k)
            piece.section[k] = section_at(rod.instrument[k], 0.5 * (piece.begin + piece.end));
}

/// Calls visit(piece, length) for each part of [begin, end], which comes tipwards of all that is asked for later: `at` remembers
/// where.
template <class Visit>
void for_each_part(const std::vector<CoaxialPiece>& pieces, double begin, double end, std::size_t& at, Visit visit)
{
    while (at + 1 < pieces.size() && pieces[at].end <= begin) ++at;
    for (double from = begin; from < end; ++at) {
        const bool last = at + 1 == pieces.size() || pieces[at].end >= end;
        const double to = last ? end : pieces[at].end;
        visit(pieces[at], to - from);
        if (last) return;
        from = to;
    }
}

double stretch_stiffness(const CoaxialPiece& piece)
{
    double sum = 0;
    for (const WireSection* section : piece.section) sum += section ? section->stretch_stiffness : 0;
    return sum;
}

void prepare_edge(CoaxialRod& rod, const RodView& line, int j, std::size_t& at)
{
    double covered = 0, compliance = 0, radius = 0;
    for (int k = 0; k < rod.instruments; ++k) rod.spin_inertia[k][j] = 0;
    const double begin = line.material_s[j], end = line.material_s[j + 1];
    SEL_ASSERT(end > begin);
    for_each_part(rod.pieces, begin, end, at, [&](const CoaxialPiece& piece, double length) {
        double widest = 0;
        for (int k = 0; k < rod.instruments; ++k) {
            if (!piece.section[k]) continue;
            const double r = piece.section[k]->radius;
            widest = std::max(widest, r);
            rod.spin_inertia[k][j] += piece.section[k]->density * (0.5 * std::numbers::pi * r * r * r * r) * length;
        }
        radius += widest * length;
        if (const double stiffness = stretch_stiffness(piece); stiffness > 0) {
            covered += length;
            compliance += length / stiffness;
        }
    });
    rod.stretch_covered[j] = covered;
    rod.stretch_compliance[j] = compliance;
    line.rest_length[j] = end - begin;
    line.radius[j] = radius / (end - begin);
    line.stretch_stiffness[j] = covered > 0 ? covered * covered / (compliance * (end - begin)) : 0;
}

void prepare_node(CoaxialRod& rod, const RodView& line, int i, std::size_t& at)
{
    const double s = line.material_s[i];
    const double begin = i > 0 ? 0.5 * (line.material_s[i - 1] + s) : s;
    const double end = i < line.n - 1 ? 0.5 * (s + line.material_s[i + 1]) : s;
    CoaxialCell cell;
    cell.length = end - begin;
    double mass = 0;
    for_each_part(rod.pieces, begin, end, at, [&](const CoaxialPiece& piece, double length) {
        cell.add({piece.section.data(), static_cast<std::size_t>(rod.instruments)}, length);
        for (const WireSection* section : piece.section)
            if (section) mass += section->density * std::numbers::pi * section->radius * section->radius * length;
    });
    line.mass[i] = mass;
    line.bend_stiffness[i] = cell.covered > 0 ? cell.covered * cell.covered / (cell.compliance * cell.length) : 0;
    line.twist_stiffness[i] = line.rest_kappa1[i] = line.rest_kappa2[i] = line.rest_twist[i] = 0;  // each instrument's own
    rod.cells[i] = cell;
}

}  // namespace

void prepare_coaxial(CoaxialRod& rod, const RodView& line)
{
    SEL_ASSERT(line.n >= 2 && line.n <= static_cast<int>(rod.cells.size()));
    find_pieces(rod, line);
    std::size_t at = 0;
    for (int j = 0; j < line.n - 1; ++j) prepare_edge(rod, line, j, at);
    at = 0;
    for (int i = 0; i < line.n; ++i) prepare_node(rod, line, i, at);
    std::fill(rod.cells.begin() + line.n, rod.cells.end(), CoaxialCell{});
}

double coaxial_stretch_stiffness(const CoaxialRod& rod, double begin, double end)
{
    double covered = 0, compliance = 0;
    std::size_t at = 0;
    for_each_part(rod.pieces, begin, end, at, [&](const CoaxialPiece& piece, double length) {
        const double stiffness = stretch_stiffness(piece);
        if (!(stiffness > 0)) return;
        covered += length;
        compliance += length / stiffness;
    });
    return covered > 0 ? covered * covered / (compliance * (end - begin)) : 0;
}

CoaxialBend coaxial_bend(const CoaxialRod& rod, int k, double from, double s, double to)
{
    CoaxialBend bend;
    const CoaxialPiece* last = nullptr;
    double place = from, soft_last = 0;
    std::size_t at = 0;
    for_each_part(rod.pieces, from, to, at, [&](const CoaxialPiece& piece, double length) {
        double stiffness = 0;
        for (const WireSection* section : piece.section) stiffness += section ? section->bend_stiffness : 0;
        const double soft = stiffness > 0 ? 1 / stiffness : 0, before = std::clamp(s - place, 0.0, length);
        bend.before += soft * before;
        bend.after += soft * (length - before);
        bend.least = last ? std::min(bend.least, soft) : soft;
        bend.even = !last;
        // sliding brings material in at one end and out at the other, and up to where another instrument begins or ends
        if (!last) bend.before_rate = soft;
        else if (last->section[k] == piece.section[k] && place != s)
            (place < s ? bend.before_rate : bend.after_rate) += soft - soft_last;
        last = &piece;
        soft_last = soft;
        place += length;
    });
    bend.after_rate -= soft_last;
    return bend;
}

int coaxial_edge_of(const CoaxialRod& rod, const RodView& line, double s, int edge)
{
    const auto middle = [&](int j) { return 0.5 * (line.material_s[j] + line.material_s[j + 1]); };
    const bool is_hubwards = s > middle(edge);
    const int other = is_hubwards ? edge + 1 : edge - 1;
    if (other < 0 || other > line.n - 2) return edge;
    const CoaxialCell& cell = rod.cells[is_hubwards ? edge + 1 : edge];
    CoaxialCell behind;  // between s and the other middle
    const double begin = std::min(s, middle(other)), end = std::max(s, middle(other));
    std::size_t at = 0;
    for_each_part(rod.pieces, begin, end, at, [&](const CoaxialPiece& piece, double length) {
        behind.add({piece.section.data(), static_cast<std::size_t>(rod.instruments)}, length);
    });
    return behind.compliance * cell.length < 0.5 * cell.compliance * (end - begin) ? other : edge;
}

double CoaxialHands::push(int k, int leader, int instruments) const
{
    if (k != leader) return offset_force[k];
    double force = line_force;
    for (int l = 0; l < instruments; ++l)
        if (l != leader) force -= offset_force[l];
    return force;
}

bool coaxial_idle(const CoaxialRod& rod, int j, int k)
{
    const auto& cells = rod.cells;
    return !(cells[j].twist_covered[k] > 0) && !(j + 1 < static_cast<int>(cells.size()) && cells[j + 1].twist_covered[k] > 0);
}

void follow_idle(CoaxialRod& rod, const RodView& line)
{
    for (int k = 0; k < rod.instruments; ++k) {
        int first = 0;
        while (first < line.n && coaxial_idle(rod, first, k)) ++first;
        if (first == line.n) continue;  // it is nowhere
        for (int j = first - 1; j >= 0; --j) rod.theta[k][j] = rod.theta[k][j + 1] + line.ref_twist[j + 1];
        int last = line.n - 2;
        while (last > 0 && coaxial_idle(rod, last, k)) --last;
        for (int j = last + 1; j < line.n - 1; ++j) rod.theta[k][j] = rod.theta[k][j - 1] - line.ref_twist[j];
    }
}

}  // namespace seldinger
