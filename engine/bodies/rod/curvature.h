#pragma once
// From a turning angle to curvature: the scalar that (D2) squares.
//
// Edges that meet at a node turn by phi. Any f(phi) = phi + O(phi^3) is an integrated curvature of second order; which one
// decides the size of the error where a wire is strongly bent. All of the family
//
//     f^2 = |kb|^2 (1 - q sin^2(phi/2)),   |kb| = 2 tan(phi/2),   chi = 1 + cos(phi) = 2 cos^2(phi/2)
//
// are rational in chi, smooth in a straight wire, and infinite in a folded one for q < 1. f = phi (1 + a phi^2), a = 1/12 - q/8:
//
//     q = 0    2 tan(phi/2), as published [Bergou08]: a = 1/12, the moment is high by (kappa h)^2/3
//     q = 2/3  Angle, the default: a = 0, phi itself but for 7 phi^5/1440 (1e-4 of it at 45 degrees)
//
// Why the angle. In a plane B theta'' = P sin(theta) becomes B (delta^2 theta)/h^2 + 12 a B h^2 theta'^2 theta'' + ... = P
// sin(theta), and its error is h^2 theta'' [C/12 + (12 a - 1/8) theta'^2], C a constant of the solution: seven times less with a
// = 0 where bending is strong. An arc of natural curvature k turns by exactly k h a node. A localised helix, where bending
// balances torque, has 1/3 of the error (docs/validation.md). [Bergou08] notes that the choice is free; 2 sin(phi/2), q = 1,
// would fold without resistance.

#include "rod/wire_spec.h"

#include <cmath>

namespace seldinger {

/// q of the family above.
inline double curvature_q(CurvatureMeasure measure) { return measure == CurvatureMeasure::Angle ? 2.0 / 3.0 : 0.0; }

/// g^2 = (f/|kb|)^2 = 1 - q sin^2(phi/2).
inline double curvature_factor_squared(double q, double chi) { return 1 - q + 0.5 * q * chi; }
inline double curvature_factor(double q, double chi) { return std::sqrt(curvature_factor_squared(q, chi)); }

/// f^2, from the curvature binormal.
inline double squared_curvature(double q, double chi, const Vec3& kb)
{
    return curvature_factor_squared(q, chi) * kb.squaredNorm();
}

/// W = f^2/2 = 2 (1 - q)(2 - chi)/chi + q (2 - chi): first and second derivative with respect to chi.
inline double bend_slope(double q, double chi) { return -4 * (1 - q) / (chi * chi) - q; }
inline double bend_slope_rate(double q, double chi) { return 8 * (1 - q) / (chi * chi * chi); }

}  // namespace seldinger
