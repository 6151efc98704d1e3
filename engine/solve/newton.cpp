#include "solve/newton.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/prefetch.h"
#include "solve/solver_work.h"

#include <algorithm>

namespace seldinger {

namespace {

constexpr int most_rounds = 40;  // of multipliers: misses shrink to a quarter and better in a round, stiffnesses seen to

}  // namespace

Solver::Solver(RodArrays& rods, const IntegratorSpec& spec, const Vec3& gravity) : rods_(rods), spec_(spec), gravity_(gravity)
{
    if (spec.newmark && !(spec.beta > 0))
        throw Error(ExitCode::BadScene,
                    "integrator.beta: must be greater than 0 (0.25 is the trapezoid); for an explicit "
                    "method set scheme = \"explicit\"");
    for (int w = 0; w < rods.wire_count(); ++w) work_.push_back(std::make_unique<Work>(rods.capacity(w), spec));
    int most_nodes = 0;
    for (int w = 0; w < rods.wire_count(); ++w) most_nodes = std::max(most_nodes, rods.capacity(w));
    workspaces_ = std::make_unique<Workspaces>(most_nodes);
    for (TrialState* state : {&trial_, &before_})
        for (auto* array : {&state->x, &state->y, &state->z, &state->theta}) array->resize(rods.total_capacity());
    for (auto* mask : {&running_, &evaluate_, &solved_, &again_, &with_spins_}) mask->resize(rods.wire_count());
    first_.resize(rods.wire_count());
    spin_records_.resize(rods.wire_count());
}

Solver::~Solver() = default;

// ---- the lockstep ---------------------------------------------------------------------------------------------------------

void Solver::write_trial(int wire)
{
    const WireProblem& problem = newton_of(wire).problem;
    const int begin = rods_.node_begin(wire);
    for (int i = 0; i < problem.rod.n; ++i) {
        trial_.x[begin + i] = problem.trial[4 * i];
        trial_.y[begin + i] = problem.trial[4 * i + 1];
        trial_.z[begin + i] = problem.trial[4 * i + 2];
        trial_.theta[begin + i] = problem.trial[4 * i + 3];
    }
}

/// The wire's solve, in the memory of this thread.
NewtonWire& Solver::newton_of(int wire)
{
    NewtonWire& newton = work_[wire]->newton;
    newton.work_in(workspaces_->here(), spec_.scheme == Scheme::Linearised);
    return newton;
}

/// What a loop over the wires comes to after this one, and where what comes then is found.
void Solver::prefetch_after(int wire, SolveStage stage) const
{
    const int wires = rods_.wire_count();
    if (wire + 2 < wires) prefetch(work_[wire + 2].get(), sizeof(Work));
    if (wire + 1 < wires) work_[wire + 1]->newton.prefetch(stage);
}

/// The next trial of a wire that goes on, for contact to evaluate.
void Solver::prepare_trial(int wire)
{
    NewtonWire& newton = newton_of(wire);
    evaluate_[wire] = 0;
    running_[wire] = newton.running();
    if (!running_[wire]) return;
    write_trial(wire);
    evaluate_[wire] = newton.problem.update();
}

void Solver::prepare_trials(std::span<const std::uint8_t> active)
{
    for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
        evaluate_[w] = running_[w] = 0;
        if (active[w]) prepare_trial(w);
    });
}

/// Contact where the wires that take part in its evaluation start from, with the velocities that they have there.
void Solver::evaluate_start(double h, bool linearised, const ForceTerms& terms)
{
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!evaluate_[w]) continue;
        const WireProblem& problem = newton_of(w).problem;
        const int begin = rods_.node_begin(w);
        for (int i = 0; i < problem.rod.n; ++i) {
            const auto before = [&](int c) { return problem.start[4 * i + c] - problem.known_move(4 * i + c); };
            before_.x[begin + i] = before(0);
            before_.y[begin + i] = before(1);
            before_.z[begin + i] = before(2);
            before_.theta[begin + i] = before(3);
        }
    }
    terms.evaluate_start(trial_, before_, h, linearised, evaluate_);
}

/// Until none is running. A wire takes its decision and sets up its next trial in one go, while its arrays are in the cache.
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
        for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
            prefetch_after(w, SolveStage::Advance);
            if (!running_[w]) return;
            NewtonWire& newton = newton_of(w);
            newton.advance(evaluate_[w], terms, w);
            if (newton.took_trial()) terms.take(w);
            prepare_trial(w);
        });
    }
}

/// Newton from trials that have been prepared, and again each time that contact renews its multipliers (D8).
void Solver::iterate_with_multipliers(double h, const ForceTerms& terms, std::span<const std::uint8_t> active)
{
    iterate(h, terms);
    for (int round = 0; round <= most_rounds; ++round) {
        for (int w = 0; w < rods_.wire_count(); ++w) solved_[w] = active[w] && newton_of(w).converged();
        if (!terms.refine(solved_, again_)) return;
        for (int w = 0; w < rods_.wire_count(); ++w) {
            if (!again_[w]) continue;
            if (round < most_rounds) newton_of(w).resume();
            else newton_of(w).stop_short();
        }
        prepare_trials(again_);
        iterate(h, terms);
    }
}

void Solver::begin(Motion motion, double h, std::span<const WireConstraints> constraints, std::span<const std::uint8_t> active)
{
    SEL_ASSERT(static_cast<int>(active.size()) >= rods_.wire_count());
    workspaces_->provide();
    for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
        if (active[w]) begin_wire(w, motion, h, constraints[w], SpinAngles::SolvedFor);
        show_accepted(w);
    });
}

void Solver::begin_wire(int wire, Motion motion, double h, const WireConstraints& constraints, SpinAngles spins)
{
    with_spins_[wire] = 0;
    if (spin_records_[wire].wait > 0) spins = SpinAngles::SolvedFor;
    newton_of(wire).problem.begin(rods_.view(wire), constraints, spec_, gravity_, motion, h, spins);
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

/// Failure leaves the wire as it was: the trial and the frames are those of the accepted state again.
void Solver::restore(int wire)
{
    WireProblem& problem = newton_of(wire).problem;
    problem.trial = problem.start;
    if (problem.without_spins()) problem.take_spins_in();
    (void)problem.update();
    write_trial(wire);
}

void Solver::finish(std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
        prefetch_after(w, SolveStage::Commit);
        if (!active[w]) return;
        NewtonWire& newton = newton_of(w);
        reports[w] = newton.report();
        if (with_spins_[w]) {
            reports[w].iterations += first_[w].iterations;
            reports[w].evaluations += first_[w].evaluations;
        }
        if (newton.converged()) newton.problem.commit(spec_.newmark);
        else restore(w);
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
    for_each_item(rods_.wire_count(), wire_grain, [&](int w) {
        prefetch_after(w, SolveStage::Begin);
        evaluate_[w] = running_[w] = with_spins_[w] = 0;
        if (!active[w]) return show_accepted(w);
        begin_wire(w, Motion::Implicit, h, constraints[w], spins);
        newton_of(w).start(options, terms.move_limit(w));
        prepare_trial(w);
    });
    iterate_with_multipliers(h, terms, active);
    check_spins(h, constraints, terms, active, options);
    finish(active, reports);
}

/// Steps solved without spin angles stand if these angles' equations hold; the others are solved again with them.
void Solver::check_spins(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                         std::span<const std::uint8_t> active, const NewtonOptions& options)
{
    bool any = false;
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!active[w]) continue;
        NewtonWire& newton = newton_of(w);
        SpinRecord& record = spin_records_[w];
        ++record.steps;
        if (record.wait > 0) --record.wait;
        if (!newton.problem.without_spins() || !newton.converged()) continue;
        if (newton.problem.spins_hold(terms, w)) {
            record.last_wait = 0;
            ++record.without;
            write_trial(w);
            continue;
        }
        record.wait = record.last_wait = std::min(std::max(2 * record.last_wait, 1), 256);
        with_spins_[w] = 1;
        any = true;
        first_[w] = newton.report();
        newton.problem.begin(rods_.view(w), constraints[w], spec_, gravity_, Motion::Implicit, h);
        newton.start(options, terms.move_limit(w));
    }
    if (!any) return;
    prepare_trials(with_spins_);
    iterate_with_multipliers(h, terms, with_spins_);
}

// Symplectic Euler: v+ = v + h F(x, v)/m, x+ = x + h v+. A baseline; its step is limited by the axial wave (design, F1).
void Solver::step_explicit(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                           std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    begin(Motion::Explicit, h, constraints, active);
    evaluate_forces(h, terms, active);
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!active[w]) continue;
        WireProblem& problem = newton_of(w).problem;
        for (int i = 0; i < problem.size(); ++i) {
            if (problem.prescribed[i]) problem.move_prescribed(i);
            else problem.trial[i] += h * (problem.velocity(i) - h * problem.residual[i] / problem.inertia[i]);
        }
        write_trial(w);
        evaluate_[w] = evaluate_[w] && problem.update();
    }
    terms.evaluate(trial_, h, evaluate_);  // so that contact keeps the state that is accepted
    for (int w = 0; w < rods_.wire_count(); ++w) {
        if (!active[w]) continue;
        WireProblem& problem = newton_of(w).problem;
        reports[w] = {};
        reports[w].evaluations = 2;
        reports[w].converged = evaluate_[w] && terms.admissible(w);
        reports[w].non_finite = !evaluate_[w];
        if (!reports[w].converged) restore(w);
        else problem.commit_explicit();
    }
}

/// R at the present state into each active wire's residual; evaluate_[w] = 0 where that is not possible.
void Solver::evaluate_forces(double h, const ForceTerms& terms, std::span<const std::uint8_t> active)
{
    for (int w = 0; w < rods_.wire_count(); ++w) evaluate_[w] = active[w] && newton_of(w).problem.update();
    if (h > 0) evaluate_start(h, false, terms);
    else terms.evaluate(trial_, h, evaluate_);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (evaluate_[w]) evaluate_[w] = newton_of(w).problem.evaluate_residual(terms, w);
}

void Solver::initialise_acceleration(std::span<const WireConstraints> constraints, const ForceTerms& terms,
                                     std::span<const std::uint8_t> active)
{
    begin(Motion::Explicit, 0, constraints, active);
    evaluate_forces(0, terms, active);
    for (int w = 0; w < rods_.wire_count(); ++w)
        if (evaluate_[w]) newton_of(w).problem.set_acceleration_from_residual();
}

// ---- readings -------------------------------------------------------------------------------------------------------------

const RodFrames& Solver::frames(int wire) const { return work_[wire]->newton.problem.frames; }

const TrialState& Solver::trial() const { return trial_; }

double Solver::reaction(int wire, int unknown) const { return work_[wire]->newton.problem.residual[unknown]; }

double Solver::base_tension_excess(int wire) const { return work_[wire]->newton.problem.base_tension_excess(); }

Vec3 Solver::load_force(int wire) const { return work_[wire]->newton.problem.load_force(); }

double Solver::displacement(int wire, int unknown) const
{
    const WireProblem& problem = work_[wire]->newton.problem;
    return problem.trial[unknown] - problem.start[unknown];
}

double Solver::residual_work(int wire) const
{
    const WireProblem& problem = work_[wire]->newton.problem;
    double work = 0;
    for (int i = 0; i < problem.size(); ++i)
        if (!problem.prescribed[i]) work += problem.residual[i] * (problem.trial[i] - problem.start[i]);
    return work;
}

double Solver::elastic_energy(int wire) const
{
    const WireProblem& problem = work_[wire]->newton.problem;
    return seldinger::elastic_energy(rods_.view(wire), problem.clamps, problem.frames);
}

double Solver::kinetic_energy(int wire) const
{
    const RodView rod = rods_.view(wire);
    double twice = 0;
    for (int i = 0; i < rod.n; ++i) twice += rod.mass[i] * rod.vel(i).squaredNorm();
    for (int j = 0; j < rod.n - 1; ++j) twice += rod.spin_inertia[j] * rod.spin_rate[j] * rod.spin_rate[j];
    return 0.5 * twice;
}

double Solver::potential_energy(int wire) const
{
    const RodView rod = rods_.view(wire);
    double energy = 0;
    for (int i = 0; i < rod.n; ++i) energy -= rod.mass[i] * gravity_.dot(rod.pos(i));
    return energy;
}

}  // namespace seldinger
