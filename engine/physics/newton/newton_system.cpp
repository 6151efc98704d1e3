// The driver of Newton's method for one system: decision at each trial, new direction and trial. How it starts: newton_start.cpp.

#include "newton/newton_system.h"

#include "core/prefetch.h"
#include "rod/no_state.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr int most_chord_steps = 4;
constexpr int most_mode_perturbations = 3;
// for keeps_factors(), what a trial leaves of the correction before it
constexpr double most_contraction = 0.03;   // with kept factors, at most
constexpr double new_factors = 1.0 / 300;   // with new ones, about
constexpr int most_kept = 3;                // iterations after which a step is none of those that go well
constexpr double same_residual = 5e-3;     // relative: of a base that comes again, in a circle of two or four
constexpr int most_same = 6;  // fewer end searches of long steps that would come out of it

/// Trials until a residual of so many tolerances is within one, if each leaves `rate` of it.
double trials_left(double residual, double rate) { return std::ceil(std::log(residual) / -std::log(rate)); }

}  // namespace

NewtonSystem::NewtonSystem(int first_wire, std::span<const int> capacities, const IntegratorSpec& spec)
    : problem(first_wire, capacities, spec), model_(problem)
{
    for (auto* array : {&base_, &base_residual_, &direction_, &correction_, &guess_}) array->resize(problem.capacity());
}

void NewtonSystem::prefetch(SolveStage next) const
{
    problem.prefetch(next);
    if (next != SolveStage::Advance) return;
    for (const auto* array : {&base_, &base_residual_, &direction_}) seldinger::prefetch(*array, problem.size());
    model_.prefetch();
}

// ---- one iteration ----------------------------------------------------------------------------------------------------------

void NewtonSystem::advance(bool finite, const ForceTerms& terms)
{
    if (!seen_ || !*seen_) {
        decide(finite, terms);
        return;
    }
    NewtonTrial trial;
    const bool guess = phase_ == Phase::Guess;
    trial.iteration = course_.iterations;
    trial.alpha = guess ? course_.guess_fraction : along_.alpha;
    trial.move = trial.alpha * problem.largest_move(guess ? guess_ : direction_);
    trial.projected = !guess && model_.projected_steps() > 0;
    const bool possible = decide(finite, terms);
    tell(trial, possible);
}

void NewtonSystem::tell(NewtonTrial trial, bool possible) const
{
    using enum NewtonTrial::End;
    trial.residual = problem.residual_share();
    trial.contraction = at_trial_.contraction.value_or(0);
    trial.end = phase_ == Phase::Failed                 ? GivenUp
                : !possible                             ? Refused
                : course_.iterations > trial.iteration   ? Taken
                : running()                             ? TooLong
                : problem.balanced()                    ? Solved
                                                        : Settled;
    (*seen_)(trial);
}

/// @return whether the trial can be: it is finite, and force terms allow it
bool NewtonSystem::decide(bool finite, const ForceTerms& terms)
{
    ++course_.evaluations;
    at_trial_ = {};
    if (finite) problem.ask(terms);
    if (!finite || !problem.admissible() || !problem.evaluate_residual(terms)) {
        course_.non_finite = course_.non_finite || !finite;
        if (course_.settling) phase_ = Phase::Failed;
        else backtrack(finite ? problem.open() : 1);
        return false;
    }
    problem.note_residuals();
    course_.non_finite = false;
    const bool asked = phase_ == Phase::Search && !options_.shifted && !options_.linearised;
    if (asked) at_trial_.crossed = problem.crossed(terms);
    if (ends_when_due() || ends_at_trial(terms)) return true;
    if (course_.iterations - course_.first_iteration >= options_.max_iterations || goes_round()) {
        if (at_kink()) phase_ = Phase::Done;
        else give_up();
        return true;
    }
    const bool keep = at_trial_.crossed.share == 1 && keeps_factors();
    take_base();
    problem.take(terms, at_trial_.crossed.share < 1);
    if (keep) std::copy_n(correction_.begin(), problem.size(), direction_.begin());
    else new_direction(terms);
    launch();
    along_.admits = at_trial_.crossed.share < 1;
    chord_steps(terms);
    return true;
}

/// Whether the last factors serve for the next direction too: it is then the correction that they gave for the trial. They serve
/// if they need no more trials than new ones would. Only instruments that touch keep them: their factors cost more than the test, and
/// their tangent is incomplete (the motion of Gauss points).
bool NewtonSystem::keeps_factors() const
{
    const bool has_full_correction = at_trial_.contraction && phase_ == Phase::Search && along_.alpha == 1 && !options_.shifted && problem.at_prescribed();
    if (!has_full_correction || !problem.keeps_tangent() || course_.iterations - course_.first_iteration > most_kept) return false;
    // corrections in metres may shrink while forces on a short stiff edge hardly fall: the slower of the two counts
    const double residual = problem.residual_share(), rate = std::max(*at_trial_.contraction, residual / at_base_.residual_share);
    return rate <= most_contraction && trials_left(residual, std::max(rate, 1e-6)) <= trials_left(residual, new_factors);
}

/// Whether the residual of a trial that contact has admitted is small enough for a state.
bool NewtonSystem::can_be_state() const
{
    if (phase_ != Phase::Search || !problem.at_prescribed()) return false;
    const auto moves_little = [](const WireProblem* wire) { return !is_thrown(wire->rod, wire->norm, wire->time.step()); };
    return std::all_of(problem.solved().begin(), problem.solved().end(), moves_little);
}

/// The time is up: ends here, or at the base if that leaves less, where one of them can be a state. @return that is all
bool NewtonSystem::ends_when_due()
{
    if (!course_.due || course_.settling || options_.shifted || options_.linearised || problem.shares_centrelines() || problem.balanced()) return false;
    const bool here = can_be_state();
    if (!here && !at_base_.can_be_state) return false;
    course_.cut_short = true;
    if (here && (!at_base_.can_be_state || problem.residual_share() <= at_base_.residual_share)) {
        phase_ = Phase::Done;
        return true;
    }
    course_.settling = true;
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
    return true;
}

/// Converged, failed, or a new trial set without a new direction. @return whether that is all
bool NewtonSystem::ends_at_trial(const ForceTerms& terms)
{
    if (course_.settling) {
        phase_ = Phase::Done;
        return true;
    }
    if (options_.linearised && phase_ == Phase::Search) {
        take_linearised();
        return true;
    }
    // one linearised step is always taken: force terms evaluated the start, and their state must be the end's
    if (!options_.linearised && problem.balanced() && problem.at_prescribed()) {
        if (improves()) return false;
        if (options_.shifted && course_.mode_perturbations < most_mode_perturbations && !model_.stable(terms))
            perturb_along_softest_mode();
        else if (!may_be_saddle() || !leave_saddle(terms)) phase_ = Phase::Done;
        return true;
    }
    if (phase_ != Phase::Search) return false;
    if (at_base_.balanced) {
        end_at_base();
        return true;
    }
    const Jump jump = jump_of_force(terms);
    if (jump == Jump::Turns) {
        phase_ = Phase::Done;
        return true;
    }
    if (jump == Jump::Passed || acceptable(terms)) return false;
    if (at_kink()) phase_ = Phase::Done;
    return true;
}

/// Forces in float round, most of the time by a tenth of the bound that always holds. A residual between the two is rounding, or
/// that of a step which one more iteration lowers by orders of magnitude: it is taken as long as each leaves less than half.
bool NewtonSystem::improves() const
{
    return problem.may_improve() && (phase_ == Phase::Guess || problem.residual_share() < 0.5 * at_base_.residual_share);
}

/// The base was balanced, but for rounding, and the trial is not: the base is the state.
void NewtonSystem::end_at_base()
{
    course_.settling = course_.rounded = true;
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
}

/// Where no move may be longer than force terms have searched, a part of the step is no step: half the time is asked for instead.
/// Published detection has no such limit, and accepts any step.
void NewtonSystem::take_linearised()
{
    if (along_.alpha != 1 && !std::isinf(course_.move_limit)) return give_up();
    problem.take_linear_tensions();
    phase_ = Phase::Done;
}

/// Whether the last bases come again and again in turn: a contact that two corrections of the longest permitted move lead over an edge
/// and back.
bool NewtonSystem::goes_round()
{
    if (phase_ != Phase::Search || options_.shifted) return false;
    const double now = problem.residual_share();
    double& before = course_.residual_shares[course_.iterations % 2];
    course_.same_again = std::abs(now - before) <= same_residual * now ? course_.same_again + 1 : 0;
    before = now;
    return course_.same_again >= most_same;
}

/// Out of ideas. Best effort: back to the last accepted trial, which is nearer to the solution than the start by the tests that
/// accepted it, and admissible. One more evaluation gives the force terms this trial.
void NewtonSystem::give_up()
{
    if (at_base_.balanced && phase_ == Phase::Search && !course_.settling) return end_at_base();
    if (!options_.best_effort || course_.settling || course_.iterations == 0 || phase_ != Phase::Search) {
        phase_ = Phase::Failed;
        return;
    }
    course_.settling = true;
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
    problem.set_prescribed();
}

void NewtonSystem::take_base()
{
    const int size = problem.size();
    if (options_.shifted && phase_ == Phase::Search) adapt_shift();
    at_base_.can_be_state = can_be_state();
    problem.set_base();
    at_base_.residual_share = problem.residual_share();
    at_base_.balanced = !options_.linearised && problem.balanced() && problem.may_improve() && problem.at_prescribed();
    if (options_.shifted && problem.far_from_reference()) problem.move_reference();
    std::copy_n(problem.trial.begin(), size, base_.begin());
    std::copy_n(problem.residual.begin(), size, base_residual_.begin());
    phase_ = Phase::Search;
    ++course_.iterations;
}

void NewtonSystem::new_direction(const ForceTerms& terms)
{
    if (options_.shifted) model_.factorise_shifted(terms);
    else model_.factorise(along_.alpha < along_.first_alpha, terms);
    model_.correction(problem.residual, part(direction_), 1);
}

void NewtonSystem::launch()
{
    along_ = {};
    along_.norm = problem.norm(direction_);
    if (!std::isfinite(along_.norm) || (along_.norm == 0 && !options_.linearised)) {
        give_up();
        course_.non_finite = true;
        return;
    }
    along_.slope = problem.residual_along(direction_);
    const double move = problem.largest_move(direction_), turn = problem.largest_turn(direction_);
    if (move > course_.move_limit) along_.first_alpha = course_.move_limit / move;
    if (turn * along_.first_alpha > largest_edge_turn) along_.first_alpha = largest_edge_turn / turn;
    set_trial(along_.first_alpha);
}

/// Further simplified corrections (chord steps: the factors stay) with force terms linear, while they shrink fast.
void NewtonSystem::chord_steps(const ForceTerms& terms)
{
    if (!running() || along_.alpha != 1 || options_.linearised || options_.pseudo_transient) return;
    double last = along_.norm;
    for (int k = 0; k < most_chord_steps; ++k) {
        const bool usable = problem.update() && problem.evaluate_linear_terms(terms, base_);
        if (usable && problem.residual_below(0.5)) return;
        if (usable) correct();
        const double size = problem.norm(correction_);
        if (!usable || !(size < 0.3 * last) || (model_.shift > 0 && size < 1e-3 * along_.norm)) return;
        last = size;
        problem.correct_tension(correction_);
        for (int i = 0; i < problem.size(); ++i) problem.trial[i] += correction_[i];
    }
}

void NewtonSystem::set_trial(double alpha)
{
    along_.alpha = alpha;
    problem.predict_tension(direction_, alpha);
    for (int i = 0; i < problem.size(); ++i) problem.trial[i] = base_[i] + alpha * direction_[i];
    if (alpha == 1) problem.set_prescribed();
}

}  // namespace seldinger
