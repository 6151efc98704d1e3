#include "step_stages.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace seldinger {

namespace {

constexpr int most_halvings = 9;  // h / 512: an update moves no node by more than half a radius, so 20 m/s at 1/60 s takes that

using Clock = std::chrono::steady_clock;

// Feeding and holds at the end of the sub-step; `live` wires are the ones that are solved and may touch the wall.
void feed_and_constrain(World::Impl& state, double h, const WireMask& mask)
{
    for (int w = 0; w < state.wire_count(); ++w) {
        state.live[w] = state.active[w] = mask[w];
        if (!mask[w]) continue;
        const WireSetup& setup = state.setup.wires[w];
        const double t = state.wire_time[w] + h;
        if (state.feeds[w].on) feed_to(state.feeds[w], setup.feed, setup.wire, state.rods, w, t, h);
        if (state.feeds[w].on && !state.feeds[w].inside) state.live[w] = state.active[w] = 0;
        const RodView rod = state.rods.view(w);
        state.holds[w].fill(t, rod, state.constraints[w]);
        if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
    }
}

}  // namespace

WireMask everyone(const World::Impl& state) { return WireMask(state.wire_count(), 1); }

void clear_timers(World::Impl& state)
{
    state.solve_time = state.adapt_time = 0;
    if (state.contact) state.contact->times = {};
}

void collect_timers(World::Impl& state, StepReport& report)
{
    if (state.contact) report.times = state.contact->times;
    // the solver's own share: what it took less what contact took inside it
    report.times.solve = std::max(0.0, state.solve_time - (state.contact ? state.contact_in_solve : 0.0));
    report.times.adapt = state.adapt_time;
}

void begin_step(World::Impl& state)
{
    for (int w = 0; w < state.wire_count(); ++w) state.save_wire(w);
    state.contact_in_solve = 0;
}

WireMask advance(World::Impl& state, double h, const WireMask& mask, StepReport& report, int depth)
{
    if (state.contact) state.contact->begin_step(state.rods);
    feed_and_constrain(state, h, mask);
    if (state.contact) state.contact->prepare(state.rods, state.live);

    const auto start = Clock::now();
    const StageTimes before = state.contact ? state.contact->times : StageTimes{};
    state.solver->set_best_effort(depth == most_halvings);
    state.solver->step(h, state.constraints, state.contact.get(), state.active, state.reports);
    state.solve_time += std::chrono::duration<double>(Clock::now() - start).count();
    if (state.contact) {
        const StageTimes& after = state.contact->times;
        state.contact_in_solve += after.detect - before.detect + after.evaluate - before.evaluate + after.reduce - before.reduce;
    }

    WireMask done = mask, failed(mask.size(), 0);
    bool any_failed = false;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!state.active[w]) continue;
        const SolveReport& solved = state.reports[w];
        report.newton_iterations = std::max(report.newton_iterations, solved.iterations);
        if (solved.best_effort) report.flags |= StepBestEffort;
        if (solved.converged) continue;
        failed[w] = 1;
        done[w] = 0;
        any_failed = true;
        if (depth == most_halvings) report.flags |= solved.non_finite ? StepNonFinite : StepNotConverged;
    }
    if (state.contact) state.contact->commit(done);
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!done[w]) continue;
        state.wire_time[w] += h;
        state.read_results(w);
    }
    if (!any_failed) return failed;
    for (int w = 0; w < state.wire_count(); ++w)
        if (failed[w]) state.restore_wire(w);
    if (depth == most_halvings) return failed;
    report.flags |= StepHalved;
    report.sub_steps = std::max(report.sub_steps, 2 << depth);
    WireMask lost = advance(state, h / 2, failed, report, depth + 1), rest = failed;
    bool any_left = false;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!failed[w]) continue;
        state.save_wire(w);
        rest[w] = !lost[w];
        any_left = any_left || rest[w];
    }
    if (!any_left) return lost;
    const WireMask lost_later = advance(state, h / 2, rest, report, depth + 1);
    for (int w = 0; w < state.wire_count(); ++w) lost[w] = lost[w] || lost_later[w];
    return lost;
}

void find_equilibrium(World::Impl& state, StepReport& report)
{
    const WireMask all = everyone(state);
    const bool all_stuck = state.setup.start_settled && state.steps == 0;
    if (state.contact) {
        state.contact->set_all_stuck(all_stuck);
        state.contact->begin_step(state.rods);
    }
    for (int w = 0; w < state.wire_count(); ++w) {
        state.live[w] = state.active[w] = !state.feeds[w].on || state.feeds[w].inside;
        const double t = state.setup.integrator.scheme == Scheme::Static ? INFINITY : state.wire_time[w];
        const RodView rod = state.rods.view(w);
        state.holds[w].fill(t, rod, state.constraints[w]);
        if (state.feeds[w].on) add_feed_constraints(state.feeds[w], rod, state.constraints[w]);
    }
    if (state.contact) state.contact->prepare(state.rods, state.live);
    const auto start = Clock::now();
    state.solver->equilibrium(state.constraints, state.contact.get(), state.active, state.reports);
    state.solve_time += std::chrono::duration<double>(Clock::now() - start).count();
    WireMask done = all;
    for (int w = 0; w < state.wire_count(); ++w) {
        if (!state.active[w]) continue;
        report.newton_iterations = std::max(report.newton_iterations, state.reports[w].iterations);
        if (state.reports[w].converged) continue;
        done[w] = 0;
        report.flags |= state.reports[w].non_finite ? StepNonFinite : StepNotConverged;
        state.restore_wire(w);
    }
    if (state.contact) {
        state.contact->commit(done);
        state.contact->set_all_stuck(false);
    }
    for (int w = 0; w < state.wire_count(); ++w)
        if (done[w]) state.read_results(w);
}

void adapt_nodes(World::Impl& state, StepReport&)
{
    const auto start = Clock::now();
    for (int w = 0; w < state.wire_count(); ++w)
        if (state.feeds[w].on && state.feeds[w].inside)
            state.remesh_energy[w] += adapt_hub(state.feeds[w], state.setup.wires[w].wire, state.rods, w);
    state.adapt_time += std::chrono::duration<double>(Clock::now() - start).count();
}

void check_state(World::Impl& state, StepReport& report)
{
    state.time = *std::max_element(state.wire_time.begin(), state.wire_time.end());
    for (int w = 0; w < state.wire_count(); ++w) {
        const RodView rod = state.rods.view(w);
        for (int i = 0; i < rod.n; ++i)
            if (!std::isfinite(rod.x[i] + rod.y[i] + rod.z[i] + rod.vx[i] + rod.vy[i] + rod.vz[i])) report.flags |= StepNonFinite;
        if (state.results[w].contact.outside > 0) report.flags |= StepWallPenetration;
    }
}

}  // namespace seldinger
