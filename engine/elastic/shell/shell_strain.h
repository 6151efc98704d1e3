#pragma once
// Strains of the shell at a point, in its frame; private to the shell's source files.

#include "shell/shell.h"

#include <array>

namespace seldinger::shell_detail {

/// Barycentres of the four triangles that a control triangle is cut into, as (u, v); the middle one last.
inline constexpr std::size_t per_triangle = 4;
inline constexpr double quadrature[per_triangle][2] = {
    {1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}, {1.0 / 3, 1.0 / 3}};

/// rho = db - (b eps + eps b) / 2 with 2 eps_12, 2 rho_12 in third place.
inline ShellStrain join(const ShellPoint& q, const Vec3& eps, const Vec3& db)
{
    return {eps,
            {db[0] - q.b11 * eps[0] - q.b12 * eps[2] / 2, db[1] - q.b22 * eps[1] - q.b12 * eps[2] / 2,
             db[2] - (q.b11 + q.b22) * eps[2] / 2 - q.b12 * (eps[0] + eps[1])}};
}

/// Work conjugate of join(): what moments m do on the strain (11, 22, 2 12).
inline Vec3 join_transposed(const ShellPoint& q, const Vec3& m)
{
    return {-q.b11 * m[0] - q.b12 * m[2], -q.b22 * m[1] - q.b12 * m[2],
            -(q.b12 * (m[0] + m[1]) + (q.b11 + q.b22) * m[2]) / 2};
}

/// Membrane strain under unit displacements of a control vertex whose weight has the derivatives n_1, n_2 in the point's frame.
inline Mat3 stretch(const ShellPoint& q, double n_1, double n_2)
{
    return Mat3::rows(n_1 * q.e1, n_2 * q.e2, n_2 * q.e1 + n_1 * q.e2);
}

/// Turns tangential strain (11, 22, 2 12) of one point into the frame of a neighbouring one. The angle is the one between the
/// frames after one tangent plane is laid on the other. Projection alone would shrink the strain.
inline Mat3 turn_strain(const ShellPoint& from, const ShellPoint& to)
{
    const Vec2 turn(to.e1.dot(from.e1) + to.e2.dot(from.e2), to.e1.dot(from.e2) - to.e2.dot(from.e1));
    const double c = turn[0] / turn.norm(), s = turn[1] / turn.norm();
    return Mat3::rows({c * c, s * s, c * s}, {s * s, c * c, -c * s}, {-2 * c * s, 2 * c * s, c * c - s * s});
}

/// A point of an edge: tangent x_,s, the surface's unit normal, and what each control vertex weighs in x_,s; s runs from 0 to 1.
struct EdgePoint {
    Vec3 tangent = Vec3::Zero(), normal = Vec3::Zero();  // [m], [-]
    std::array<double, LoopStencil::capacity> n_s{};
};

/// The constant strain of a triangle that stretches its edges as they are stretched on average (shell.h says why).
struct TiedStrain {
    /// @param q  a point of the triangle, in whose frame the strain is
    TiedStrain(const LoopSurface& surface, const ShellPoint& q);

    /// Strain (11, 22, 2 12) per displacement of the stencil's k-th control vertex [1/m].
    [[nodiscard]] Mat3 weight(std::size_t k) const;
    /// How much the mean strain counts beside this one: a of shell.h.
    [[nodiscard]] double share_of_mean(double thickness) const;

    std::array<std::array<EdgePoint, 2>, 3> points;  // Gauss points of each edge
    Mat3 of_stretch = Mat3::Zero();                  // strain per sum of t . u_,s over an edge's two points [1/m]
    double bow = 0;                                  // l^2/R of the edge that bows most [m]
};

}  // namespace seldinger::shell_detail
