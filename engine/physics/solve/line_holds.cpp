// Holds of instruments that share a centreline: place, force, state.
#include "solve/line_holds.h"

#include "core/state_walk.h"
#include "rod/pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

constexpr double stiffness_share = 10;   // K, of an edge's EA/l
constexpr double least_share = 0.005;    // of l/B: what a clamp in an edge's middle gives; as stiff as a base edge just born
constexpr double miss_allowed = 1e-7;    // of an edge's length
constexpr double number_rounding = std::numeric_limits<double>::epsilon();

/// Adds to the rows from `row` and the columns from `column`.
template <class Matrix>
void add_block(Matrix& to, int row, int column, const Mat3& m)
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) to[row + i][column + j] += m(i, j);
}

Vec3 place_in(const TrialState& trial, int at) { return {trial.x[at], trial.y[at], trial.z[at]}; }

double mean_edge(const RodView& line) { return line.material_s[line.n - 1] / (line.n - 1); }

double middle(const RodView& line, int edge) { return 0.5 * (line.material_s[edge] + line.material_s[edge + 1]); }

/// Angle about `tangent` from a held director, carried there, to the edge's d1.
double reference_angle(const WireConstraints::LineHold& hold, const Vec3& tangent, const Vec3& d1)
{
    const double chi = one_plus_cos(hold.tangent, tangent);
    return signed_angle(parallel_transport(hold.director, hold.tangent, tangent, chi), d1, tangent);
}

/// c of the stretch between the middles, (1 - w) w l/B and its derivative by the place; at least a fraction of l/B.
void set_compliance(double w, double length, double stiffness, double& c, double& rate)
{
    const double share = w * (1 - w);
    c = std::max(share, least_share) * length / stiffness;
    rate = share > least_share ? (1 - 2 * w) / stiffness : 0;
}

/// The same where the wire ends between the place and the middle hubwards of it, so far away.
void set_end_compliance(double distance, double length, double stiffness, double& c, double& rate)
{
    c = std::max(distance, least_share * length) / stiffness;
    rate = distance > least_share * length ? -1 / stiffness : 0;
}

}  // namespace

LineHolds::LineHolds(RodArrays& rods, const std::vector<WireConstraints>& constraints)
    : rods_(rods), constraints_(constraints), wires_(static_cast<std::size_t>(rods.wire_count()))
{
    traits_.follows_spins = traits_.may_jump = false;  // spins of a common centreline are never left out
}

void LineHolds::add(const CoaxialGroup& group, std::span<const int> count)
{
    for (int k = 0; k < group.count(); ++k) {
        HeldWire& held = wires_[static_cast<std::size_t>(group.wires[k])];
        held.group = &group;
        held.member = k;
        held.memory.resize(static_cast<std::size_t>(count[k]));
        held.active.reserve(held.memory.size());
    }
}

// ---- start of a step ----------------------------------------------------------------------------------------------------------

void LineHolds::prepare(RodArrays& /*rods*/, std::span<const std::uint8_t> live)
{
    for (std::size_t w = 0; w < wires_.size(); ++w) {
        HeldWire& held = wires_[w];
        const auto& holds = constraints_[w].line_holds;
        if (held.memory.empty() || (!live[w] && !holds.empty())) continue;  // (not in this sub-step: as its own has left it)
        held.active.clear();
        for (const auto& hold : holds) held.active.push_back(place(held, static_cast<int>(w), hold));
    }
}

LineHolds::Active LineHolds::place(const HeldWire& held, int wire, const WireConstraints::LineHold& hold)
{
    const RodView line = rods_.view(held.group->line());
    const int last = line.n - 1;
    Active active;
    active.hold = hold;
    const auto above =
        std::upper_bound(line.material_s.begin(), line.material_s.begin() + line.n, hold.s) - line.material_s.begin();
    active.edge = coaxial_edge_of(held.group->rod, line, hold.s, std::clamp(static_cast<int>(above) - 1, 0, last - 1));
    active.bary = (hold.s - line.material_s[active.edge]) / line.rest_length[active.edge];
    active.stiffness = stiffness_share * line.stretch_stiffness[active.edge] / mean_edge(line);
    const int cell = hold.s < middle(line, active.edge) ? active.edge : active.edge + 1;
    active.node = std::max(cell - 1, 0);
    if (cell > 0) active.side[0] = {cell - 1, 0, 1, 0};
    active.side[1] = {cell, cell - active.node, 1, 0};
    set_springs(held, line, active);
    if (hold.spin) find_angles(held, wire, active);
    const Memory& memory = held.memory[static_cast<std::size_t>(hold.hold)];
    if (hold.position) active.multiplier = memory.force;
    return active;
}

void LineHolds::set_springs(const HeldWire& held, const RodView& line, Active& active) const
{
    const int cell = active.side[1].edge;
    const double s = active.hold.s, from = cell > 0 ? middle(line, cell - 1) : line.material_s[0];
    const double to = cell < line.n - 1 ? middle(line, cell) : line.material_s[cell];
    const CoaxialInstrument& own = held.group->rod.instrument[held.member];
    const double twist_stiffness = own.spec->at(std::clamp(s + own.offset, 0.0, own.spec->length)).twist_stiffness;
    const double bend_stiffness = line.bend_stiffness[cell];
    active.length = active.bend_length = to - from;
    active.ends = cell == 0;
    if (cell == 0) {
        set_end_compliance(to - s, 2 * active.length, bend_stiffness, active.bend, active.bend_rate);
        set_end_compliance(to - s, 2 * active.length, twist_stiffness, active.twist, active.twist_rate);
        return;
    }
    const double w = (s - from) / active.length;
    active.side[0].weight = 1 - w;
    active.side[1].weight = w;
    active.spin_weight[0] = 1 - w;
    active.spin_weight[1] = w;
    const CoaxialBend bend = coaxial_bend(held.group->rod, held.member, from, s, to);
    if (bend.even) set_compliance(w, active.length, bend_stiffness, active.bend, active.bend_rate);
    else set_uneven(bend, active);
    set_compliance(w, active.length, twist_stiffness, active.twist, active.twist_rate);
}

/// By what bends on either side, a and b: w = a/(a + b), c = a b/(a + b).
void LineHolds::set_uneven(const CoaxialBend& bend, Active& active)
{
    const double a = bend.before, b = bend.after, all = a + b, least = least_share * active.length * bend.least;
    active.side[0].weight = b / all;
    active.side[1].weight = a / all;
    active.bend_length = all * all / (b * bend.before_rate - a * bend.after_rate);
    active.bend = std::max(a * b / all, least);
    active.bend_rate = a * b / all > least ? (b * b * bend.before_rate + a * a * bend.after_rate) / (all * all) : 0;
}

/// Reference angles for which the instrument is twisted relative to its hold by at most half a turn at the start of the step.
void LineHolds::find_angles(const HeldWire& held, int wire, Active& active)
{
    const RodView line = rods_.view(held.group->line()), own = rods_.view(wire);
    const CoaxialInstrument& instrument = held.group->rod.instrument[held.member];
    const int cell = active.side[1].edge;
    if (cell > 0 &&
        -instrument.offset > middle(line, cell - 1)) {  // its tip is in this cell: nothing of it reaches the middle before
        active.ends = true;
        active.spin_weight[0] = 0;
        active.spin_weight[1] = 1;
        const double to = cell < line.n - 1 ? middle(line, cell) : line.material_s[cell];
        const double stiffness = instrument.spec->at(std::max(active.hold.s + instrument.offset, 0.0)).twist_stiffness;
        set_end_compliance(to - active.hold.s, active.length, stiffness, active.twist, active.twist_rate);
    }
    const double reference = cell == line.n - 1 ? line.clamp_twist_a[cell] : line.ref_twist[cell];
    const double twist = !active.ends ? own.theta[cell] - own.theta[cell - 1] + reference : 0.0;
    const Memory& memory = held.memory[static_cast<std::size_t>(active.hold.hold)];
    const double turned = memory.held ? memory.turned : active.hold.turned;
    for (int k = active.ends ? 1 : 0; k < 2; ++k) {
        Side& side = active.side[k];
        const bool sleeve = side.edge == line.n - 1;
        const Vec3 tangent = sleeve ? held.group->base.tangent : line.tangent(side.edge);
        const Vec3 d1 = sleeve ? held.group->base.director : line.ref_d1(side.edge);
        const double off = k == 0 ? -active.spin_weight[1] * twist : active.spin_weight[0] * twist;
        side.near_angle = unwrap(reference_angle(active.hold, tangent, d1), turned - own.theta[side.edge] + off);
    }
}

// ---- at a trial ---------------------------------------------------------------------------------------------------------------

LineHolds::EdgeState LineHolds::edge_state(const HeldWire& held, const TrialState& trial, int edge)
{
    const RodView line = rods_.view(held.group->line());
    if (edge < 0) return {};
    if (edge == line.n - 1) return {held.group->base.tangent, held.group->base.director, 0};
    const int at = rods_.node_begin(held.group->line()) + edge;
    const Vec3 along = place_in(trial, at + 1) - place_in(trial, at);
    const double inverse = 1 / along.norm();
    const Vec3 tangent = inverse * along, from = line.tangent(edge);
    return {tangent, parallel_transport(line.ref_d1(edge), from, tangent, one_plus_cos(from, tangent)), inverse};
}

void LineHolds::evaluate(const TermTrial& trial)
{
    for (std::size_t w = 0; w < wires_.size(); ++w)
        for (Active& hold : wires_[w].active)
            if (trial.active[w]) evaluate(wires_[w], static_cast<int>(w), trial.at, hold);
}

void LineHolds::evaluate(const HeldWire& held, int wire, const TrialState& trial, Active& active)
{
    const RodView line = rods_.view(held.group->line()), own = rods_.view(wire);
    const int first_node = rods_.node_begin(held.group->line());
    active.gradient = {};
    active.hessian = {};
    active.along = 0;
    const EdgeState edges[2] = {edge_state(held, trial, active.side[0].edge), edge_state(held, trial, active.side[1].edge)};
    if (active.hold.position) add_position(line, trial, first_node, active);
    if (active.hold.direction) add_direction(edges, active);
    if (active.hold.spin) add_spin(edges, trial, rods_.node_begin(wire), active);

    active.work = 0;
    for (int p = 0; p < nodes && active.node + p < line.n; ++p) {
        const Vec3 moved = place_in(trial, first_node + active.node + p) - line.pos(active.node + p);
        active.work -= Vec3(&active.gradient[3 * p]).dot(moved);
    }
    for (int k = 0; k < 2; ++k) {
        const int edge = active.side[k].edge;
        if (active.gradient[3 * nodes + k] == 0 || (edge == line.n - 1 && !(held.group->base.behind[held.member] > 0)))
            continue;  // the hand's
        active.work -= active.gradient[3 * nodes + k] * (trial.theta[rods_.node_begin(wire) + edge] - own.theta[edge]);
    }
}

void LineHolds::add_position(const RodView& line, const TrialState& trial, int begin, Active& active)
{
    const Vec3 a = place_in(trial, begin + active.edge), b = place_in(trial, begin + active.edge + 1);
    const double weight[2] = {1 - active.bary, active.bary};
    active.miss = active.hold.at - (weight[0] * a + weight[1] * b);
    active.force = active.multiplier + active.stiffness * active.miss;
    const int first = 3 * (active.edge - active.node);
    for (int p = 0; p < 2; ++p) {
        add_to(&active.gradient[first + 3 * p], -(weight[p] * active.force));
        for (int q = 0; q < 2; ++q)
            for (int c = 0; c < 3; ++c)
                active.hessian[first + 3 * p + c][first + 3 * q + c] += active.stiffness * weight[p] * weight[q];
    }
    active.along += active.force.dot(a - b) / line.rest_length[active.edge];
}

// U = |g|^2/(2 c), g = t_c - sum w_j t_j; with P = 1 - t t^T
//     dU/de_j = -w_j P_j g/(c |e_j|)
//     d2U/de_j de_k = w_j w_k P_j P_k/(c |e_j||e_k|), and for j = k: + w_j (P g t^T + t g^T P + (g.t) P)/(c |e|^2)
void LineHolds::add_direction(const EdgeState* edges, Active& active)
{
    Vec3 off = active.hold.tangent, change = Vec3::Zero();
    for (int k = 0; k < 2; ++k) {
        const Side& side = active.side[k];
        if (side.edge < 0) continue;
        off -= side.weight * edges[k].tangent;
        change += (k == 0 ? -1.0 : 1.0) * edges[k].tangent;
    }
    if (active.side[0].edge < 0) change.setZero();  // the tip's straight half edge
    const double inv = 1 / active.bend;
    const auto add = [&](int j, int k, const Mat3& m) {
        const int from = 3 * active.side[j].first, to = 3 * active.side[k].first;
        for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q) add_block(active.hessian, from + 3 * p, to + 3 * q, (p == q ? 1 : -1) * m);
    };
    Mat3 normal[2];
    for (int k = 0; k < 2; ++k)
        normal[k] = edges[k].inverse * (Mat3::Identity() - outer(edges[k].tangent, edges[k].tangent));
    for (int j = 0; j < 2; ++j) {
        const Side& side = active.side[j];
        if (side.edge < 0 || edges[j].inverse == 0) continue;
        const Vec3 turn = normal[j] * off, &t = edges[j].tangent;
        const Vec3 slope = (-side.weight * inv) * turn;
        add_to(&active.gradient[3 * side.first], -slope);
        add_to(&active.gradient[3 * side.first + 3], slope);
        add(j, j, (side.weight * inv * edges[j].inverse) * Mat3(both(turn, t) + off.dot(t) * normal[j]));
        for (int k = 0; k < 2; ++k)
            if (active.side[k].edge >= 0 && edges[k].inverse != 0)
                add(j, k, (side.weight * active.side[k].weight * inv) * Mat3(normal[j] * normal[k]));
    }
    active.along += -inv * off.dot(change) / active.bend_length - 0.5 * inv * inv * off.squaredNorm() * active.bend_rate;
}

// psi_j = theta_j + m_j - turned, m_j the reference angle: d m = kb.de/(2 |e|), kb that of clamp and edge (add_twist() of
// rod/pair.h)
void LineHolds::add_spin(const EdgeState* edges, const TrialState& trial, int begin, Active& active) const
{
    double psi = 0, change = 0;
    Vector slope{};
    PairTerms curved[2];
    const int first = active.ends ? 1 : 0;
    for (int k = first; k < 2; ++k) {
        const Side& side = active.side[k];
        const double weight = active.spin_weight[k];
        const double angle = unwrap(reference_angle(active.hold, edges[k].tangent, edges[k].d1), side.near_angle);
        const double off = trial.theta[begin + side.edge] + angle - active.hold.turned;
        psi += weight * off;
        change += (k == 0 ? -1.0 : 1.0) * off;
        Pair pair;
        pair.te = active.hold.tangent;
        pair.tf = edges[k].tangent;
        pair.inv_f = edges[k].inverse;
        pair.chi = one_plus_cos(pair.te, pair.tf);
        pair.kb = (2 / pair.chi) * pair.te.cross(pair.tf);
        const Vec3 turn = (0.5 * weight * pair.inv_f) * pair.kb;
        slope[3 * nodes + k] += weight;
        if (pair.inv_f == 0) continue;
        add_to(&slope[3 * side.first], -turn);
        add_to(&slope[3 * side.first + 3], turn);
        add_twist_curvature(pair, weight, curved[k]);
    }
    if (active.ends) change = 0;
    const double inv = 1 / active.twist, torque = inv * psi;
    for (int i = 0; i < unknowns; ++i) {
        active.gradient[i] += torque * slope[i];
        for (int j = 0; j < unknowns; ++j) active.hessian[i][j] += inv * slope[i] * slope[j];
    }
    for (int k = first; k < 2; ++k) {
        const int from = 3 * active.side[k].first;
        for (int p = 0; p < 2 && edges[k].inverse != 0; ++p)
            for (int q = 0; q < 2; ++q)
                add_block(active.hessian, from + 3 * p, from + 3 * q, (p == q ? torque : -torque) * curved[k].ff);
    }
    active.along += torque * change / active.length - 0.5 * torque * torque * active.twist_rate;
}

int LineHolds::unknown(const Active& active, int local)
{
    return local < 3 * nodes ? RodDofs::position(active.node + local / 3, local % 3)
                             : RodDofs::spin(active.side[local - 3 * nodes].edge);
}

void LineHolds::add(int wire, std::span<double> residual, BandRows* tangent, bool /*symmetric*/) const
{
    for (const Active& active : wires_[static_cast<std::size_t>(wire)].active)
        for (int i = 0; i < unknowns; ++i) {
            if (active.gradient[i] != 0) residual[unknown(active, i)] += active.gradient[i];
            for (int j = 0; tangent && j < unknowns; ++j)
                if (active.hessian[i][j] != 0) tangent->add(unknown(active, i), unknown(active, j), active.hessian[i][j]);
        }
}

TermAnswer LineHolds::answer(int wire, Ask what)
{
    TermAnswer answer;
    if (what == Ask::Trial) answer.rounding = answer.rounding_most = rounding(wire);
    if (what != Ask::Energies) return answer;
    for (const Active& active : wires_[static_cast<std::size_t>(wire)].active) {
        answer.energies.applied += active.work;
        answer.energies.applied_force += active.force;
    }
    return answer;
}

double LineHolds::rounding(int wire) const
{
    const HeldWire& line = wires_[static_cast<std::size_t>(wire)];
    if (!line.group || line.member != 0) return 0;
    double most = 0;
    for (const int w : line.group->wires)
        for (const Active& active : wires_[static_cast<std::size_t>(w)].active)
            if (active.hold.position) most += 8 * number_rounding * active.stiffness * active.hold.at.cwiseAbs().maxCoeff();
    return most;
}

bool LineHolds::refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again)
{
    bool any = false;
    for (std::size_t w = 0; w < wires_.size(); ++w) {
        if (!solved[w]) continue;
        for (Active& active : wires_[w].active) {
            const double allowed = miss_allowed * mean_edge(rods_.view(wires_[w].group->line()));
            if (!active.hold.position || active.miss.norm() <= allowed) continue;
            active.multiplier = active.force;
            again[w] = 1;
            any = true;
        }
    }
    return any;
}

// ---- the accepted state -------------------------------------------------------------------------------------------------------

void LineHolds::commit(std::span<const std::uint8_t> active)
{
    for (std::size_t w = 0; w < wires_.size(); ++w) {
        if (!active[w]) continue;
        for (Memory& memory : wires_[w].memory) memory.held = 0, memory.force.setZero();
        for (const Active& hold : wires_[w].active) {
            Memory& memory = wires_[w].memory[static_cast<std::size_t>(hold.hold.hold)];
            memory.held = 1;
            memory.force = hold.force;
            memory.turned = hold.hold.turned;
        }
    }
}

double LineHolds::along(int wire) const
{
    double sum = 0;
    for (const Active& active : wires_[static_cast<std::size_t>(wire)].active) sum += active.along;
    return sum;
}

void LineHolds::walk_state(StateWalk& walk, int wire)
{
    for (Memory& memory : wires_[static_cast<std::size_t>(wire)].memory) {
        walk.numbers({"a hold's force", "N", "accept"}, memory.force);
        walk({"a hold's angle", "rad", "accept", -1e9, 1e9}, memory.turned);
        walk({"a hold's flag", "", "accept", 0, 1}, memory.held);
    }
}

}  // namespace seldinger
