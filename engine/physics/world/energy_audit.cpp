// Reads the energies of a wire and the work done on it, sub-step by sub-step.
#include "world/energy_audit.h"

#include "world/world_rod.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace seldinger {
namespace {

constexpr double floor_share = 1e-3;  // of the wire's own scale of energy, see energy_floor

/// Forces at the end of a step are those that its equations hold at; else means over the step are.
bool end_forces(const IntegratorSpec& spec)
{
    return !spec.newmark && !spec.conserve && spec.scheme != Scheme::Explicit && spec.scheme != Scheme::Static;
}

/// The work of holds takes means of their reactions at both ends.
bool mean_reactions(const IntegratorSpec& spec) { return spec.newmark || spec.scheme == Scheme::Static; }

double kinetic_energy(const WorldRod& rod)
{
    const RodView line = rod.view();
    double twice = 0, energy = 0;
    for (int i = 0; i < line.n; ++i) twice += line.mass[i] * line.vel(i).squaredNorm();
    for (const int w : rod.wires()) {
        const RodView own = rod.world().rod(w);
        for (int j = 0; j < line.n - 1; ++j) twice += own.spin_inertia[j] * own.spin_rate[j] * own.spin_rate[j];
        energy += 0.5 * std::exchange(twice, 0);
    }
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

double held_work(WorldData& world, int wire)
{
    const EnergyAudit& audit = world.audit(wire);
    const auto& prescribed = world.constraints(wire).prescribed;
    double work = 0;
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        const int unknown = prescribed[k].first;
        const double now = world.solver->reaction(wire, unknown);
        const double force = mean_reactions(world.setup.integrator) ? mean(audit.held, k, prescribed.size(), now) : now;
        work += force * world.solver->displacement(wire, unknown);
    }
    return work;
}

/// How far the clamps are turned: where the next step's turning begins.
void note_turns(WorldData& world, int wire)
{
    const std::vector<RodClamp>& clamps = world.constraints(wire).clamps;
    std::vector<double>& turns = world.audit(wire).turns;
    turns.resize(clamps.size());
    for (std::size_t c = 0; c < clamps.size(); ++c) turns[c] = clamps[c].turns;
}

/// Work of a group's hands, by the forces of its steps.
MergedWork work_of(WorldData& world, const MergedGroup& group)
{
    MergedForces forces = merged_forces(world, group);
    const std::vector<double>& last = world.audit(group.line()).torque;
    for (std::size_t k = 0; k < forces.count && !end_forces(world.setup.integrator); ++k)
        forces.value[k] = mean(last, k, forces.count, forces.value[k]);
    return merged_work(world, group, forces);
}

double turning_work(WorldData& world, int wire)
{
    const EnergyAudit& audit = world.audit(wire);
    const std::vector<RodClamp>& clamps = world.constraints(wire).clamps;
    if (audit.turns.size() != clamps.size()) return 0;
    double work = 0;
    for (std::size_t c = 0; c < clamps.size(); ++c) {
        if (clamps[c].turns == audit.turns[c]) continue;
        const double now = clamp_torque(world.rod(wire), clamps, world.solver->frames(wire), static_cast<int>(c));
        const double torque = end_forces(world.setup.integrator) ? now : mean(audit.torque, c, clamps.size(), now);
        work += torque * (clamps[c].turns - audit.turns[c]);
    }
    return work;
}

/// dE/d(fed length) at the end of the sub-step.
double force_of_feed(WorldData& world, int wire, const Vec3& gravity)
{
    return feed_force(world.rod(wire), world.setup.wires[wire].wire, world.constraints(wire).clamps, world.solver->frames(wire),
                      gravity);
}

double hand_work(WorldData& world, int wire)
{
    if (!world.feed(wire).on || world.feed(wire).grown == 0) return 0;
    const EnergyAudit& audit = world.audit(wire);
    const double now = force_of_feed(world, wire, world.setup.gravity);
    const double force = end_forces(world.setup.integrator) || !audit.known ? now : 0.5 * (now + audit.hand_force);
    return force * world.feed(wire).grown;
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

double load_work(const WorldRod& one)
{
    WorldData& world = one.world();
    const int wire = one.line();
    const Solver& solver = *world.solver;
    const RodView rod = one.view();
    double work = 0;
    for (const auto& load : world.constraints(wire).loads) {
        work += load.force.dot(move_of(solver, wire, load.edge, load.bary));
        if (load.moment.isZero()) continue;
        const Vec3 edge = rod.pos(load.edge + 1) - rod.pos(load.edge), t = edge.normalized();
        const Vec3 change = move_of(solver, wire, load.edge + 1) - move_of(solver, wire, load.edge);
        work += load.moment.cross(t).dot(change) / edge.norm() +
                load.moment.dot(t) * solver.displacement(one.wires()[load.member], RodDofs::spin(load.edge));
    }
    for (const auto& load : world.constraints(wire).carried) work += load.force.dot(move_of(solver, wire, load.edge, load.bary));
    for (const auto& spring : world.constraints(wire).springs) {
        const Vec3 move = move_of(solver, wire, spring.edge, spring.bary);
        Vec3 at = (1 - spring.bary) * rod.pos(spring.edge) + spring.bary * rod.pos(spring.edge + 1);
        if (!end_forces(world.setup.integrator)) at -= 0.5 * move;
        work += spring.stiffness * (spring.anchor - at).dot(move);
    }
    if (const MergedGroup* group = one.group()) {
        for (int k = 0; k < group->shared.count(); ++k)
            if (group->slid[k] != 0)
                work += axial_load(world, *group, k) * group->slid[k];  // what slides along the line goes on by that beside
    }
    return work;
}

/// Work of holds that change their speed within the step, which reactions at its ends do not show.
double unseen_work(WorldData& world, int wire, double h)
{
    const EnergyAudit& audit = world.audit(wire);
    const auto& prescribed = world.constraints(wire).prescribed;
    if (end_forces(world.setup.integrator) || audit.held_speed.size() != prescribed.size()) return 0;
    double change = 0;
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        const double speed = world.solver->displacement(wire, prescribed[k].first) / h, before = audit.held_speed[k];
        change += std::abs(speed * speed - before * before);
    }
    return change == 0 ? 0 : mass_of(world.rod(wire)) * change;
}

WireEnergy energy_now(const EnergyAudit& audit)
{
    return {audit.kinetic, audit.elastic + audit.gravitational, audit.terms.stored};
}

/// @param elastic  energy [J]
void read_energies(const WorldRod& rod, double elastic)
{
    WorldData& world = rod.world();
    EnergyAudit& audit = world.audit(rod.line());
    audit.kinetic = kinetic_energy(rod);
    audit.elastic = elastic;
    audit.gravitational = world.solver->potential_energy(rod.line());
    audit.terms = {};
    for (const int w : rod.wires()) audit.terms += world.forces.terms.answer(w, Ask::Energies).energies;
}

/// Work of a sub-step on a wire, by its sources [J].
struct WorkDone {
    double hand = 0, turning = 0;  // feeding, clamps that turn
    double outside = 0;            // holds, loads, links
    double wall = 0;               // an elastic one
    double forces = 0;             // given by the program
    double feed = 0;               // of a common centreline: the elastic part of `hand`
    [[nodiscard]] double sum() const { return hand + turning + outside + wall + forces; }
};

WorkDone work_done(const WorldRod& rod)
{
    WorldData& world = rod.world();
    const int wire = rod.line();
    WorkDone work;
    if (const MergedGroup* group = rod.group()) {
        const MergedWork hands = work_of(world, *group);
        work.hand = hands.hand;
        work.turning = hands.turning;
        work.feed = hands.feed;
    } else {
        work.hand = hand_work(world, wire);
        work.turning = turning_work(world, wire);
    }
    work.outside = held_work(world, wire) + load_work(rod) + world.audit(wire).terms.applied;
    work.wall = world.audit(wire).terms.from_outside;
    work.forces = world.audit(wire).terms.given;
    return work;
}

/// The sub-step's share in the ledger.
void take_into_ledger(WorldData& world, int wire, const WorkDone& work)
{
    EnergyAudit& audit = world.audit(wire);
    audit.next_ledger = audit.ledger;
    if (!audit.known) return;
    EnergyLedger& ledger = audit.next_ledger;
    const double now = audit.kinetic + audit.elastic + audit.gravitational;
    const ContactWork& contact = audit.terms.work;
    ledger.hand += work.hand + work.turning;
    ledger.outside += work.outside;
    ledger.forces += work.forces;
    if (world.work.reports[wire].cut_short)
        ledger.outside += world.solver->residual_work(wire);  // a force from outside; the next step returns it
    ledger.remesh += audit.remeshed_now;
    ledger.material += audit.fed.carried - audit.remeshed_now;
    ledger.wire += now - audit.wire_then;
    ledger.friction -= contact.friction + contact.rolling;
    ledger.contact -= contact.normal;
    ledger.wall -= work.wall;
    const IntegratorSpec& integrator = world.setup.integrator;
    if (!end_forces(integrator) || integrator.scheme != Scheme::Newton) {
        ledger.scheme += ledger.open();
        return;
    }
    const StepLosses losses = world.solver->losses(wire);
    const double fed = world.groups.of(wire)   ? work.feed
                       : world.feed(wire).on ? force_of_feed(world, wire, Vec3::Zero()) * world.feed(wire).grown
                                              : 0;
    const double elastic_then = audit.elastic_then + (world.state.wires[wire].remesh_energy - audit.remeshed);
    ledger.damping += losses.damping;
    ledger.scheme += losses.inertia + losses.strain_work + fed + work.turning - (audit.elastic - elastic_then);
}

}  // namespace

double energy_floor(const WireSpec& wire, const Vec3& gravity)
{
    constexpr int parts = 100;
    double mass = 0, stiffest = 0;
    for (int k = 0; k < parts; ++k) {
        const WireSection& section = wire.at((k + 0.5) / parts * wire.length);
        mass += section.density * std::numbers::pi * section.radius * section.radius * wire.length / parts;
        stiffest = std::max(stiffest, section.bend_stiffness);
    }
    return floor_share * (mass * gravity.norm() * wire.length + stiffest / wire.length);
}

void audit_remeshing(WorldData& world, int wire)
{
    EnergyAudit& audit = world.audit(wire);
    audit.fed = {};
    audit.remeshed_now = 0;
    if (!audit.known) return;
    const double moving = kinetic_energy(WorldRod(world, wire)) + world.solver->potential_energy(wire);
    audit.remeshed_now = (moving - audit.moving) + (world.state.wires[wire].remesh_energy - audit.remeshed);
    audit.fed.carried = audit.remeshed_now;
}

FeedingAudit::FeedingAudit(const WorldRod& rod) : rod_(rod), inside_(rod.feed().inside)
{
    const RodView line = rod.view();
    first_ = rod.group() ? 0 : line.n - 2;
    std::copy(line.mass.begin() + first_, line.mass.begin() + line.n, rod.world().work.wires[rod.line()].mass.begin() + first_);
    for (const int w : rod.wires()) {
        const RodView own = rod.world().rod(w);
        std::copy(own.spin_inertia.begin() + first_, own.spin_inertia.begin() + line.n - 1,
                  rod.world().work.wires[w].inertia.begin() + first_);
    }
}

void FeedingAudit::after() const
{
    WorldData& world = rod_.world();
    EnergyAudit& audit = world.audit(rod_.line());
    const FeedState& feed = rod_.feed();
    MergedGroup* group = rod_.group();
    if (group) group->weight_work = 0;
    if (!inside_ || !feed.inside) {
        audit.known = false;
        audit.ledger.material -= std::exchange(audit.ledger.wire, 0.0);  // what goes out takes its energy along
        return;
    }
    const RodView line = rod_.view();
    const int hub = line.n - 1;
    EnergyInput& fed = audit.fed;
    for (const int w : rod_.wires()) {
        const RodView own = world.rod(w);
        for (int j = hub - 1; j >= first_; --j) {
            const double spin = own.spin_rate[j];
            fed.carried += 0.5 * (own.spin_inertia[j] - world.work.wires[w].inertia[j]) * spin * spin;
        }
    }
    for (int i = hub; i >= first_; --i) {
        const double more = line.mass[i] - world.work.wires[rod_.line()].mass[i];
        fed.carried += more * (0.5 * line.vel(i).squaredNorm() - world.setup.gravity.dot(feed.point));
        if (group) group->weight_work -= more * world.setup.gravity.dot(line.pos(i) - feed.point);
    }
    // the hub's half cell takes the feed's speed within the step; the cells before it show it only at the step's ends
    const double mass = end_forces(world.setup.integrator) ? 0.5 * line.mass[hub] : mass_of(line);
    fed.unseen = feed.speed == audit.speed ? 0 : mass * std::abs(feed.speed * feed.speed - audit.speed * audit.speed);
}

void begin_audits(WorldData& world)
{
    if (world.state.steps > 0 || world.forces.are_unknown()) return;
    for (int w = 0; w < world.wire_count(); ++w) {
        if (world.audit(w).known || !world.state.is_solved(w) || !world.is_line(w)) continue;
        WorldRod(world, w).constrain(w, world.state.wires[w].time);
        begin_audit(world, w, true);
    }
}

void begin_audit(WorldData& world, int wire, bool placed)
{
    EnergyAudit& audit = world.audit(wire);
    const WorldRod rod(world, wire);
    read_energies(rod, placed ? rod.elastic_energy() : world.solver->elastic_energy(wire));
    audit.balance.begin(energy_now(audit));
    audit.ledger = {};
    audit.wire_then = audit.kinetic + audit.elastic + audit.gravitational;
    audit.elastic_then = audit.elastic;
    audit.known = true;
    audit.moving = audit.kinetic + audit.gravitational;
    audit.remeshed = world.state.wires[wire].remesh_energy;
    if (placed) note_turns(world, wire);
    else accept_energy(world, wire, 0);
}

void count_equilibrium(WorldData& world, int wire)
{
    EnergyAudit& audit = world.audit(wire);
    if (!audit.known) return begin_audit(world, wire, false);
    const WorldRod rod(world, wire);
    audit.remeshed_now = world.state.wires[wire].remesh_energy -
                         audit.remeshed;  // nodes of a wire at rest come and go on its line: its height stays
    audit.fed = {};
    audit.fed.carried = audit.remeshed_now;
    read_energies(rod, world.solver->elastic_energy(wire));
    take_into_ledger(world, wire, work_done(rod));
    audit.ledger = audit.next_ledger;
    accept_energy(world, wire, 0);
}

bool energy_adds_up(WorldData& world, int wire, double h)
{
    EnergyAudit& audit = world.audit(wire);
    const WorldRod rod(world, wire);
    read_energies(rod, world.solver->elastic_energy(wire));
    EnergyInput input = audit.fed;
    const WorkDone work = work_done(rod);
    input.work += work.sum();
    take_into_ledger(world, wire, work);
    input.unseen += unseen_work(world, wire, h);
    if (world.setup.integrator.scheme == Scheme::Newton && !world.work.reports[wire].best_effort)
        for (const int w : rod.wires()) input.work += world.solver->residual_work(w);
    audit.next = audit.balance;
    if (audit.known) return audit.next.take_in(energy_now(audit), input, audit.limits);
    audit.next.begin_after(energy_now(audit), input);
    return true;
}

void accept_energy(WorldData& world, int wire, double h)
{
    EnergyAudit& audit = world.audit(wire);
    if (h > 0) audit.balance = audit.next, audit.ledger = audit.next_ledger;
    audit.known = true;
    audit.wire_then = audit.kinetic + audit.elastic + audit.gravitational;
    audit.elastic_then = audit.elastic;
    audit.moving = audit.kinetic + audit.gravitational;
    audit.remeshed = world.state.wires[wire].remesh_energy;
    const auto& prescribed = world.constraints(wire).prescribed;
    const std::vector<RodClamp>& clamps = world.constraints(wire).clamps;
    note_turns(world, wire);
    audit.speed = WorldRod(world, wire).feed().speed;
    if (end_forces(world.setup.integrator)) return;
    audit.held.resize(prescribed.size());
    audit.held_speed.resize(prescribed.size());
    for (std::size_t k = 0; k < prescribed.size(); ++k) {
        audit.held[k] = world.solver->reaction(wire, prescribed[k].first);
        audit.held_speed[k] = h > 0 ? world.solver->displacement(wire, prescribed[k].first) / h : 0;
    }
    const RodView rod = world.rod(wire);
    if (const MergedGroup* group = world.groups.of(wire)) {
        const MergedForces forces = merged_forces(world, *group);
        audit.torque.assign(forces.value.begin(), forces.value.begin() + static_cast<std::ptrdiff_t>(forces.count));
        return;
    }
    audit.torque.resize(clamps.size());
    for (std::size_t c = 0; c < clamps.size(); ++c)
        audit.torque[c] = clamps[c].spin ? clamp_torque(rod, clamps, world.solver->frames(wire), static_cast<int>(c)) : 0;
    if (world.feed(wire).on) audit.hand_force = force_of_feed(world, wire, world.setup.gravity);
}

}  // namespace seldinger
