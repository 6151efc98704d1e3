// From the start of a step to the accepted states: the state that a failed attempt returns to, detection, Newton, and the treatment
// of systems that do not converge.

#include "core/clock.h"
#include "core/parallel.h"
#include "core/prefetch.h"
#include "world/merged.h"
#include "rod/no_state.h"
#include "world/step_stages.h"
#include "world/world.h"

#include <algorithm>

namespace seldinger {

namespace {

constexpr int most_energy_halvings = 3;  // energy that steps eight times as short make too is none of the step's length

/// What a loop over the wires comes to next: the arrays of the wire after this one.
void prefetch_after(World::Impl& state, int w)
{
    if (w + 1 >= state.wire_count()) return;
    for (const std::span<double>& array : state.rods.arrays(w + 1)) prefetch(array.data(), array.size_bytes());
}

// Newmark's first step needs the acceleration at its start: that of the forces on the wire as placed.
void start_acceleration(World::Impl& state)
{
    for (int w = 0; w < state.wire_count(); ++w) {
        state.live[w] = state.active[w] = state.is_solved(w);
        constrain_now(state, w);
    }
    state.terms.begin_step(state.rods);
    state.terms.prepare(state.rods, state.live);
    state.solver->initialise_acceleration(state.constraints, state.terms, state.active);
}

bool audited(const World::Impl& state) { return state.setup.integrator.scheme != Scheme::Static; }

/// What became of the systems that were solved.
struct Outcomes {
    WireMask failed;  // did not converge
    WireMask ended;   // converged to a state of more energy than was put in, in short sub-steps too
};

Outcomes judge(World::Impl& state, const SubStep& sub, StepReport& report)
{
    const std::size_t count = sub.wires.size();
    Outcomes to{WireMask(count), WireMask(count)};
    WireMask adds_up(count, 1);
    if (audited(state))
        for_each_item(state.wire_count(), wire_grain, [&](int w) {
            if (state.active[w] && state.reports[w].converged && !state.is_passenger(w)) adds_up[w] = energy_adds_up(state, w, sub.h);
        });
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!state.active[w]) continue;
        const SolveReport& solved = state.reports[w];
        note(state, report, w, solved.best_effort ? StepBestEffort : solved.cut_short ? StepCutShort : StepOk, solved.iterations);
        const bool missed = solved.converged && solved.best_effort && !state.is_passenger(w);
        if (missed && (is_torn(state.rods.view(w)) || is_thrown(state.rods.view(w), solved.residual, sub.h))) {
            to.failed[w] = 1;
            continue;
        }
        if (solved.converged && adds_up[w]) continue;
        (solved.converged && sub.halvings >= most_energy_halvings ? to.ended : to.failed)[w] = 1;
    }
    state.spread_over_systems(sub.wires, to.ended);
    for (std::size_t w = 0; w < count; ++w) to.failed[w] = to.failed[w] && !to.ended[w];
    state.spread_over_systems(sub.wires, to.failed);
    return to;
}

}  // namespace

WireMask everyone(const World::Impl& state)
{
    WireMask mask(state.wire_count());
    for (int w = 0; w < state.wire_count(); ++w) mask[w] = !state.retired[w];
    return mask;
}

void clear_timers(World::Impl& state)
{
    state.solve_time = state.adapt_time = 0;
    state.terms.clear_times();
}

void collect_timers(World::Impl& state, StepReport& report)
{
    report.times = state.terms.times();
    // the solver's own share: its time less that of force terms inside it
    report.times.solve = std::max(0.0, state.solve_time - state.terms_in_solve);
    report.times.adapt = state.adapt_time;
}

void note(World::Impl& state, StepReport& report, int wire, unsigned flags, int newton_iterations, int sub_steps)
{
    const auto add_to = [&](auto& to) {
        to.flags |= flags;
        to.newton_iterations = std::max(to.newton_iterations, newton_iterations);
        to.sub_steps = std::max(to.sub_steps, sub_steps);
    };
    add_to(state.wire_reports[wire]);
    add_to(report);
}

void begin_step(World::Impl& state)
{
    if (state.steps == 0 && state.setup.integrator.newmark) start_acceleration(state);
    // contacts of the initial placement are not known yet: there energies are counted from the end of the first step
    for (int w = 0; w < state.wire_count() && state.steps == 0 && state.terms.empty(); ++w) {
        if (state.audits[w].known || !state.is_solved(w) || state.is_passenger(w)) continue;
        constrain_now(state, w);
        begin_audit(state, w, true);
    }
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        prefetch_after(state, w);
        state.keep_wire(w);
    });
    state.terms_in_solve = 0;
    state.step_start.clear();
    for (std::vector<CarriedImpulse>& left : state.left) left.clear();
    state.wire_reports.assign(state.wire_count(), WireReport{});
}

// One sub-step that is stopped is put back as one that has failed. A whole state is kept only where earlier sub-steps, or other
// systems, may have been accepted by then.
void keep_start(World& world, const SubStep& sub, double dt)
{
    World::Impl& state = world.impl();
    const bool whole = sub.h > 0.999 * dt && state.system_count() == 1;
    if (state.stop_asked && state.step_start.empty() && !whole) state.step_start = world.save_state();
}

StepReport put_back(World::Impl& state, StepReport& report)
{
    if (!state.step_start.empty()) state.put_back(state.step_start);
    show_groups(state);
    state.step_start.clear();
    note(state, report, 0, StepStopped);
    collect_timers(state, report);
    return report;
}

void carry_on(World::Impl& state)
{
    for (std::size_t w = 0; w < state.left.size(); ++w) std::swap(state.carried[w], state.left[w]);
}

void begin_sub_step(World::Impl& state, const SubStep& sub)
{
    for (int w = 0; w < state.wire_count() && sub.after != SubStep::After::Nothing; ++w) {
        if (!sub.wires[w]) continue;
        if (sub.after == SubStep::After::Part && !state.is_passenger(w)) adapt_nodes_of(state, w, sub.h);
        state.keep_wire(w);
    }
    set_exposures(state);
    state.terms.begin_step(state.rods);
}

void find_contacts(World::Impl& state)
{
    set_exposures(state);
    state.terms.prepare(state.rods, state.live);
}

void solve(World::Impl& state, const SubStep& sub)
{
    const auto start = Clock::now();
    const double before = state.terms.times().in_all();
    state.solver->set_best_effort(sub.halvings == most_halvings);
    state.solver->step(sub.h, state.constraints, state.terms, state.active, state.reports);
    state.solve_time += seconds_since(start);
    state.terms_in_solve += state.terms.times().in_all() - before;
}

void accept(World::Impl& state, const SubStep& sub, StepReport& report)
{
    Outcomes outcomes = judge(state, sub, report);
    WireMask done = sub.wires;
    for (int w = 0; w < state.wire_count(); ++w) done[w] = done[w] && !outcomes.failed[w] && !outcomes.ended[w];
    state.terms.commit(done);
    for_each_item(state.wire_count(), wire_grain, [&](int w) {
        prefetch_after(state, w);
        if (!done[w]) return;
        state.wire_time[w] += sub.h;
        if (state.active[w] && audited(state) && !state.is_passenger(w)) accept_energy(state, w, sub.h);
        if (state.active[w] && state.reports[w].cut_short) add_left(state.rods.view(w), *state.solver, w, sub.h, state.left[w]);
        state.read_results(w, sub.h);
    });
    for (int w = 0; w < state.wire_count() && state.hand_stiffness_watched; ++w)
        if (done[w] && state.active[w]) state.read_hand_stiffness(w);
    const bool shortest = sub.halvings == most_halvings;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!outcomes.failed[w] && !outcomes.ended[w]) continue;
        state.put_back_wire(w);
        if (outcomes.ended[w]) note(state, report, w, StepEnergy);
        else if (shortest) note(state, report, w, state.reports[w].non_finite ? StepNonFinite : StepNotConverged);
        else note(state, report, w, StepHalved, 0, 2 << sub.halvings);
    }
    state.pending.lose(outcomes.ended);
    if (shortest) state.pending.lose(outcomes.failed);
    else state.pending.halve(outcomes.failed);
}

}  // namespace seldinger
