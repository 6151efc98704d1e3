// Friction between instruments that share a centreline, in the order in which a step calls it.
#include "contact/rods/coaxial_friction.h"

#include "core/state_walk.h"
#include "math/banded_solver.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// Elastic slip of the surfaces before they slide [m]: 1 % of the instruments' thickness, as for asperities and jackets.
// Longer, hands feel a spring where there is a grip; shorter, Newton's equations get stiffer than torsion is from edge to edge.
constexpr double give = 1e-5;
// Pressed surfaces grip harder. k of the whole, for q of 0.1 to 10 N/m: 10 down to 0.1 micrometres [N/m^2].
constexpr double grip = 1e6;

}  // namespace

void CoaxialFriction::add(CoaxialGroup& group, const CoaxialFrictionSpec& spec, double cell)
{
    Group made;
    made.shared = &group;
    made.spec = spec;
    if (spec.pressed()) made.frames = coaxial_frames(rods_.capacity(group.line()));
    for (int inner = 1; inner < group.count(); ++inner)
        for (int outer = 0; outer < inner; ++outer) {  // next to each other where those between them do not reach
            Pair pair;
            pair.outer = outer;
            pair.inner = inner;
            pair.cell = cell;
            const double length = group.rod.instrument[outer].spec->length;
            const auto cells = static_cast<std::size_t>(std::ceil(length / cell)) + 1;
            pair.elastic.assign(cells, Vec2::Zero());
            pair.slid.assign(cells, 0);
            pair.pressing.assign(spec.pressed() ? cells : 0, 0.0);
            pair.off.assign(spec.pressed() ? cells : 0, LumenPress::Complex(0));
            made.pairs.push_back(std::move(pair));
        }
    for (int k = 0; k < group.count(); ++k)
        place_of_[static_cast<std::size_t>(group.wires[k])] = {static_cast<int>(groups_.size()), k};
    groups_.push_back(std::move(made));
}

// ---- where they overlap -----------------------------------------------------------------------------------------------------

void CoaxialFriction::prepare(RodArrays& /*rods*/, std::span<const std::uint8_t> live)
{
    for (Group& group : groups_)
        for (Pair& pair : group.pairs) {
            pair.parts.clear();
            pair.weights.clear();
            pair.along = pair.work = pair.stored = 0;
            if (live[group.shared->line()]) find_parts(group, pair);
        }
}

CoaxialFriction::Overlap CoaxialFriction::overlap_of(const Group& group, const Pair& pair)
{
    const auto& instrument = group.shared->rod.instrument;
    const RodView line = rods_.view(group.shared->line());
    Overlap lap;
    lap.offset = instrument[pair.outer].offset;
    const double inner_tip = -instrument[pair.inner].offset;
    lap.mouth = inner_tip < -lap.offset;
    lap.begin = std::max({line.material_s[0], -lap.offset, inner_tip});
    lap.end = std::min(line.material_s[line.n - 1], instrument[pair.outer].spec->length - lap.offset);
    for (int m = pair.outer + 1; m < pair.inner; ++m) lap.end = std::min(lap.end, -instrument[m].offset);
    return lap;
}

void CoaxialFriction::find_parts(Group& group, Pair& pair)
{
    const auto [begin, end, offset, mouth] = overlap_of(group, pair);
    if (!(end > begin)) return;
    int edge = 0;
    auto cell = static_cast<std::size_t>(std::max(0.0, std::floor((begin + offset) / pair.cell)));
    for (double from = begin; from < end; ++cell) {
        const double to = std::min(end, static_cast<double>(cell + 1) * pair.cell - offset);
        if (to > from) add_part(group, pair, cell, from, to, edge);
        from = std::max(from, to);
    }
}

/// @param edge  that the part before ended on
void CoaxialFriction::add_part(const Group& group, Pair& pair, std::size_t cell, double from, double to, int& edge)
{
    const RodView line = rods_.view(group.shared->line());
    const RodView outer = rods_.view(group.shared->wires[pair.outer]), inner = rods_.view(group.shared->wires[pair.inner]);
    const CoaxialInstrument& inside = group.shared->rod.instrument[pair.inner];
    while (edge + 2 < line.n && line.material_s[edge + 1] <= from) ++edge;
    Part part;
    part.cell = cell;
    part.at = 0.5 * (from + to);
    part.length = to - from;
    part.radius = inside.spec->at(0.5 * (from + to) + inside.offset).radius;
    part.first = pair.weights.size();
    part.edge = edge;
    for (int j = edge; j + 1 < line.n; ++j) {
        const bool last = j + 2 == line.n || line.material_s[j + 1] >= to;
        const double within = (last ? to : line.material_s[j + 1]) - std::max(from, line.material_s[j]);
        pair.weights.push_back(within / part.length);
        part.start += pair.weights.back() * (inner.theta[j] - outer.theta[j]);
        ++part.count;
        if (last) break;
    }
    pair.parts.push_back(part);
}

// ---- at a trial -------------------------------------------------------------------------------------------------------------

void CoaxialFriction::evaluate(const TermTrial& trial)
{
    for (Group& group : groups_) {
        if (!trial.active[group.shared->line()]) continue;
        for (Pair& pair : group.pairs) evaluate(group, pair, trial.at, trial.h > 0 ? 1 / trial.h : 0);
    }
}

void CoaxialFriction::evaluate(const Group& group, Pair& pair, const TrialState& trial, double rate)
{
    const double* outer = trial.theta.data() + rods_.node_begin(group.shared->wires[pair.outer]);
    const double* inner = trial.theta.data() + rods_.node_begin(group.shared->wires[pair.inner]);
    const double along = group.shared->fed[pair.inner] - group.shared->fed[pair.outer];
    const CoaxialFrictionSpec& spec = group.spec;
    SlipLawPerLength law{spec.drag, spec.drag / give + (spec.pressed() ? grip : 0.0), spec.viscous};
    pair.along = pair.work = pair.stored = 0;
    for (Part& part : pair.parts) {
        double angle = -part.start;
        for (int a = 0; a < part.count; ++a)
            angle += pair.weights[part.first + a] * (inner[part.edge + a] - outer[part.edge + a]);
        const Vec2 slip(along, part.radius * angle);
        if (spec.pressed())
            law.limit = spec.drag + (pair.slid[part.cell] ? spec.mu_sliding : spec.mu_static) * pair.pressing[part.cell];
        const SlipPerLength now = slip_per_length(law, pair.elastic[part.cell], slip, rate, stuck_);
        part.elastic = now.elastic;
        part.slides = now.slides;
        part.along = part.length * now.force.x();
        part.couple = part.length * part.radius * now.force.y();
        part.slope = part.length * part.radius * part.radius * now.slope;
        pair.along += part.along;
        pair.work += part.length * now.force.dot(slip);
        pair.stored += part.length * 0.5 * law.stiffness * now.elastic.squaredNorm();
    }
}

void CoaxialFriction::add(int wire, std::span<double> residual, BandRows* tangent, bool /*symmetric*/) const
{
    const Place at = place_of(wire);
    if (at.group < 0) return;
    for (const Pair& pair : groups_[static_cast<std::size_t>(at.group)].pairs) {
        if (pair.outer != at.member && pair.inner != at.member) continue;
        const double sign = pair.inner == at.member ? 1 : -1;
        for (const Part& part : pair.parts)
            for (int a = 0; a < part.count; ++a) {
                const double weight = pair.weights[part.first + a];
                const int row = RodDofs::spin(part.edge + a);
                residual[row] -= sign * weight * part.couple;
                for (int b = std::max(0, a - RodDofs::reach); tangent && b < part.count && b <= a + RodDofs::reach; ++b)
                    tangent->add(row, RodDofs::spin(part.edge + b), weight * pair.weights[part.first + b] * part.slope);
            }
    }
}

void CoaxialFriction::couple(const SystemUnknowns& system, std::span<double> /*residual*/, BandedSolver* tangent,
                             bool /*symmetric*/) const
{
    if (!tangent) return;
    for (const Group& group : groups_) {
        if (system.rod_of(group.shared->line()) < 0) continue;
        for (const Pair& pair : group.pairs) add_coupling(group, pair, system, *tangent);
    }
}

/// Between the two, and what of one wire lies beyond the band.
void CoaxialFriction::add_coupling(const Group& group, const Pair& pair, const SystemUnknowns& system, BandedSolver& tangent)
{
    const int outer = system.rod_of(group.shared->wires[pair.outer]), inner = system.rod_of(group.shared->wires[pair.inner]);
    for (const Part& part : pair.parts)
        for (int a = 0; a < part.count; ++a)
            for (int b = 0; b < part.count; ++b) {
                const double value = pair.weights[part.first + a] * pair.weights[part.first + b] * part.slope;
                const auto at = [&](int rod, int edge) { return system.map.spin(rod, part.edge + edge); };
                tangent.far.add(at(outer, a), at(inner, b), -value);
                tangent.far.add(at(inner, a), at(outer, b), -value);
                if (std::abs(a - b) <= RodDofs::reach) continue;
                tangent.far.add(at(outer, a), at(outer, b), value);
                tangent.far.add(at(inner, a), at(inner, b), value);
            }
}

// ---- readings ------------------------------------------------------------------------------------------------------------------

void CoaxialFriction::set_outside(int wire, double force)
{
    const Place at = place_of(wire);
    if (at.group >= 0) groups_[static_cast<std::size_t>(at.group)].outside[static_cast<std::size_t>(at.member)] = force;
}

double CoaxialFriction::along(int wire) const
{
    const Place at = place_of(wire);
    double sum = 0;
    if (at.group < 0) return sum;
    for (const Pair& pair : groups_[static_cast<std::size_t>(at.group)].pairs)
        sum += pair.inner == at.member ? pair.along : pair.outer == at.member ? -pair.along : 0.0;
    return sum;
}

/// The group led by a wire: its energies include all instruments.
const CoaxialFriction::Group* CoaxialFriction::led_by(int line) const
{
    const Place at = place_of(line);
    return at.group >= 0 && at.member == 0 ? &groups_[static_cast<std::size_t>(at.group)] : nullptr;
}

TermAnswer CoaxialFriction::answer(int wire, Ask what)
{
    TermAnswer answer;
    const Group* group = what == Ask::Energies ? led_by(wire) : nullptr;
    for (const Pair& pair : group ? std::span(group->pairs) : std::span<const Pair>()) {
        answer.energies.work.friction += pair.work;
        answer.energies.stored += pair.stored;
    }
    return answer;
}

// ---- the accepted state -----------------------------------------------------------------------------------------------------

void CoaxialFriction::commit(std::span<const std::uint8_t> active)
{
    for (Group& group : groups_) {
        if (!active[group.shared->line()]) continue;
        for (Pair& pair : group.pairs) {
            std::fill(pair.elastic.begin(), pair.elastic.end(), Vec2::Zero());
            std::fill(pair.slid.begin(), pair.slid.end(), std::uint8_t{0});
            for (const Part& part : pair.parts) {
                pair.elastic[part.cell] = part.elastic;
                pair.slid[part.cell] = part.slides;
            }
        }
        if (group.spec.pressed()) find_pressing(group);
    }
}

void CoaxialFriction::walk_state(StateWalk& walk, int wire)
{
    if (!led_by(wire)) return;
    const char* name = "friction between instruments";
    Group& group = groups_[static_cast<std::size_t>(place_of(wire).group)];
    const bool pressed = group.spec.pressed();
    if (pressed) walk({name, "N", "accept"}, std::span(group.outside));
    for (Pair& pair : group.pairs) {
        walk.numbers({name, "m", "accept", -1e4, 1e4}, std::span(pair.elastic));
        if (!pressed) continue;
        walk({name, "", "accept", 0, 1}, std::span(pair.slid));
        walk({name, "N/m", "accept", 0}, std::span(pair.pressing));
        walk.numbers({name, "", "accept", -1, 1}, std::span(pair.off));
    }
}

}  // namespace seldinger
