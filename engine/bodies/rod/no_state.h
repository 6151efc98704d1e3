#pragma once
// Rejects states that missed the solver's tolerance and whose forces would be arbitrary: drawn apart, crushed, or far from
// balance.

#include "rod/rod_view.h"

#include <cmath>

namespace seldinger {

/// Whether an edge is longer or shorter by more than half of its rest length and by more than 0.01 radii. The second limit is for
/// the base edge of a fed wire, which begins with length 0. A converged state of a soft band may meet both. A state that missed
/// the tolerance is then unusable: the forces on its nodes are arbitrary, and so is the hand's work. A stiff wire thrown head-on
/// against a wall at 0.5 m/s came to 1e11 N in an edge that the hand drew out.
[[nodiscard]] inline bool is_torn(const ConstRodView& rod)
{
    for (int j = 0; j + 1 < rod.n; ++j) {
        const double change = std::abs((rod.pos(j) - rod.pos(j + 1)).norm() - rod.rest_length[j]);
        if (change > 0.5 * rod.rest_length[j] && change > 0.01 * rod.radius[j]) return true;
    }
    return false;
}

/// Whether the unbalanced force would move a free node by more than the wire's radius within the step: h^2 |R| / m with the
/// wire's mean node. If contact jumps, the forces of such a state are those of the jump, not of the wire. Up to 6e4 N were
/// seen, in steps of 33 us. Flickering stick or creases leave 1e-3 N and move nothing by 1e-4 of its radius.
/// @param residual  largest of a node [N]   @param h  of the step [s]
[[nodiscard]] inline bool is_thrown(const ConstRodView& rod, double residual, double h)
{
    double mass = 0;
    for (int i = 0; i < rod.n; ++i) mass += rod.mass[i];
    return !(residual * h * h <= rod.radius[0] * mass / rod.n);
}

}  // namespace seldinger
