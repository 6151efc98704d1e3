// Pseudo-transient continuation: with a shift s on the diagonal an iteration is a step of length 1/s in the pseudo-time of
// W q' = -R(q), W the weights of the shift. Large shifts follow the wire downhill, none is Newton's method.

#include "newton/newton_system.h"

#include <algorithm>

namespace seldinger {

/// Equilibrium: trusts the model more after a good full step.
void NewtonSystem::adapt_shift()
{
    if (options_.pseudo_transient) model_.shift *= 0.7;
    else if (along_.alpha == along_.first_alpha) model_.shift *= at_trial_.contraction < 0.5 ? 0.1 : 0.5;
    if (model_.shift < LinearModel::smallest_shift) model_.shift = 0;
}

/// The direction failed at any useful length: a shorter, more downhill one from the same base.
void NewtonSystem::raise_shift()
{
    const double larger = std::max(10 * model_.shift, 10 * LinearModel::smallest_shift);
    if (larger > 1e15) {
        give_up();
        return;
    }
    (void)model_.raise_shift(larger);
    std::copy_n(base_.begin(), problem.size(), problem.trial.begin());
    std::copy_n(base_residual_.begin(), problem.size(), problem.residual.begin());
    model_.correction(problem.residual, part(direction_), 1);
    launch();
}

}  // namespace seldinger
