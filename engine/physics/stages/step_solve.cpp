// From the start of a step to the accepted states: the state that a failed attempt returns to, detection, Newton, and the
// treatment of systems that do not converge.
#include "contact/wall_contact.h"
#include "core/clock.h"
#include "core/parallel.h"
#include "core/prefetch.h"
#include "rod/no_state.h"
#include "stages/step_stages.h"

#include <algorithm>

namespace seldinger {
namespace {

constexpr int most_energy_halvings = 3;  // energy that steps eight times as short make too is none of the step's length

/// What a loop over the wires comes to next: the arrays of the wire after this one.
void prefetch_after(RodArrays& rods, int w)
{
    if (w + 1 >= rods.wire_count()) return;
    for (const std::span<double>& array : rods.arrays(w + 1)) prefetch(array.data(), array.size_bytes());
}

// Newmark's first step needs the acceleration at its start: that of the forces on the wire as placed.
void start_acceleration(WorldData& world)
{
    for (int w = 0; w < world.wire_count(); ++w) {
        world.work.live[w] = world.work.active[w] = world.state.is_solved(w);
        constrain_now(world, w);
    }
    world.forces.terms.begin_step(world.state.rods);
    world.forces.terms.prepare(world.state.rods, world.work.live);
    world.solver->initialise_acceleration(world.work.constraints, world.forces.terms, world.work.active);
}

/// Whether a step may end as if it had not been taken.
bool may_be_undone(const WorldData& world) { return world.work.stop_asked || world.forces.given; }

bool audited(const WorldData& world) { return world.setup.integrator.scheme != Scheme::Static; }

/// What became of the systems that were solved.
struct Outcomes {
    WireMask failed;  // did not converge
    WireMask ended;   // converged to a state of more energy than was put in, in short sub-steps too
};

Outcomes judge(WorldData& world, const SubStep& sub, StepReport& report)
{
    const std::size_t count = sub.wires.size();
    Outcomes to{WireMask(count), WireMask(count)};
    WireMask adds_up(count, 1);
    if (audited(world))
        for_each_item(world.wire_count(), wire_grain, [&](int w) {
            if (world.work.active[w] && world.work.reports[w].converged && world.is_line(w))
                adds_up[w] = energy_adds_up(world, w, sub.h);
        });
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!world.work.active[w]) continue;
        const SolveReport& solved = world.work.reports[w];
        note(world, report, w, solved.best_effort ? StepBestEffort : solved.cut_short ? StepCutShort : StepOk, solved.iterations);
        const bool missed = solved.converged && solved.best_effort && world.is_line(w);
        if (missed && (is_torn(world.rod(w)) || is_thrown(world.rod(w), solved.residual, sub.h))) {
            to.failed[w] = 1;
            continue;
        }
        if (solved.converged && adds_up[w]) continue;
        (solved.converged && sub.halvings >= most_energy_halvings ? to.ended : to.failed)[w] = 1;
    }
    world.systems.spread(sub.wires, to.ended);
    for (std::size_t w = 0; w < count; ++w) to.failed[w] = to.failed[w] && !to.ended[w];
    world.systems.spread(sub.wires, to.failed);
    return to;
}

}  // namespace

void clear_timers(WorldData& world)
{
    world.work.solve_time = world.work.adapt_time = 0;
    world.forces.terms.clear_times();
}

void collect_timers(WorldData& world, StepReport& report)
{
    report.times = world.forces.terms.times();
    // the solver's own share: its time less that of force terms inside it
    report.times.solve = std::max(0.0, world.work.solve_time - world.work.terms_in_solve);
    report.times.adapt = world.work.adapt_time;
}

void note(WorldData& world, StepReport& report, int wire, unsigned flags, int newton_iterations, int sub_steps)
{
    const auto add_to = [&](auto& to) {
        to.flags |= flags;
        to.newton_iterations = std::max(to.newton_iterations, newton_iterations);
        to.sub_steps = std::max(to.sub_steps, sub_steps);
    };
    add_to(world.output.reports[wire]);
    add_to(report);
}

unsigned why_lost(const WorldData& world, int wire)
{
    if (world.work.reports[wire].non_finite) return StepNonFinite;
    const bool stands = !world.forces.wall_contact || world.forces.wall_contact->stands(world.systems.of(wire));
    return stands ? StepNotConverged : StepNotConverged | StepWallBuckles;
}

void begin_step(WorldData& world)
{
    if (world.state.steps == 0 && world.setup.integrator.newmark) start_acceleration(world);
    begin_audits(world);
    for_each_item(world.wire_count(), wire_grain, [&](int w) {
        prefetch_after(world.state.rods, w);
        keep_wire(world, w);
    });
    world.work.terms_in_solve = 0;
    world.work.step_start.clear();
    if (may_be_undone(world) && world.forces.wall_contact) world.forces.wall_contact->keep_feet();
    for (WireState& wire : world.state.wires) wire.left.clear();
    world.output.reports.assign(world.wire_count(), WireReport{});
}

// One sub-step that ends so is put back as one that has failed. A whole state is kept only where earlier sub-steps, or other
// systems (of a step that is stopped), may have been accepted by then, and where an attempt starts a block of steps of an elastic
// wall.
void keep_start(WorldData& world, const SubStep& sub)
{
    if (!may_be_undone(world) || !world.work.step_start.empty()) return;
    const bool all =
        std::ranges::equal(std::span<const std::uint8_t>(sub.wires), std::span<const std::uint8_t>(world.systems.running()));
    const bool alone = sub.h > 0.999 * world.work.length && all && (world.systems.count() == 1 || !world.work.stop_asked);
    const bool changes_wall = world.forces.wall_contact && world.forces.wall_contact->begins_block(sub.h);
    if (!alone || changes_wall) save_state(world, world.work.step_start);  // its memory stays
}

void keep_start(WorldData& world)
{
    if (world.forces.given) save_state(world, world.work.step_start);
}

bool ends_here(const WorldData& world) { return world.solver->stopped() || world.forces.raised(); }

StepReport put_back(WorldData& world, StepReport& report)
{
    if (!world.work.step_start.empty()) put_back_saved(world, world.work.step_start);
    if (world.forces.wall_contact) world.forces.wall_contact->put_feet_back();
    show_instruments(world);
    world.work.step_start.clear();
    note(world, report, 0, StepStopped);
    collect_timers(world, report);
    world.forces.raise();
    return report;
}

void carry_on(WorldState& state)
{
    for (WireState& wire : state.wires) std::swap(wire.carried, wire.left);
}

void begin_sub_step(WorldData& world, const SubStep& sub)
{
    for (int w = 0; w < world.wire_count() && sub.after != SubStep::After::Nothing; ++w) {
        if (!sub.wires[w]) continue;
        if (sub.after == SubStep::After::Part) adapt_nodes_of(world, w, sub.h);
        keep_wire(world, w);
    }
    set_exposures(world);
    world.forces.terms.begin_step(world.state.rods);
}

void find_contacts(WorldData& world)
{
    set_exposures(world);
    world.forces.terms.prepare(world.state.rods, world.work.live);
}

void solve(WorldData& world, const SubStep& sub)
{
    const auto start = Clock::now();
    const double before = world.forces.terms.times().in_all();
    world.solver->set_best_effort(sub.halvings == most_halvings);
    world.solver->step(sub.h, world.work.constraints, world.forces.terms, world.work.active, world.work.reports);
    world.work.solve_time += seconds_since(start);
    world.work.terms_in_solve += world.forces.terms.times().in_all() - before;
}

void accept(WorldData& world, const SubStep& sub, StepReport& report)
{
    Outcomes outcomes = judge(world, sub, report);
    WireMask lost(sub.wires.size()), done = sub.wires;
    for (int w = 0; w < world.wire_count(); ++w) lost[w] = outcomes.failed[w] || outcomes.ended[w];
    const WireMask again = balance_hubs(world, sub, lost);
    for (int w = 0; w < world.wire_count(); ++w) {
        outcomes.failed[w] = lost[w] && !outcomes.ended[w];
        done[w] = done[w] && !lost[w] && !again[w];
    }
    if (!world.forces.conclude(done)) {  // nothing of the sub-step stands
        world.solver->take_back_spins();
        lost = sub.wires, done = WireMask(sub.wires.size());
    }
    if (world.forces.wall_contact) world.forces.wall_contact->take_unwatched(sub.h, done);
    world.forces.terms.commit(done);
    for_each_item(world.wire_count(), wire_grain, [&](int w) {
        prefetch_after(world.state.rods, w);
        if (!done[w]) return;
        world.state.wires[w].time += sub.h;
        if (world.is_driven(w)) take_hub(world, w);
        if (world.work.active[w] && audited(world) && world.is_line(w)) accept_energy(world, w, sub.h);
        if (world.work.active[w] && world.work.reports[w].cut_short)
            add_left(world.rod(w), *world.solver, w, sub.h, world.state.wires[w].left);
        read_results(world, w, sub.h);
    });
    for (int w = 0; w < world.wire_count() && world.output.hand_stiffness_watched; ++w)
        if (done[w] && world.work.active[w]) read_hand_stiffness(world, w);
    const bool shortest = sub.halvings == most_halvings;
    for (int w = 0; w < world.wire_count(); ++w) {
        if (!lost[w] && !again[w]) continue;
        put_back_wire(world, w);
        if (again[w]) continue;
        world.work.wires[w].trial.trials = 0;
        if (outcomes.ended[w]) note(world, report, w, StepEnergy);
        else if (shortest) note(world, report, w, why_lost(world, w));
        else note(world, report, w, StepHalved, 0, 2 << sub.halvings);
    }
    world.work.pending.lose(outcomes.ended);
    if (shortest) world.work.pending.lose(outcomes.failed);
    else world.work.pending.halve(outcomes.failed);
    world.work.pending.again(again);
}

}  // namespace seldinger
