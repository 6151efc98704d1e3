#pragma once
// The elastic force of one step of an energy-momentum scheme: a discrete gradient of (D1-D3).
//
// For any two configurations q0, q1 it gives G with
//     G.(q1 - q0) = E(q1) - E(q0)     exactly, however far they are apart,
// and G -> dE/dq as q1 -> q0, to second order at the middle of the step. With v1 + v0 = 2 (q1 - q0)/h and M (v1 - v0)/h = -G the
// energy is then conserved to rounding and the solver's tolerance, whatever the step [Gonzalez96], [SimoTarnow92].
//
// E is a sum of functions of scalars that are bilinear in vectors: lengths |e|^2, products of edges e.f, and of tangents and
// directors t.d. For such a product  Delta(a.b) = mean(a).Delta b + mean(b).Delta a,  and for a function of it a quotient of
// differences that is written so that nothing is lost when the differences vanish. Edges enter by themselves; a director's change
// over the step is Delta d = Omega x mean(d), exactly, with one vector Omega for the three vectors of a frame: [mean(t) x Delta t
// + 2 tan(Delta theta/2) mean(t)]/|mean(t)|^2. So a product of directors loads its two edges with opposite moments +-mean(d_e) x
// mean(d_f).
//
// Linear momentum: G is made of pairs of opposite forces. Angular momentum: every product exerts no net moment about the mean
// positions, and a moment's action along an edge is its spin's. So the sum of x x m v and of spins is kept up to two small terms.
// The first is the turning of the spins' axes, whose gyroscopic moments (D4) leaves out. The second is the moment of products of
// directors (natural curvature, twist) times an edge's relative change of length over the step, 1e-6 and less. A naturally
// straight wire without twist keeps the sum exactly.

#include "rod/elastic.h"

namespace seldinger {

/// Adds G [4n] between the accepted state of `rod` and a trial. O(n), no allocation.
/// @param before   frames of the accepted state, after: of the trial; both with the clamps of the end of the step, so that a
/// clamp that
///                 moved has done its work at the start of it
/// @param base_grown  rest length that the base edge has gained over the step, of which `rod` has the end's [m]
/// @param turned   [n-1] theta of the trial less that of the accepted state [rad]
void add_discrete_gradient(const RodView& rod, std::span<const RodClamp> clamps, const RodFrames& before, const RodFrames& after,
                           std::span<const double> turned, std::span<double> gradient, double base_grown = 0);

/// Correction of the mean length of a fed edge for its mean strain. The start's length l0 was strained against the start's rest
/// length l - grown, so the strain's mean is ((l0 + l1)/2 + this)/l - 1. [m]
inline double feed_stretch(const RodView& rod, const RodFrames& before, int j, double base_grown)
{
    if (j != rod.n - 2 || base_grown == 0) return 0;
    return 0.5 * before.edge_length[j] * base_grown / (rod.rest_length[j] - base_grown);
}

/// Mean direction of an edge over a step, (e0 + e1)/(l0 + l1): the line along which its tension acts.
inline Vec3 mean_direction(const RodFrames& before, const RodFrames& after, int j)
{
    const double l0 = before.edge_length[j], l1 = after.edge_length[j];
    return (l0 * before.tangent[j] + l1 * after.tangent[j]) / (l0 + l1);
}

}  // namespace seldinger
