// Leaves unstable equilibria by a small perturbation along their softest mode.

#include "newton/newton_system.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

/// A step of backward Euler minimises its incremental potential. If the last exact matrix was not positive definite, the solution
/// may be a saddle: for example a straight column pushed far beyond its buckling load. No rounding error bends it, because nothing
/// leads out of its line. Asked once in a solve.
bool NewtonSystem::may_be_saddle() const
{
    return !options_.shifted && !options_.linearised && model_.projected_steps() > 0 && course_.mode_perturbations == 0 &&
           problem.motion == Motion::Implicit && !problem.conserving();
}

/// From the trial, whose equations hold. @return whether it was one
bool NewtonSystem::leave_saddle(const ForceTerms& terms)
{
    model_.set_shift_weights();
    const bool saddle = !model_.stable(terms);
    if (saddle) perturb_along_softest_mode();
    model_.shift = 0;
    model_.forget_projected_steps();
    return saddle;
}

/// Leaves an unstable equilibrium by 1 % of an edge along its softest mode, found by inverse iteration on the matrix that
/// LinearModel::stable() has assembled.
void NewtonSystem::perturb_along_softest_mode()
{
    ++course_.mode_perturbations;
    const int size = problem.size();
    for (int attempt = 0; attempt < 20; ++attempt)
        if (model_.raise_shift(4 * model_.shift) == 0) break;
    for (int i = 0; i < size; ++i) direction_[i] = std::sin(1.7 * i + 0.3);  // any vector that no mode is normal to
    for (int round = 0; round < 10; ++round) {
        for (int i = 0; i < size; ++i) direction_[i] *= problem.prescribed[i] ? 0.0 : model_.shift_weight(i);
        model_.solve(part(direction_));
        const double length = problem.norm(direction_);
        for (int i = 0; i < size; ++i) direction_[i] /= length;
    }
    const double edge = problem.length_scale();
    double downhill = 0, largest = 0;
    for (int i = 0; i < size; ++i) {
        if (!problem.prescribed[i]) downhill -= problem.residual[i] * direction_[i];
        largest = std::max(largest, std::abs(direction_[i]) * (RodDofs::is_spin(i) ? edge : 1.0));
    }
    const double step = (downhill < 0 ? -0.01 : 0.01) * edge / largest;
    for (int i = 0; i < size; ++i) problem.trial[i] += step * direction_[i];
    phase_ = Phase::Guess;
    course_.guess_fraction = 0;
}

}  // namespace seldinger
