// Leaves unstable equilibria by a small perturbation along their softest mode.
#include "newton/direction.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

bool NewtonDirection::rests(const ForceTerms& terms)
{
    if (at_.course.mode_perturbations >= newton_constants.most_perturbations || model_.stable(terms)) return true;
    perturb_along_softest_mode();
    return false;
}

/// If the last exact matrix of a step in time was not positive definite, the solution may be a saddle: for example a straight
/// column pushed far beyond its buckling load. No rounding error bends it, because nothing leads out of its line.
bool NewtonDirection::leaves_saddle(const ForceTerms& terms)
{
    const bool may_be = !at_.options.shifted && !at_.options.linearised && model_.projected_steps() > 0 &&
                        at_.course.mode_perturbations == 0 && problem_.motion == Motion::Implicit && !problem_.conserving();
    if (!may_be) return false;
    model_.set_shift_weights();
    const bool saddle = !model_.stable(terms);
    if (saddle) perturb_along_softest_mode();
    model_.shift = 0;
    model_.forget_projected_steps();
    return saddle;
}

/// The trial leaves its equilibrium by 1 % of an edge along the softest mode, found by inverse iteration on the matrix that
/// LinearModel::stable() has assembled.
void NewtonDirection::perturb_along_softest_mode()
{
    ++at_.course.mode_perturbations;
    const int size = problem_.size();
    std::vector<double>& mode = at_.direction;
    for (int attempt = 0; attempt < 20; ++attempt)
        if (model_.raise_shift(4 * model_.shift) == 0) break;
    for (int i = 0; i < size; ++i) mode[i] = std::sin(1.7 * i + 0.3);  // any vector that no mode is normal to
    for (int round = 0; round < 10; ++round) {
        for (int i = 0; i < size; ++i) mode[i] *= problem_.prescribed[i] ? 0.0 : model_.shift_weight(i);
        model_.solve(part(mode));
        const double length = problem_.norm(mode);
        for (int i = 0; i < size; ++i) mode[i] /= length;
    }
    const double edge = problem_.length_scale();
    double downhill = 0, largest = 0;
    for (int i = 0; i < size; ++i) {
        if (!problem_.prescribed[i]) downhill -= problem_.residual[i] * mode[i];
        largest = std::max(largest, std::abs(mode[i]) * (RodDofs::is_spin(i) ? edge : 1.0));
    }
    const double step = (downhill < 0 ? -newton_constants.perturbation : newton_constants.perturbation) * edge / largest;
    for (int i = 0; i < size; ++i) problem_.trial[i] += step * mode[i];
    at_.phase = NewtonIterate::Phase::Guess;
    at_.course.guess_fraction = 0;
}

}  // namespace seldinger
