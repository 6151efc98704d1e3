#pragma once
// Rotations that carry frames along a wire and through time: parallel transport, angles about an axis, unwrapping.

#include "rod/wire_spec.h"

#include <cmath>
#include <numbers>

namespace seldinger {

/// Below this 1 + cos(angle) two tangents count as folded: at 1e-10 they are within 1.4e-5 rad of opposite, and te x tf has
/// lost half of its digits. A wire that folds has infinite bending energy, so a converged state is never near.
constexpr double fold_limit = 1e-10;

/// 1 + a.b of two unit vectors, = |a + b|^2 / 2, which keeps its digits near a fold.
inline double one_plus_cos(const Vec3& a, const Vec3& b) { return 0.5 * (a + b).squaredNorm(); }

/// Parallel transport of v, normal to the unit vector `from`, to the unit vector `to`: the smallest rotation that takes
/// `from` to `to`.  P v = v - (v.to) (from + to) / (1 + from.to)   [Bergou08, sec. 4.2.2], for v.from = 0
/// @param chi  1 + from.to, > 0
inline Vec3 parallel_transport(const Vec3& v, const Vec3& from, const Vec3& to, double chi)
{
    return v - (v.dot(to) / chi) * (from + to);
}

/// Angle from unit u to unit v, both normal to the unit `axis`, counted about it, in (-pi, pi].
inline double signed_angle(const Vec3& u, const Vec3& v, const Vec3& axis) { return std::atan2(u.cross(v).dot(axis), u.dot(v)); }

/// The value equal to `angle` up to whole turns that lies nearest to `last`.
inline double unwrap(double angle, double last)
{
    constexpr double turn = 2 * std::numbers::pi;
    return angle + turn * std::nearbyint((last - angle) / turn);
}

/// v, normal to the unit `axis`, turned about it by `angle`.
inline Vec3 turned(const Vec3& v, const Vec3& axis, double angle)
{
    return std::cos(angle) * v + std::sin(angle) * axis.cross(v);
}

/// `v` made normal to the unit `axis` and of unit length; any normal when v is (nearly) parallel to the axis.
inline Vec3 unit_normal(const Vec3& v, const Vec3& axis)
{
    const Vec3 part = v - v.dot(axis) * axis;
    if (part.squaredNorm() > 1e-12 * v.squaredNorm()) return part.normalized();
    Vec3 other = Vec3::Unit(0);
    if (std::abs(axis.x()) > 0.8) other = Vec3::Unit(1);
    return (other - other.dot(axis) * axis).normalized();
}

/// A director of the unit vector `from`, carried to `to`; where these are opposite, it is normal to both.
inline Vec3 carried_director(const Vec3& director, const Vec3& from, const Vec3& to)
{
    const double chi = one_plus_cos(from, to);
    return unit_normal(chi > 0 ? parallel_transport(director, from, to, chi) : director, to);
}

}  // namespace seldinger
