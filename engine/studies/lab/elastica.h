#pragma once
// The analytic reference of a cantilever: the plane extensible elastica.

#include "rod/wire_spec.h"

#include <vector>

namespace seldinger {

/// Shape of a straight wire, clamped at `base` along `direction`, under a dead force at its tip:
///     B theta'' = -(1 + e) (t x F),  r' = (1 + e) t,  e = F.t / EA,  theta(0) = 0, theta'(L) = 0
/// solved by shooting on the clamp's moment (RK4, bisection). The branch next to the unloaded shape.
/// @param section  uniform; only bend and stretch stiffness are used
/// @param points  of the returned polyline, tip first; their error is below 1e-10 L, that of the chords between them kappa h^2 /
/// 8
[[nodiscard]] std::vector<Vec3> elastica_shape(const WireSection& section, double length, const Vec3& base, const Vec3& direction,
                                               const Vec3& force, int points);

}  // namespace seldinger
