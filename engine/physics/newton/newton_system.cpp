// The driver of Newton's method for one system: decision at each trial, new direction and trial. How it starts: newton_start.cpp.
#include "newton/newton_system.h"

#include "core/prefetch.h"
#include "rod/no_state.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

NewtonSystem::NewtonSystem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec)
    : problem(first_wire, capacities, spec),
      at_(problem.capacity()),
      direction_(problem, at_),
      kinks_(problem, at_, direction_),
      acceptance_(problem, at_, direction_, kinks_)
{
}

void NewtonSystem::prefetch(SolveStage next) const
{
    problem.prefetch(next);
    if (next != SolveStage::Advance) return;
    for (const auto* array : {&at_.base_q, &at_.base_residual, &at_.direction}) seldinger::prefetch(*array, problem.size());
    direction_.prefetch();
}

// ---- one trial --------------------------------------------------------------------------------------------------------------

void NewtonSystem::advance(bool finite, const ForceTerms& terms)
{
    if (!seen_ || !*seen_) {
        decide(finite, terms);
        return;
    }
    NewtonTrial trial;
    trial.iteration = at_.course.iterations;
    trial.projected = at_.phase != Phase::Guess && direction_.projected_steps() > 0;
    const bool possible = decide(finite, terms);
    tell(trial, possible);
}

void NewtonSystem::tell(NewtonTrial trial, bool possible) const
{
    using enum NewtonTrial::End;
    trial.residual = problem.residual_share();
    trial.end = at_.phase == Phase::Failed                  ? GivenUp
                : !possible                                ? Refused
                : at_.course.iterations > trial.iteration   ? Taken
                : running()                                ? TooLong
                : problem.balanced()                       ? Solved
                                                           : Settled;
    (*seen_)(trial);
}

/// @return whether the trial can be: it is finite, and force terms allow it
bool NewtonSystem::decide(bool finite, const ForceTerms& terms)
{
    ++at_.course.evaluations;
    at_.trial = {};
    if (finite) problem.ask(terms);
    if (!finite || !problem.admissible() || !problem.evaluate_residual(terms)) {
        at_.course.non_finite = at_.course.non_finite || !finite;
        if (at_.course.settling) at_.phase = Phase::Failed;
        else backtrack(finite ? problem.open() : 1);
        return false;
    }
    problem.note_residuals();
    at_.course.non_finite = false;
    if (at_.searching() && !at_.options.shifted && !at_.options.linearised) at_.trial.crossed = problem.crossed(terms);
    if (ends_when_due() || ends_at_trial(terms)) return true;
    if (at_.iterations() >= at_.options.max_iterations || goes_round()) {
        if (kinks_.at_kink()) at_.phase = Phase::Done;
        else give_up();
        return true;
    }
    const bool to_kinks = at_.trial.crossed.share < 1, keep = at_.trial.crossed.share == 1 && direction_.keeps_factors();
    take_base();
    problem.take(terms, to_kinks);
    direction_.find(keep, terms);
    launch();
    at_.along.admits = to_kinks;
    if (running()) direction_.chord_steps(terms);
    return true;
}

/// The trial cannot be: nearer to the last state that could. @param open  share of the path from there that is, as far as the
/// force terms know
void NewtonSystem::backtrack(double open)
{
    if (at_.searching()) return follow({NewtonAcceptance::Verdict::What::Shorter, acceptance_.after_refusal(open)});
    if (at_.course.guess_fraction == 0) return give_up();
    set_guess(++at_.course.backtracks < newton_constants.most_guesses ? 0.5 * at_.course.guess_fraction : 0.0);
}

void NewtonSystem::follow(const NewtonAcceptance::Verdict& verdict)
{
    using enum NewtonAcceptance::Verdict::What;
    switch (verdict.what) {
        case Taken:
        case Tried: return;
        case GivenUp: return give_up();
        case MoreShift: return more_shift();
        case Shorter: break;
    }
    at_.along.into_valley = verdict.into_valley;
    if (at_.options.shifted && verdict.alpha < 0.05 * at_.along.first_alpha) return more_shift();
    if (verdict.alpha < newton_constants.smallest_share) return give_up();
    direction_.set_trial(verdict.alpha);
}

void NewtonSystem::more_shift()
{
    if (direction_.raise_shift()) launch();
    else give_up();
}

void NewtonSystem::take_base()
{
    const int size = problem.size();
    if (at_.options.shifted && at_.searching()) direction_.lower_shift();
    at_.base.can_be_state = can_be_state();
    problem.set_base();
    at_.base.residual_share = problem.residual_share();
    at_.base.balanced = !at_.options.linearised && problem.balanced() && problem.may_improve() && problem.at_prescribed();
    if (at_.options.shifted && problem.far_from_reference()) problem.move_reference();
    std::copy_n(problem.trial.begin(), size, at_.base_q.begin());
    std::copy_n(problem.residual.begin(), size, at_.base_residual.begin());
    at_.phase = Phase::Search;
    ++at_.course.iterations;
}

/// The first trial on a new direction.
void NewtonSystem::launch()
{
    if (direction_.measure()) return direction_.set_trial(at_.along.first_alpha);
    give_up();
    at_.course.non_finite = true;
}

// ---- ends -------------------------------------------------------------------------------------------------------------------

/// Whether the residual of a trial that contact has admitted is small enough for a state.
bool NewtonSystem::can_be_state() const
{
    if (!at_.searching() || !problem.at_prescribed()) return false;
    const auto moves_little = [](const WireProblem* wire) { return !is_thrown(wire->rod, wire->norm, wire->time.step()); };
    return std::all_of(problem.solved().begin(), problem.solved().end(), moves_little);
}

/// The time is up: ends here, or at the base if that leaves less, where one of them can be a state. @return that is all
bool NewtonSystem::ends_when_due()
{
    NewtonIterate::Course& course = at_.course;
    if (!course.due || course.settling || at_.options.shifted || at_.options.linearised || problem.shares_centrelines() ||
        problem.balanced())
        return false;
    const bool here = can_be_state();
    if (!here && !at_.base.can_be_state) return false;
    course.cut_short = true;
    if (here && (!at_.base.can_be_state || problem.residual_share() <= at_.base.residual_share)) {
        at_.phase = Phase::Done;
        return true;
    }
    course.settling = true;
    std::copy_n(at_.base_q.begin(), problem.size(), problem.trial.begin());
    return true;
}

/// Converged, failed, or a new trial set without a new direction. @return whether that is all
bool NewtonSystem::ends_at_trial(const ForceTerms& terms)
{
    if (at_.course.settling) {
        at_.phase = Phase::Done;
        return true;
    }
    if (at_.options.linearised && at_.searching()) {
        take_linearised();
        return true;
    }
    // one linearised step is always taken: force terms evaluated the start, and their state must be the end's
    if (!at_.options.linearised && problem.balanced() && problem.at_prescribed()) {
        if (improves()) return false;
        if (at_.options.shifted ? direction_.rests(terms) : !direction_.leaves_saddle(terms)) at_.phase = Phase::Done;
        return true;
    }
    if (!at_.searching()) return false;
    if (at_.base.balanced) {
        end_at_base();
        return true;
    }
    const NewtonKinks::Jump jump = kinks_.jump_of_force(terms);
    if (jump == NewtonKinks::Jump::Passed) return false;
    if (jump == NewtonKinks::Jump::Turns) {
        at_.phase = Phase::Done;
        return true;
    }
    const NewtonAcceptance::Verdict verdict = acceptance_.judge(terms);
    if (verdict.what == NewtonAcceptance::Verdict::What::Taken) return false;
    follow(verdict);
    if (kinks_.at_kink()) at_.phase = Phase::Done;
    return true;
}

/// Forces in float round, most of the time by a tenth of the bound that always holds. A residual between the two is rounding, or
/// that of a step which one more iteration lowers by orders of magnitude: it is taken as long as each leaves less than half.
bool NewtonSystem::improves() const
{
    return problem.may_improve() &&
           (at_.phase == Phase::Guess || problem.residual_share() < newton_constants.improvement * at_.base.residual_share);
}

/// The base was balanced, but for rounding, and the trial is not: the base is the state.
void NewtonSystem::end_at_base()
{
    at_.course.settling = at_.course.rounded = true;
    std::copy_n(at_.base_q.begin(), problem.size(), problem.trial.begin());
}

/// Where no move may be longer than force terms have searched, a part of the step is no step: half the time is asked for instead.
/// Published detection has no such limit, and accepts any step.
void NewtonSystem::take_linearised()
{
    if (at_.along.alpha != 1 && !std::isinf(at_.course.move_limit)) return give_up();
    problem.take_linear_tensions();
    at_.phase = Phase::Done;
}

/// Whether the last bases come again and again in turn: a contact that two corrections of the longest permitted move lead over an
/// edge and back.
bool NewtonSystem::goes_round()
{
    if (!at_.searching() || at_.options.shifted) return false;
    NewtonIterate::Course& course = at_.course;
    const double now = problem.residual_share();
    double& before = course.residual_shares[course.iterations % 2];
    course.same_again = std::abs(now - before) <= newton_constants.same_residual * now ? course.same_again + 1 : 0;
    before = now;
    return course.same_again >= newton_constants.most_same;
}

/// Out of ideas. Best effort: back to the last accepted trial, which is nearer to the solution than the start by the tests that
/// accepted it, and admissible. One more evaluation gives the force terms this trial.
void NewtonSystem::give_up()
{
    NewtonIterate::Course& course = at_.course;
    if (at_.base.balanced && at_.searching() && !course.settling) return end_at_base();
    if (!at_.options.best_effort || course.settling || course.iterations == 0 || !at_.searching()) {
        at_.phase = Phase::Failed;
        return;
    }
    course.settling = true;
    std::copy_n(at_.base_q.begin(), problem.size(), problem.trial.begin());
    problem.set_prescribed();
}

}  // namespace seldinger
