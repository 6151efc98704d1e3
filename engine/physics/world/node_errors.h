#pragma once
// How far the finite length of edges has the forces at the hands of instruments that share a centreline, and the energy of a
// stretch of wire.

#include "engine.h"

namespace seldinger {

/// The force at such a hand is that of its instrument's boundaries: where it ends, or changes its section (merged.h). A push
/// moves them along the centreline of moment M(s) and changes the energy by
///
///     F = M^2/2 [1/B] + M [r]                   [ ]: jump across one; B: stiffness, r: natural curvature of all instruments together
///
/// A cell has one moment M_i, wherever in it the boundary is. M there differs from M_i by up to half the difference D to a
/// neighbour's, so
///
///     dF <= [1/B] (|M_i| D + D^2/4)/2 + [r] D/2  [N]
///
/// summed over its boundaries. The leader, whose push moves the boundaries of all others, has the sum of theirs. It is of first
/// order in the length of edges, and swings as a boundary passes from cell to cell. 0 of a wire alone.
[[nodiscard]] double hand_error(const World& world, int wire);

/// World::bending_error() of the nodes between two distances from the tip, both nodes next to these among them.
[[nodiscard]] BendingError bending_error_between(const World& world, int wire, double from, double to);

}  // namespace seldinger
