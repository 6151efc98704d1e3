#pragma once
// Whether a wire is drawn apart or crushed, as no state of it is.

#include "rod/rod_view.h"

#include <cmath>

namespace seldinger {

/// Whether an edge is longer or shorter by more than half of its rest length, and by more than a misplaced node makes of a short one (a hundredth of the
/// radius: the base edge of a wire that is fed begins at nothing). What converged may be so, of a soft band; what missed the tolerance is then no
/// state: forces on its nodes are anything, and the hand's work with them (a stiff wire thrown head-on against a wall at 0.5 m/s came to 1e11 N
/// in an edge that the hand drew out).
[[nodiscard]] inline bool is_torn(const ConstRodView& rod)
{
    for (int j = 0; j + 1 < rod.n; ++j) {
        const double change = std::abs((rod.pos(j) - rod.pos(j + 1)).norm() - rod.rest_length[j]);
        if (change > 0.5 * rod.rest_length[j] && change > 0.01 * rod.radius[j]) return true;
    }
    return false;
}

}  // namespace seldinger
