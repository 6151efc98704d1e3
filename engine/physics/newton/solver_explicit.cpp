// Symplectic Euler, and accelerations at the start of a run: steps that solve no equations.
#include "newton/solver_work.h"

namespace seldinger {

// v+ = v + h F(x, v)/m, x+ = x + h v+. A baseline; its step is limited by the axial wave (design, F1).
void Solver::step_explicit(double h, std::span<const WireConstraints> constraints, const ForceTerms& terms,
                           std::span<const std::uint8_t> active, std::span<SolveReport> reports)
{
    begin(Motion::Explicit, h, constraints, active);
    evaluate_forces(h, terms);
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s]) continue;
        SystemProblem& problem = newton_of(s).problem;
        for (WireProblem* wire : problem.solved()) wire->move_explicit();
        write_trial(s);
        set_evaluated(s, evaluate_[problem.solved().front()->wire] && problem.update());
    }
    terms.evaluate({trial_, h, evaluate_});  // so that force terms keep the state that is accepted
    accept_explicit(terms, reports);
}

void Solver::accept_explicit(const ForceTerms& terms, std::span<SolveReport> reports)
{
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s]) continue;
        SystemProblem& problem = newton_of(s).problem;
        const bool finite = evaluate_[problem.solved().front()->wire];
        if (finite) problem.ask(terms);
        const bool converged = finite && problem.admissible();
        for (WireProblem* wire : problem.solved()) {
            SolveReport& report = reports[wire->wire] = {};
            report.evaluations = 2;
            report.converged = converged;
            report.non_finite = !finite;
            if (converged) wire->commit_explicit();
        }
        if (!converged) restore(s);
    }
}

/// R at the present state into each system's residual; evaluate_ = 0 where that is not possible.
void Solver::evaluate_forces(double h, const ForceTerms& terms)
{
    std::fill(evaluate_.begin(), evaluate_.end(), std::uint8_t{0});
    for (int s = 0; s < system_count(); ++s)
        if (asked_[s]) set_evaluated(s, newton_of(s).problem.update());
    if (h > 0) evaluate_start(h, false, terms);
    else terms.evaluate({trial_, h, evaluate_});
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s] || !evaluate_[work_[s]->newton.problem.solved().front()->wire]) continue;
        SystemProblem& problem = newton_of(s).problem;
        problem.ask(terms);
        set_evaluated(s, problem.evaluate_residual(terms));
    }
}

void Solver::initialise_acceleration(std::span<const WireConstraints> constraints, const ForceTerms& terms,
                                     std::span<const std::uint8_t> active)
{
    begin(Motion::Explicit, 0, constraints, active);
    evaluate_forces(0, terms);
    for (int s = 0; s < system_count(); ++s) {
        if (!asked_[s]) continue;
        for (WireProblem* wire : newton_of(s).problem.solved())
            if (evaluate_[wire->wire]) wire->set_acceleration_from_residual();
    }
}

}  // namespace seldinger
