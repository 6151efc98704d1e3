// Reads the energies of a wire and the work done on it, sub-step by sub-step.

#include "world/energy_audit.h"

#include "world/merged.h"
#include "solve/line_holds.h"
#include "world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

namespace {

constexpr double floor_share = 1e-3;  // of the wire's own scale of energy, see energy_limits

/// Forces at the end of a step are those that its equations hold at; else means over the step are.
bool end_forces(const IntegratorSpec& spec) { return !spec.newmark && !spec.conserve && spec.scheme != Scheme::Explicit; }

double spin_energy(const RodView& rod)
{
    double twice = 0;
    for (int j = 0; j < rod.n - 1; ++j) twice += rod.spin_inertia[j] * rod.spin_rate[j] * rod.spin_rate[j];
    return 0.5 * twice;
}

double kinetic_energy(const RodView& rod)
{
    double twice = 0;
    for (int i = 0; i < rod.n; ++i) twice += rod.mass[i] * rod.vel(i).squaredNorm();
    for (int j = 0; j < rod.n - 1; ++j) twice += rod.spin_inertia[j] * rod.spin_rate[j] * rod.spin_rate[j];
    return 0.5 * twice;
}

/// Kinetic energy of a line, with the spins of its passengers.
double kinetic_energy(World::Impl& state, int wire)
{
    double energy = kinetic_energy(state.rods.view(wire));
    if (const MergedGroup* group = state.group_of(wire))
        for (const int w : group->wires().subspan(1)) energy += spin_energy(state.rods.view(w));
    return energy;
}

double mass_of(const RodView& rod)
{
    double mass = 0;
    for (int i = 0; i < rod.n; ++i) mass += rod.mass[i];
    return mass;
}

/// Mean over the step of a value that was `last` at the start, if that is known.
double mean(std::span<const double> last, std::size_t k, std::size_t count, double now)
{
    return last.size() == count ? 0.5 * (last[k] + now) : now;
}

double held_work(World::Impl& state, int wire)
{
    const EnergyAudit& audit = state.audits[wire];
    const auto& prescribed = state.constraints[wire].prescribed;
    double work = 0;
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        const int unknown = prescribed[k].first;
        const double now = state.solver->reaction(wire, unknown);
        const double force = state.setup.integrator.newmark ? mean(audit.held, k, prescribed.size(), now) : now;
        work += force * state.solver->displacement(wire, unknown);
    }
    return work;
}

/// How far the clamps are turned: where the next step's turning begins.
void note_turns(World::Impl& state, int wire)
{
    const std::vector<RodClamp>& clamps = state.constraints[wire].clamps;
    std::vector<double>& turns = state.audits[wire].turns;
    turns.resize(clamps.size());
    for (std::size_t c = 0; c < clamps.size(); ++c) turns[c] = clamps[c].turns;
}

/// Work of a group's hands, by the forces of its steps.
MergedWork work_of(World::Impl& state, const MergedGroup& group)
{
    MergedForces forces = merged_forces(state, group);
    const std::vector<double>& last = state.audits[group.line()].torque;
    for (std::size_t k = 0; k < forces.count && !end_forces(state.setup.integrator); ++k)
        forces.value[k] = mean(last, k, forces.count, forces.value[k]);
    return merged_work(state, group, forces);
}

double turning_work(World::Impl& state, int wire)
{
    const EnergyAudit& audit = state.audits[wire];
    const std::vector<RodClamp>& clamps = state.constraints[wire].clamps;
    if (audit.turns.size() != clamps.size()) return 0;
    double work = 0;
    for (std::size_t c = 0; c < clamps.size(); ++c) {
        if (clamps[c].turns == audit.turns[c]) continue;
        const double now = clamp_torque(state.rods.view(wire), clamps, state.solver->frames(wire), static_cast<int>(c));
        const double torque = end_forces(state.setup.integrator) ? now : mean(audit.torque, c, clamps.size(), now);
        work += torque * (clamps[c].turns - audit.turns[c]);
    }
    return work;
}

/// dE/d(fed length) at the end of the sub-step.
double force_of_feed(World::Impl& state, int wire, const Vec3& gravity)
{
    return feed_force(state.rods.view(wire), state.constraints[wire].clamps, state.solver->frames(wire), gravity);
}

double hand_work(World::Impl& state, int wire)
{
    if (!state.feeds[wire].on || state.feeds[wire].grown == 0) return 0;
    const EnergyAudit& audit = state.audits[wire];
    const double now = force_of_feed(state, wire, state.setup.gravity);
    const double force = end_forces(state.setup.integrator) || !audit.known ? now : 0.5 * (now + audit.hand_force);
    return force * state.feeds[wire].grown;
}

Vec3 move_of(const Solver& solver, int wire, int node)
{
    const auto along = [&](int c) { return solver.displacement(wire, RodDofs::position(node, c)); };
    return {along(0), along(1), along(2)};
}

Vec3 move_of(const Solver& solver, int wire, int edge, double bary)
{
    return (1 - bary) * move_of(solver, wire, edge) + bary * move_of(solver, wire, edge + 1);
}

double load_work(World::Impl& state, int wire)
{
    const Solver& solver = *state.solver;
    const RodView rod = state.rods.view(wire);
    double work = 0;
    for (const auto& load : state.constraints[wire].loads) {
        work += load.force.dot(move_of(solver, wire, load.edge, load.bary));
        if (load.moment.isZero()) continue;
        const Vec3 edge = rod.pos(load.edge + 1) - rod.pos(load.edge), t = edge.normalized();
        const Vec3 change = move_of(solver, wire, load.edge + 1) - move_of(solver, wire, load.edge);
        const MergedGroup* group = state.group_of(wire);
        const int spun = group ? group->wires()[load.member] : wire;
        work += load.moment.cross(t).dot(change) / edge.norm() +
                load.moment.dot(t) * solver.displacement(spun, RodDofs::spin(load.edge));
    }
    for (const auto& load : state.constraints[wire].carried) work += load.force.dot(move_of(solver, wire, load.edge, load.bary));
    for (const auto& spring : state.constraints[wire].springs) {
        const Vec3 move = move_of(solver, wire, spring.edge, spring.bary);
        Vec3 at = (1 - spring.bary) * rod.pos(spring.edge) + spring.bary * rod.pos(spring.edge + 1);
        if (!end_forces(state.setup.integrator)) at -= 0.5 * move;
        work += spring.stiffness * (spring.anchor - at).dot(move);
    }
    if (const MergedGroup* group = state.group_of(wire)) {
        for (const int w : group->wires()) work += state.line_holds ? state.line_holds->work(w) : 0.0;
        for (int k = 0; k < group->shared.count(); ++k)
            if (group->slid[k] != 0)
                work += axial_load(state, *group, k) * group->slid[k];  // what slides along the line goes on by that beside
    }
    return work;
}

/// Work of holds that change their speed within the step, which reactions at its ends do not show.
double unseen_work(World::Impl& state, int wire, double h)
{
    const EnergyAudit& audit = state.audits[wire];
    const auto& prescribed = state.constraints[wire].prescribed;
    if (end_forces(state.setup.integrator) || audit.held_speed.size() != prescribed.size()) return 0;
    double change = 0;
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        const double speed = state.solver->displacement(wire, prescribed[k].first) / h, before = audit.held_speed[k];
        change += std::abs(speed * speed - before * before);
    }
    return change == 0 ? 0 : mass_of(state.rods.view(wire)) * change;
}

/// The wire, and those that share its centreline.
template <class Visit>
void for_each_of_group(World::Impl& state, int wire, const Visit& visit)
{
    const MergedGroup* group = state.group_of(wire);
    if (!group) return visit(wire);
    for (const int w : group->wires()) visit(w);
}

WireEnergy energy_now(const EnergyAudit& audit)
{
    return {audit.kinetic, audit.elastic + audit.gravitational, audit.terms.stored};
}

void read_terms(World::Impl& state, int wire)
{
    TermEnergies& terms = state.audits[wire].terms = {};
    for_each_of_group(state, wire, [&](int w) { terms += state.terms.answer(w, Ask::Energies).energies; });
}

void read_energies(World::Impl& state, int wire)
{
    EnergyAudit& audit = state.audits[wire];
    audit.kinetic = kinetic_energy(state, wire);
    audit.elastic = state.solver->elastic_energy(wire);
    audit.gravitational = state.solver->potential_energy(wire);
    read_terms(state, wire);
}

/// Work of a sub-step on a wire, by its sources [J].
struct WorkDone {
    double hand = 0, turning = 0;  // feeding, clamps that turn
    double outside = 0;            // holds, loads, links
    double wall = 0;               // one that yields
    double feed = 0;               // of a common centreline: the elastic part of `hand`
    [[nodiscard]] double sum() const { return hand + turning + outside + wall; }
};

WorkDone work_done(World::Impl& state, int wire)
{
    WorkDone work;
    if (const MergedGroup* group = state.group_of(wire)) {
        const MergedWork hands = work_of(state, *group);
        work.hand = hands.hand;
        work.turning = hands.turning;
        work.feed = hands.feed;
    } else {
        work.hand = hand_work(state, wire);
        work.turning = turning_work(state, wire);
    }
    work.outside = held_work(state, wire) + load_work(state, wire);
    work.wall = state.audits[wire].terms.from_outside;
    return work;
}

/// The sub-step's share in the ledger.
void take_into_ledger(World::Impl& state, int wire, const WorkDone& work)
{
    EnergyAudit& audit = state.audits[wire];
    audit.next_ledger = audit.known ? audit.ledger : EnergyLedger{};
    if (!audit.known) return;
    EnergyLedger& ledger = audit.next_ledger;
    const double now = audit.kinetic + audit.elastic + audit.gravitational;
    const ContactWork& contact = audit.terms.work;
    ledger.hand += work.hand + work.turning;
    ledger.outside += work.outside;
    if (state.reports[wire].cut_short) ledger.outside += state.solver->residual_work(wire);  // a force from outside; the next step returns it
    ledger.remesh += audit.remeshed_now;
    ledger.material += audit.fed.carried - audit.remeshed_now;
    ledger.wire += now - audit.wire_then;
    ledger.friction -= contact.friction + contact.rolling;
    ledger.contact -= contact.normal;
    ledger.wall -= work.wall;
    const IntegratorSpec& integrator = state.setup.integrator;
    if (!end_forces(integrator) || integrator.scheme != Scheme::Newton) {
        ledger.scheme += ledger.open();
        return;
    }
    const StepLosses losses = state.solver->losses(wire);
    const double fed = state.group_of(wire)   ? work.feed
                       : state.feeds[wire].on ? force_of_feed(state, wire, Vec3::Zero()) * state.feeds[wire].grown
                                              : 0;
    const double elastic_then = audit.elastic_then + (state.remesh_energy[wire] - audit.remeshed);
    ledger.damping += losses.damping;
    ledger.scheme += losses.inertia + losses.strain_work + fed + work.turning - (audit.elastic - elastic_then);
}

}  // namespace

EnergyLimits energy_limits(const WireSpec& wire, const Vec3& gravity)
{
    constexpr int parts = 100;
    double mass = 0, stiffest = 0;
    for (int k = 0; k < parts; ++k) {
        const WireSection& section = wire.at((k + 0.5) / parts * wire.length);
        mass += section.density * std::numbers::pi * section.radius * section.radius * wire.length / parts;
        stiffest = std::max(stiffest, section.bend_stiffness);
    }
    EnergyLimits limits;
    limits.floor = floor_share * (mass * gravity.norm() * wire.length + stiffest / wire.length);
    return limits;
}

void audit_remeshing(World::Impl& state, int wire)
{
    EnergyAudit& audit = state.audits[wire];
    audit.fed = {};
    audit.remeshed_now = 0;
    if (!audit.known) return;
    const double moving = kinetic_energy(state, wire) + state.solver->potential_energy(wire);
    audit.remeshed_now = (moving - audit.moving) + (state.remesh_energy[wire] - audit.remeshed);
    audit.fed.carried = audit.remeshed_now;
}

FeedingAudit::FeedingAudit(World::Impl& state, int wire) : wire_(wire), inside_(state.feeds[wire].inside)
{
    const RodView rod = state.rods.view(wire);
    for (int k = 0; k < 2; ++k) mass_[k] = rod.mass[rod.n - 1 - k];
    inertia_ = rod.spin_inertia[rod.n - 2];
}

void FeedingAudit::after(World::Impl& state)
{
    EnergyAudit& audit = state.audits[wire_];
    const FeedState& feed = state.feeds[wire_];
    if (!inside_ || !feed.inside) {
        audit.known = false;
        return;
    }
    const RodView rod = state.rods.view(wire_);
    const int hub = rod.n - 1;
    EnergyInput& fed = audit.fed;
    const double spin = rod.spin_rate[hub - 1];
    fed.carried += 0.5 * (rod.spin_inertia[hub - 1] - inertia_) * spin * spin;
    for (int k = 0; k < 2; ++k) {
        const double more = rod.mass[hub - k] - mass_[k];
        fed.carried += more * (0.5 * rod.vel(hub - k).squaredNorm() - state.setup.gravity.dot(feed.point));
    }
    // the hub's half cell takes the feed's speed within the step; the cells before it show it only at the step's ends
    const double mass = end_forces(state.setup.integrator) ? 0.5 * rod.mass[hub] : mass_of(rod);
    fed.unseen = feed.speed == audit.speed ? 0 : mass * std::abs(feed.speed * feed.speed - audit.speed * audit.speed);
}

void begin_audit(World::Impl& state, int wire, bool placed)
{
    EnergyAudit& audit = state.audits[wire];
    if (placed) {
        const RodView rod = state.rods.view(wire);
        RodFrames frames(rod.n);
        audit.kinetic = kinetic_energy(state, wire);
        MergedGroup* group = state.group_of(wire);
        audit.elastic = group ? elastic_now(state, *group)
                              : seldinger::energy_now(rod, state.constraints[wire].clamps, frames);
        audit.gravitational = state.solver->potential_energy(wire);
        read_terms(state, wire);
    } else {
        read_energies(state, wire);
    }
    audit.balance.begin(energy_now(audit));
    audit.ledger = {};
    audit.wire_then = audit.kinetic + audit.elastic + audit.gravitational;
    audit.elastic_then = audit.elastic;
    audit.known = true;
    audit.moving = audit.kinetic + audit.gravitational;
    audit.remeshed = state.remesh_energy[wire];
    if (placed) note_turns(state, wire);
    else accept_energy(state, wire, 0);
}

bool energy_adds_up(World::Impl& state, int wire, double h)
{
    EnergyAudit& audit = state.audits[wire];
    read_energies(state, wire);
    EnergyInput input = audit.fed;
    const WorkDone work = work_done(state, wire);
    input.work += work.sum();
    take_into_ledger(state, wire, work);
    input.unseen += unseen_work(state, wire, h);
    if (state.setup.integrator.scheme == Scheme::Newton && !state.reports[wire].best_effort)
        for_each_of_group(state, wire, [&](int w) { input.work += state.solver->residual_work(w); });
    audit.next = audit.balance;
    if (audit.known) return audit.next.take_in(energy_now(audit), input, audit.limits);
    audit.next.begin_after(energy_now(audit), input);
    return true;
}

void accept_energy(World::Impl& state, int wire, double h)
{
    EnergyAudit& audit = state.audits[wire];
    if (h > 0) audit.balance = audit.next, audit.ledger = audit.next_ledger;
    audit.known = true;
    audit.wire_then = audit.kinetic + audit.elastic + audit.gravitational;
    audit.elastic_then = audit.elastic;
    audit.moving = audit.kinetic + audit.gravitational;
    audit.remeshed = state.remesh_energy[wire];
    const auto& prescribed = state.constraints[wire].prescribed;
    const std::vector<RodClamp>& clamps = state.constraints[wire].clamps;
    note_turns(state, wire);
    audit.speed = state.feeds[wire].speed;
    if (end_forces(state.setup.integrator)) return;
    audit.held.resize(prescribed.size());
    audit.held_speed.resize(prescribed.size());
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        audit.held[k] = state.solver->reaction(wire, prescribed[k].first);
        audit.held_speed[k] = h > 0 ? state.solver->displacement(wire, prescribed[k].first) / h : 0;
    }
    const RodView rod = state.rods.view(wire);
    if (const MergedGroup* group = state.group_of(wire)) {
        const MergedForces forces = merged_forces(state, *group);
        audit.torque.assign(forces.value.begin(), forces.value.begin() + static_cast<std::ptrdiff_t>(forces.count));
        return;
    }
    audit.torque.resize(clamps.size());
    for (std::size_t c = 0; c < clamps.size(); ++c)
        audit.torque[c] = clamps[c].spin ? clamp_torque(rod, clamps, state.solver->frames(wire), static_cast<int>(c)) : 0;
    if (state.feeds[wire].on) audit.hand_force = feed_force(rod, clamps, state.solver->frames(wire), state.setup.gravity);
}

}  // namespace seldinger
