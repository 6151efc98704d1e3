// The membrane's strain of a triangle: mean and tied, in shares that depend on how far its edges bow (shell.h says why).
#include "shell/shell.h"
#include "shell/shell_strain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

using namespace shell_detail;

namespace {

/// Where an edge runs over a triangle, as (u, v), and where its two Gauss points lie, in parts of it.
constexpr double edges[3][2][2] = {{{0, 0}, {1, 0}}, {{1, 0}, {0, 1}}, {{0, 1}, {0, 0}}};
constexpr double gauss[2] = {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3};

EdgePoint edge_point(const LoopSurface& surface, std::int32_t triangle, const double (&edge)[2][2], double s)
{
    const double du = edge[1][0] - edge[0][0], dv = edge[1][1] - edge[0][1];
    LoopStencil at;
    surface.basis(triangle, edge[0][0] + s * du, edge[0][1] + s * dv, at);
    EdgePoint point;
    Vec3 x_u = Vec3::Zero(), x_v = Vec3::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(at.size); ++k) {
        const Vec3& x = surface.control().vertices[static_cast<std::size_t>(at.vertex[k])];
        x_u += at.n_u[k] * x, x_v += at.n_v[k] * x;
        point.n_s[k] = du * at.n_u[k] + dv * at.n_v[k];
    }
    point.tangent = du * x_u + dv * x_v;
    point.normal = x_u.cross(x_v).normalized();
    return point;
}

/// t . eps . t |x_,s| of a strain in the frame of `q`: a row for (11, 22, 2 12) [m].
Vec3 stretch_of(const EdgePoint& p, const ShellPoint& q)
{
    ShellPoint here;
    here.e1 = p.tangent.normalized(), here.e2 = p.normal.cross(here.e1);
    return p.tangent.norm() * turn_strain(q, here).row(0);
}

}  // namespace

TiedStrain::TiedStrain(const LoopSurface& surface, const ShellPoint& q)
{
    Vec3 of_strain[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (std::size_t e = 0; e < 3; ++e) {
        for (std::size_t k = 0; k < 2; ++k) {
            points[e][k] = edge_point(surface, q.triangle, edges[e], gauss[k]);
            of_strain[e] += stretch_of(points[e][k], q);
        }
        const Vec3 turn = (points[e][1].tangent - points[e][0].tangent) / (gauss[1] - gauss[0]);  // x_,ss
        bow = std::max(bow, std::abs(q.normal.dot(turn)));
    }
    of_stretch = Mat3::rows(of_strain[0], of_strain[1], of_strain[2]).inverse();
}

Mat3 TiedStrain::weight(std::size_t vertex) const
{
    Vec3 of_move[3];
    for (std::size_t e = 0; e < 3; ++e) {
        const auto& [a, b] = points[e];
        of_move[e] = a.n_s[vertex] * a.tangent.normalized() + b.n_s[vertex] * b.tangent.normalized();
    }
    return of_stretch * Mat3::rows(of_move[0], of_move[1], of_move[2]);
}

double TiedStrain::share_of_mean(double thickness) const { return 1 / (1 + std::pow(bow / (2 * thickness), 2)); }

std::span<const Mat3> Shell::membrane(std::size_t first) const
{
    // a triangle's four points have one stencil
    return {membrane_.data() + static_cast<std::size_t>(points_[first].first_vertex) / per_triangle,
            static_cast<std::size_t>(points_[first].vertex_count)};
}

/// Membrane of the triangle whose points begin with `first`, in the frame of its last one.
void Shell::add_membrane(std::size_t first)
{
    const ShellPoint& last = points_[first + per_triangle - 1];
    std::vector<Mat3> mean(static_cast<std::size_t>(last.vertex_count), Mat3::Zero());  // strain per displacement [1/m]
    double area = 0;
    for (std::size_t p = first; p < first + per_triangle; ++p) {
        const ShellPoint& q = points_[p];
        const auto w = weights(q);
        const Mat3 turn = q.area * turn_strain(q, last);
        for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += turn * stretch(q, w[k].n_1, w[k].n_2);
        area += q.area;
    }
    const TiedStrain tied(surface_, last);
    const double share = tied.share_of_mean(spec_.thickness);
    for (std::size_t k = 0; k < mean.size(); ++k)
        membrane_.push_back(share / area * mean[k] + (1 - share) * tied.weight(k));
}

}  // namespace seldinger
