// The direction from a base, its first trial, chord steps, and the shift of statics.
#include "newton/direction.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

/// Trials until a residual of so many tolerances is within one, if each leaves `rate` of it.
double trials_left(double residual, double rate) { return std::ceil(std::log(residual) / -std::log(rate)); }

}  // namespace

/// The direction is then the correction that they gave for the trial. They serve if they need no more trials than new ones would.
/// Only instruments that touch keep them: their factors cost more than the test, and their tangent is incomplete (the motion of
/// Gauss points).
bool NewtonDirection::keeps_factors() const
{
    const bool has_full_correction =
        at_.trial.contraction && at_.searching() && at_.along.alpha == 1 && !at_.options.shifted && problem_.at_prescribed();
    if (!has_full_correction || !problem_.keeps_tangent() || at_.iterations() > newton_constants.most_kept) return false;
    // corrections in metres may shrink while forces on a short stiff edge hardly fall: the slower of the two counts
    const double residual = problem_.residual_share(),
                 rate = std::max(*at_.trial.contraction, residual / at_.base.residual_share);
    return rate <= newton_constants.kept_contraction &&
           trials_left(residual, std::max(rate, 1e-6)) <= trials_left(residual, newton_constants.new_contraction);
}

void NewtonDirection::find(bool keep, const ForceTerms& terms)
{
    if (keep) {
        std::copy_n(at_.correction.begin(), problem_.size(), at_.direction.begin());
        return;
    }
    if (at_.options.shifted) model_.factorise_shifted(terms);
    else model_.factorise(at_.along.alpha < at_.along.first_alpha, terms);
    model_.correction(problem_.residual, part(at_.direction), 1);
}

bool NewtonDirection::measure()
{
    at_.along = {};
    at_.along.norm = problem_.norm(at_.direction);
    if (!std::isfinite(at_.along.norm) || (at_.along.norm == 0 && !at_.options.linearised)) return false;
    at_.along.slope = problem_.residual_along(at_.direction);
    const double move = problem_.largest_move(at_.direction), turn = problem_.largest_turn(at_.direction);
    double& first = at_.along.first_alpha;
    if (move > at_.course.move_limit) first = at_.course.move_limit / move;
    if (turn * first > newton_constants.largest_edge_turn) first = newton_constants.largest_edge_turn / turn;
    return true;
}

void NewtonDirection::set_trial(double alpha)
{
    at_.along.alpha = alpha;
    problem_.predict_tension(at_.direction, alpha);
    for (int i = 0; i < problem_.size(); ++i) problem_.trial[i] = at_.base_q[i] + alpha * at_.direction[i];
    if (alpha == 1) problem_.set_prescribed();
}

void NewtonDirection::chord_steps(const ForceTerms& terms)
{
    if (at_.along.alpha != 1 || at_.options.linearised || at_.options.pseudo_transient) return;
    double last = at_.along.norm;
    for (int k = 0; k < newton_constants.most_chord_steps; ++k) {
        const bool usable = problem_.update() && problem_.evaluate_linear_terms(terms, at_.base_q);
        if (usable && problem_.residual_below(newton_constants.chord_enough)) return;
        if (usable) correct();
        const double size = problem_.norm(at_.correction);
        if (!usable || !(size < newton_constants.chord_contraction * last) || (model_.shift > 0 && size < 1e-3 * at_.along.norm))
            return;
        last = size;
        problem_.correct_tension(at_.correction);
        for (int i = 0; i < problem_.size(); ++i) problem_.trial[i] += at_.correction[i];
    }
}

/// With a shift, that of the shifted problem, a pseudo-time step R(q) + shift (q - base) = 0: leaving a saddle must not look like
/// a failure because R grows.
void NewtonDirection::correct()
{
    problem_.mixed_residual(part(at_.scratch));
    if (model_.shift > 0)
        for (int i = 0; i < problem_.size(); ++i)
            at_.scratch[i] += model_.shift * model_.shift_weight(i) * (problem_.trial[i] - at_.base_q[i]);
    model_.correction(at_.scratch, part(at_.correction), 1 - at_.along.alpha);
}

void NewtonDirection::solve(std::span<double> x)
{
    for (int i = 0; i < problem_.size(); ++i)
        if (problem_.prescribed[i]) x[i] = 0;
    model_.solve(x);
}

void NewtonDirection::lower_shift()
{
    if (at_.options.pseudo_transient) model_.shift *= newton_constants.pseudo_time_growth;
    else if (at_.along.alpha == at_.along.first_alpha) model_.shift *= at_.trial.contraction < 0.5 ? 0.1 : 0.5;
    if (model_.shift < newton_constants.smallest_shift) model_.shift = 0;
}

bool NewtonDirection::raise_shift()
{
    const double larger = std::max(10 * model_.shift, 10 * newton_constants.smallest_shift);
    if (larger > newton_constants.largest_shift) return false;
    (void)model_.raise_shift(larger);
    std::copy_n(at_.base_q.begin(), problem_.size(), problem_.trial.begin());
    std::copy_n(at_.base_residual.begin(), problem_.size(), problem_.residual.begin());
    model_.correction(problem_.residual, part(at_.direction), 1);
    return true;
}

}  // namespace seldinger
