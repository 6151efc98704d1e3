#pragma once
// Points, rays and one triangle, in double precision.

#include "vessel/wall_mesh.h"

#include <cmath>

namespace seldinger {

struct Triangle3 {
    Vec3 a, b, c;
};

/// Where on a triangle a point lies: 0 inside the face; 1, 2, 3 on edge ab, bc, ca; 4, 5, 6 at vertex a, b, c.
enum class TriangleFeature : int { Face = 0, EdgeAb, EdgeBc, EdgeCa, VertexA, VertexB, VertexC };

struct ClosestPoint {
    Vec3 point;
    TriangleFeature feature = TriangleFeature::Face;
};

/// Closest point of a triangle by Voronoi regions [Ericson, Real-Time Collision Detection (2005), sec. 5.1.5].
[[nodiscard]] inline ClosestPoint closest_point(const Vec3& p, const Triangle3& t)
{
    const Vec3 ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return {t.a, TriangleFeature::VertexA};
    const Vec3 bp = p - t.b;
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return {t.b, TriangleFeature::VertexB};
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {t.a + d1 / (d1 - d3) * ab, TriangleFeature::EdgeAb};
    const Vec3 cp = p - t.c;
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return {t.c, TriangleFeature::VertexC};
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {t.a + d2 / (d2 - d6) * ac, TriangleFeature::EdgeCa};
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return {t.b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t.c - t.b), TriangleFeature::EdgeBc};
    const double inv = 1.0 / (va + vb + vc);
    return {t.a + vb * inv * ab + vc * inv * ac, TriangleFeature::Face};
}

/// Twice the vector area: length 2 A [m^2], direction of the right-hand normal.
[[nodiscard]] inline Vec3 double_area(const Triangle3& t) { return (t.b - t.a).cross(t.c - t.a); }

[[nodiscard]] inline Triangle3 triangle_of(const WallMesh& mesh, std::size_t t)
{
    const auto& v = mesh.triangles[t];
    return {mesh.vertices[static_cast<std::size_t>(v[0])], mesh.vertices[static_cast<std::size_t>(v[1])],
            mesh.vertices[static_cast<std::size_t>(v[2])]};
}

/// Shape quality 4 sqrt(3) A / (a^2 + b^2 + c^2): 1 for an equilateral triangle, 0 for a degenerate one
/// [Bank & Smith 1997, doi:10.1137/S0036142994265292].
[[nodiscard]] inline double triangle_quality(const Triangle3& t)
{
    const double sum = (t.b - t.a).squaredNorm() + (t.c - t.b).squaredNorm() + (t.a - t.c).squaredNorm();
    return sum > 0 ? 2.0 * std::sqrt(3.0) * double_area(t).norm() / sum : 0.0;
}

/// Solid angle of a triangle seen from p, signed: + when its normal points away from p [van Oosterom & Strackee 1983,
/// doi:10.1109/TBME.1983.325207]. The sum over a closed mesh / 4 pi is the winding number of p.
[[nodiscard]] inline double solid_angle(const Vec3& p, const Triangle3& t)
{
    const Vec3 a = t.a - p, b = t.b - p, c = t.c - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Two unit vectors that make a right-handed frame with the unit vector `axis`; the first lies as near to `hint` as it can.
struct CrossFrame {
    Vec3 u, v;
};
[[nodiscard]] inline CrossFrame cross_frame(const Vec3& axis, const Vec3& hint)
{
    Vec3 u = hint - axis * axis.dot(hint);
    if (u.norm() < 1e-6 * hint.norm() || hint.norm() == 0) u = axis.unitOrthogonal();
    u.normalize();
    return {u, axis.cross(u)};
}

}  // namespace seldinger
