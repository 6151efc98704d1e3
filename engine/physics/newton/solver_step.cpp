// One step in time of all systems: begin, Newton, spin angles that were left out, end.
#include "newton/solver_work.h"

#include <algorithm>

namespace seldinger {

// ---- begin and end of a solve -----------------------------------------------------------------------------------------------

void Solver::begin(Motion motion, double h, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active)
{
    SEL_ASSERT(static_cast<int>(active.size()) >= rods_.wire_count());
    workspaces_->provide();
    for_each_item(system_count(), wire_grain, [&](int s) {
        begin_system(s, motion, h, constraints, active, SpinAngles::SolvedFor);
        for (int w = first_wire_[s]; w < first_wire_[s + 1]; ++w) show_accepted(w);
    });
}

void Solver::begin_system(int system, Motion motion, double h, std::span<const WireConstraints> constraints,
                          std::span<const std::uint8_t> active, SpinAngles spins)
{
    with_spins_[system] = 0;
    asked_[system] = any_active(system, active);
    for (int w = first_wire_[system]; w < first_wire_[system + 1]; ++w)
        if (!active[w]) show_accepted(w);
    if (!asked_[system]) return;
    if (spin_records_[system].wait > 0) spins = SpinAngles::SolvedFor;
    newton_of(system).problem.begin(rods_, constraints, active, {spec_, gravity_, motion, h, spins});
}

/// The accepted state as the trial.
void Solver::show_accepted(int wire)
{
    const RodView rod = rods_.view(wire);
    const int at = rods_.node_begin(wire);
    std::copy_n(rod.x.begin(), rod.n, trial_.x.begin() + at);
    std::copy_n(rod.y.begin(), rod.n, trial_.y.begin() + at);
    std::copy_n(rod.z.begin(), rod.n, trial_.z.begin() + at);
    std::copy_n(rod.theta.begin(), rod.n - 1, trial_.theta.begin() + at);
}

/// Failure leaves the wires as they were: the trial and the frames are those of the accepted state again.
void Solver::restore(int system)
{
    SystemProblem& problem = newton_of(system).problem;
    problem.return_to_start();
    if (problem.without_spins()) problem.take_spins_in();
    (void)problem.update();
    write_trial(system);
}

void Solver::finish(std::span<SolveReport> reports)
{
    for_each_system(SolveStage::Commit, [&](int s) {
        if (!asked_[s]) return;
        NewtonSystem& newton = newton_of(s);
        for (WireProblem* wire : newton.problem.solved()) {
            SolveReport& report = reports[wire->wire];
            report = newton.report(*wire);
            if (with_spins_[s]) {
                report.iterations += first_[wire->wire].iterations;
                report.evaluations += first_[wire->wire].evaluations;
            }
        }
        if (newton.converged()) newton.problem.commit(spec_.newmark);
        else restore(s);
    });
}

// ---- one step -------------------------------------------------------------------------------------------------------------

void Solver::step(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                  std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    SEL_ASSERT(h > 0);
    if (spec_.scheme == Scheme::Explicit) return step_explicit(h, constraints, terms, active, reports);
    if (spec_.scheme == Scheme::Static) return equilibrium(constraints, terms, active, reports);
    using enum SpinAngles;
    stopped_ = false;
    if (stop_asked_) spins_before_ = spin_records_;
    workspaces_->provide();
    const SpinAngles spins = spec_.spins == Spins::Kept ? SolvedFor : terms.traits().follows_spins ? LeftIfStill : LeftIfFree;
    NewtonOptions options;
    options.linearised = spec_.scheme == Scheme::Linearised;
    options.best_effort = best_effort_;
    std::fill(evaluate_.begin(), evaluate_.end(), std::uint8_t{0});
    for_each_system(SolveStage::Begin, [&](int s) {
        running_[s] = 0;
        begin_system(s, Motion::Implicit, h, constraints, active, spins);
        if (!asked_[s]) return;
        newton_of(s).start(options, terms);
        prepare_trial(s);
    });
    iterate_with_multipliers(h, terms, asked_);
    if (!stopped_) check_spins(h, constraints, terms, active, options);
    if (stopped_) spin_records_ = spins_before_;
    finish(reports);
}

/// Steps solved without spin angles stand if these angles' equations hold; the others are solved again with them.
void Solver::check_spins(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                         std::span<const std::uint8_t> active, const NewtonOptions& options)
{
    bool any = false;
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s]) continue;
        NewtonSystem& newton = newton_of(s);
        SpinRecord& record = spin_records_[s];
        ++record.steps;
        if (record.wait > 0) --record.wait;
        if (!newton.problem.without_spins() || !newton.converged()) continue;
        if (newton.problem.spins_hold(terms) || newton.cut_short()) {
            record.last_wait = 0;
            ++record.without;
            write_trial(s);
            continue;
        }
        record.wait = record.last_wait = std::min(std::max(2 * record.last_wait, 1), 256);
        with_spins_[s] = 1;
        any = true;
        for (const WireProblem* wire : newton.problem.solved()) first_[wire->wire] = newton.report(*wire);
        newton.problem.begin(rods_, constraints, active, {spec_, gravity_, Motion::Implicit, h});
        newton.start(options, terms);
    }
    if (!any) return;
    prepare_trials(with_spins_);
    iterate_with_multipliers(h, terms, with_spins_);
}

}  // namespace seldinger
