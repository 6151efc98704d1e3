#pragma once
// Newton's method for one system as a state machine: the solver evaluates all systems' trial states together, then lets each take
// its own decision. Nothing here looks at another system. Four classes do the work, each on the one iterate (iterate.h):
//
//   SystemProblem     R(q) and dR/dq of the system's wires (system_problem.h)
//   NewtonDirection   which matrix, which correction, chord steps, tension (direction.h)
//   NewtonAcceptance  whether a trial is taken, and which share of the direction is tried next (acceptance.h)
//   NewtonKinks       where the contact force is not smooth (kinks.h)
//
// This class drives them: first guess, decision at each trial, ends. No edge turns by more than half a radian and no node moves
// farther than force terms have searched in one update. Trials that are cut short by these limits may pass for ever: six bases in
// a row with the residual of the one before the last end the search.

#include "newton/acceptance.h"
#include "newton/newton_trial.h"
#include "solve/solve_report.h"

#include <functional>

namespace seldinger {

class NewtonSystem {
public:
    NewtonSystem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec);

    /// See SystemProblem::work_in().
    void work_in(SystemProblem::Workspace& workspace, bool once) { at_.scratch = problem.work_in(workspace, once); }
    /// Its arrays will be needed soon.
    void prefetch(SolveStage next) const;

    /// Starts a solve of `problem`, begun by the caller; the first trial is set.
    void start(const NewtonOptions& options, const ForceTerms& terms);
    /// Takes in the evaluation at problem.trial and decides: done, failed, or a new trial.
    /// @param finite  frames at the trial are finite, and force terms have been evaluated there
    void advance(bool finite, const ForceTerms& terms);

    /// Whether to end at the next trial that can be a state: see Solver::cut_when().
    void hurry(bool due) { at_.course.due = due; }
    /// Whether the solve was ended so.
    [[nodiscard]] bool cut_short() const { return at_.course.cut_short; }

    /// Calls `seen` for each trial after its decision. @param seen  outlives this; may be empty
    void watch(const std::function<void(const NewtonTrial&)>& seen) { seen_ = &seen; }

    /// After convergence, the terms' multipliers having changed: Newton continues from here.
    void resume();
    /// They have not settled, and will not: the system has failed, or takes its best state (best effort).
    void stop_short();
    /// Ends the solve as one that has failed.
    void abandon();

    [[nodiscard]] bool running() const { return at_.phase == Phase::Guess || at_.phase == Phase::Search; }
    [[nodiscard]] bool converged() const { return at_.phase == Phase::Done; }
    [[nodiscard]] SolveReport report(const WireProblem& wire) const;

    SystemProblem problem;

private:
    using Phase = NewtonIterate::Phase;

    // the first guess (newton_start.cpp)
    void set_guess(double fraction);

    // one trial
    bool decide(bool finite, const ForceTerms& terms);
    void tell(NewtonTrial trial, bool possible) const;
    void backtrack(double open);
    void follow(const NewtonAcceptance::Verdict& verdict);
    void more_shift();
    void take_base();
    void launch();

    // ends
    [[nodiscard]] bool ends_at_trial(const ForceTerms& terms);
    [[nodiscard]] bool can_be_state() const;
    [[nodiscard]] bool ends_when_due();
    [[nodiscard]] bool improves() const;
    [[nodiscard]] bool goes_round();
    void end_at_base();
    void take_linearised();
    void give_up();

    NewtonIterate at_;
    NewtonDirection direction_;
    NewtonKinks kinks_;
    NewtonAcceptance acceptance_;
    const std::function<void(const NewtonTrial&)>* seen_ = nullptr;
};

}  // namespace seldinger
