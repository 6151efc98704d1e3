// The lockstep: trials of all systems, their evaluation, their decisions, until all have ended; and one step in time.

#include "solve/solver.h"

#include "core/error.h"
#include "core/prefetch.h"
#include "solve/solver_work.h"

#include <algorithm>
#include <numeric>

namespace seldinger {

namespace {

constexpr int most_rounds = 40;  // of multipliers: misses shrink to a quarter and better in a round, stiffnesses seen to

}  // namespace

Solver::Solver(RodArrays& rods, const IntegratorSpec& spec, const Vec3& gravity, std::span<const int> partition)
    : rods_(rods), spec_(spec), gravity_(gravity)
{
    if (spec.newmark && !(spec.beta > 0))
        throw Error(ExitCode::BadScene,
                    "integrator.beta: must be greater than 0 (0.25 is the trapezoid); for an explicit "
                    "method set scheme = \"explicit\"");
    const int wires = rods.wire_count();
    std::vector<int> sizes(partition.begin(), partition.end());
    if (sizes.empty()) sizes.assign(wires, 1);
    SEL_ASSERT(std::accumulate(sizes.begin(), sizes.end(), 0) == wires);
    std::vector<int> capacities(wires);
    for (int w = 0; w < wires; ++w) capacities[w] = rods.capacity(w);
    first_wire_.push_back(0);
    int most_nodes = 0;
    for (const int size : sizes) {
        const std::span<const int> of_system = std::span(capacities).subspan(first_wire_.back(), size);
        system_of_.insert(system_of_.end(), size, system_count());
        work_.push_back(std::make_unique<Work>(first_wire_.back(), of_system, spec));
        most_nodes = std::max(most_nodes, std::accumulate(of_system.begin(), of_system.end(), 0));
        first_wire_.push_back(first_wire_.back() + size);
    }
    workspaces_ = std::make_unique<Workspaces>(most_nodes);
    for (TrialState* state : {&trial_, &before_})
        for (auto* array : {&state->x, &state->y, &state->z, &state->theta}) array->resize(rods.total_capacity());
    for (auto* mask : {&asked_, &running_, &with_spins_, &resumed_}) mask->resize(system_count());
    for (auto* mask : {&evaluate_, &solved_, &again_}) mask->resize(wires);
    first_.resize(wires);
    spin_records_.resize(system_count());
}

Solver::~Solver() = default;

// ---- the lockstep ---------------------------------------------------------------------------------------------------------

/// The system's solve, in the memory of this thread.
NewtonSystem& Solver::newton_of(int system)
{
    NewtonSystem& newton = work_[system]->newton;
    newton.work_in(workspaces_->here(), spec_.scheme == Scheme::Linearised);
    return newton;
}

/// What a loop over the systems comes to after this one, and where what comes then is found.
void Solver::prefetch_after(int system, SolveStage stage) const
{
    if (system + 2 < system_count()) prefetch(work_[system + 2].get(), sizeof(Work));
    if (system + 1 < system_count()) work_[system + 1]->newton.prefetch(stage);
}

void Solver::for_each_system(SolveStage stage, const auto& body)
{
    for_each_item(system_count(), wire_grain, [&](int s) {
        prefetch_after(s, stage);
        body(s);
    });
}

bool Solver::any_active(int system, std::span<const std::uint8_t> active) const
{
    for (int w = first_wire_[system]; w < first_wire_[system + 1]; ++w)
        if (active[w]) return true;
    return false;
}

void Solver::set_evaluated(int system, bool evaluate)
{
    for (const WireProblem* wire : work_[system]->newton.problem.solved()) evaluate_[wire->wire] = evaluate;
}

void Solver::write_trial(int system)
{
    for (const WireProblem* wire : work_[system]->newton.problem.solved()) {
        const int begin = rods_.node_begin(wire->wire);
        const std::span<const double> q = wire->q.trial;
        for (int i = 0; i < wire->rod.n; ++i) {
            trial_.x[begin + i] = q[RodDofs::position(i, 0)];
            trial_.y[begin + i] = q[RodDofs::position(i, 1)];
            trial_.z[begin + i] = q[RodDofs::position(i, 2)];
            trial_.theta[begin + i] = q[RodDofs::spin(i)];
        }
    }
}

/// The next trial of a system that goes on, for force terms to evaluate.
void Solver::prepare_trial(int system)
{
    NewtonSystem& newton = newton_of(system);
    set_evaluated(system, false);
    running_[system] = newton.running();
    if (!running_[system]) return;
    write_trial(system);
    set_evaluated(system, newton.problem.update());
}

void Solver::prepare_trials(std::span<const std::uint8_t> systems)
{
    std::fill(evaluate_.begin(), evaluate_.end(), std::uint8_t{0});
    for_each_item(system_count(), wire_grain, [&](int s) {
        running_[s] = 0;
        if (systems[s]) prepare_trial(s);
    });
}

/// Force terms where the wires that take part in their evaluation start from, with the velocities that they have there.
void Solver::evaluate_start(double h, bool linearised, const ForceTerms& terms)
{
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!evaluate_[w]) continue;
        const WireProblem& wire = problem_of(w);
        const int begin = rods_.node_begin(w);
        for (int i = 0; i < wire.rod.n; ++i) {
            const auto before = [&](int unknown) { return wire.q.start[unknown] - wire.time.known_move(unknown); };
            before_.x[begin + i] = before(RodDofs::position(i, 0));
            before_.y[begin + i] = before(RodDofs::position(i, 1));
            before_.z[begin + i] = before(RodDofs::position(i, 2));
            before_.theta[begin + i] = before(RodDofs::spin(i));
        }
    }
    terms.evaluate_start(trial_, before_, h, linearised, evaluate_);
}

/// Until none is running. A system takes its decision and sets up its next trial in one go, while its arrays are in the cache.
void Solver::iterate(double h, const ForceTerms& terms)
{
    const auto any = [](const std::vector<std::uint8_t>& flags) {
        return std::find(flags.begin(), flags.end(), 1) != flags.end();
    };
    bool at_start = spec_.scheme == Scheme::Linearised;
    for (; any(running_); at_start = false) {
        if (any(evaluate_)) {
            if (at_start) evaluate_start(h, true, terms);
            else terms.evaluate(trial_, h, evaluate_);
        }
        for_each_system(SolveStage::Advance, [&](int s) {
            if (!running_[s]) return;
            NewtonSystem& newton = newton_of(s);
            const std::span<WireProblem* const> wires = newton.problem.solved();
            newton.advance(evaluate_[wires.front()->wire], terms);
            for (std::size_t k = 0; k < wires.size() && newton.took_trial(); ++k) terms.take(wires[k]->wire);
            prepare_trial(s);
        });
    }
}

/// Newton from trials that have been prepared, and again each time that force terms renew their multipliers (D8).
void Solver::iterate_with_multipliers(double h, const ForceTerms& terms, std::span<const std::uint8_t> systems)
{
    iterate(h, terms);
    for (int round = 0; round <= most_rounds; ++round) {
        std::fill(solved_.begin(), solved_.end(), std::uint8_t{0});
        for (int s = 0; s < system_count(); ++s) {
            const NewtonSystem& newton = work_[s]->newton;
            if (!systems[s] || !newton.converged()) continue;
            for (const WireProblem* wire : newton.problem.solved()) solved_[wire->wire] = 1;
        }
        if (!terms.refine(solved_, again_)) return;
        for (int s = 0; s < system_count(); ++s) {
            resumed_[s] = any_active(s, again_);
            if (!resumed_[s]) continue;
            if (round < most_rounds) newton_of(s).resume();
            else newton_of(s).stop_short();
        }
        prepare_trials(resumed_);
        iterate(h, terms);
    }
}

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
    newton_of(system).problem.begin(rods_, constraints, active, spec_, gravity_, motion, h, spins);
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
            if (newton.converged()) wire->commit(spec_.newmark);
        }
        if (!newton.converged()) restore(s);
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
    workspaces_->provide();
    const SpinAngles spins = spec_.spins == Spins::Kept ? SolvedFor : terms.follows_spins() ? LeftIfStill : LeftIfFree;
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
    check_spins(h, constraints, terms, active, options);
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
        if (newton.problem.spins_hold(terms)) {
            record.last_wait = 0;
            ++record.without;
            write_trial(s);
            continue;
        }
        record.wait = record.last_wait = std::min(std::max(2 * record.last_wait, 1), 256);
        with_spins_[s] = 1;
        any = true;
        for (const WireProblem* wire : newton.problem.solved()) first_[wire->wire] = newton.report(*wire);
        newton.problem.begin(rods_, constraints, active, spec_, gravity_, Motion::Implicit, h);
        newton.start(options, terms);
    }
    if (!any) return;
    prepare_trials(with_spins_);
    iterate_with_multipliers(h, terms, with_spins_);
}

}  // namespace seldinger
