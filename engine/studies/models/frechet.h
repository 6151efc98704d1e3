#pragma once
// Distance of two curves.

#include "math/vec3.h"

#include <span>

namespace seldinger {

/// Fréchet distance of two polylines [m]: the shortest leash with which one can walk along `a` and another along `b`, both from
/// start to end and never backwards. Exact for polylines (not only at their vertices) to `relative` of the result: bisection over
/// the free-space diagram of [Alt95]. O(n m) at worst per bisection, O(n + m) for curves that are close.
[[nodiscard]] double frechet_distance(std::span<const Vec3> a, std::span<const Vec3> b, double relative = 1e-6);

}  // namespace seldinger
