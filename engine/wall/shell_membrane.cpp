// The membrane's strain of a triangle: mean and tied, in shares that depend on how far its edges bow (shell.h says why).
#include "wall/shell.h"
#include "wall/shell_strain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace seldinger {

using namespace shell_detail;

namespace {

/// Weights of a triangle's stencil: strain (11, 22, 2 12) per displacement of a control vertex [1/m].
using MembraneWeights = std::vector<Mat3>;

/// Where an edge runs over a triangle, as (u, v), and where its two Gauss points lie, in parts of it.
constexpr double edges[3][2][2] = {{{0, 0}, {1, 0}}, {{1, 0}, {0, 1}}, {{0, 1}, {0, 0}}};
constexpr double gauss[2] = {0.5 - 0.5 / std::numbers::sqrt3, 0.5 + 0.5 / std::numbers::sqrt3};

/// A point of an edge: tangent x_,s, the surface's unit normal, and what each control vertex weighs in x_,s; s runs from 0 to 1.
struct EdgePoint {
    Vec3 tangent = Vec3::Zero(), normal = Vec3::Zero();  // [m], [-]
    std::array<double, LoopStencil::capacity> n_s{};

    EdgePoint(const LoopSurface& surface, std::int32_t triangle, const double (&edge)[2][2], double s)
    {
        const double du = edge[1][0] - edge[0][0], dv = edge[1][1] - edge[0][1];
        LoopStencil at;
        surface.basis(triangle, edge[0][0] + s * du, edge[0][1] + s * dv, at);
        Vec3 x_u = Vec3::Zero(), x_v = Vec3::Zero();
        for (std::size_t k = 0; k < static_cast<std::size_t>(at.size); ++k) {
            const Vec3& x = surface.control().vertices[static_cast<std::size_t>(at.vertex[k])];
            x_u += at.n_u[k] * x, x_v += at.n_v[k] * x;
            n_s[k] = du * at.n_u[k] + dv * at.n_v[k];
        }
        tangent = du * x_u + dv * x_v;
        normal = x_u.cross(x_v).normalized();
    }
    /// t . eps . t |x_,s| of a strain in the frame of `q`: a row for (11, 22, 2 12) [m].
    [[nodiscard]] Vec3 stretch_of(const ShellPoint& q) const
    {
        ShellPoint here;
        here.e1 = tangent.normalized(), here.e2 = normal.cross(here.e1);
        return tangent.norm() * turn_strain(q, here).row(0);
    }
};

/// The constant strain of a triangle that stretches its edges as they are stretched on average.
struct TiedStrain {
    MembraneWeights weights;
    double bow = 0;  // l^2/R of the edge that bows most [m]

    TiedStrain(const LoopSurface& surface, const ShellPoint& q) : weights(static_cast<std::size_t>(q.vertex_count))
    {
        Vec3 of_strain[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        std::vector<std::array<Vec3, 3>> of_move(weights.size());
        for (std::size_t e = 0; e < 3; ++e) {
            const EdgePoint points[2] = {{surface, q.triangle, edges[e], gauss[0]}, {surface, q.triangle, edges[e], gauss[1]}};
            for (const EdgePoint& p : points) of_strain[e] += p.stretch_of(q);
            for (std::size_t k = 0; k < weights.size(); ++k)
                of_move[k][e] = points[0].n_s[k] * points[0].tangent.normalized() + points[1].n_s[k] * points[1].tangent.normalized();
            const Vec3 turn = (points[1].tangent - points[0].tangent) / (gauss[1] - gauss[0]);  // x_,ss
            bow = std::max(bow, std::abs(q.normal.dot(turn)));
        }
        const Mat3 strain_of = Mat3::rows(of_strain[0], of_strain[1], of_strain[2]).inverse();
        for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = strain_of * Mat3::rows(of_move[k][0], of_move[k][1], of_move[k][2]);
    }
};

}  // namespace

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
    MembraneWeights mean(static_cast<std::size_t>(last.vertex_count), Mat3::Zero());
    double area = 0;
    for (std::size_t p = first; p < first + per_triangle; ++p) {
        const ShellPoint& q = points_[p];
        const auto w = weights(q);
        const Mat3 turn = q.area * turn_strain(q, last);
        for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += turn * stretch(q, w[k].n_1, w[k].n_2);
        area += q.area;
    }
    const TiedStrain tied(surface_, last);
    const double share = 1 / (1 + std::pow(tied.bow / (2 * spec_.thickness), 2));
    for (std::size_t k = 0; k < mean.size(); ++k)
        membrane_.push_back(share / area * mean[k] + (1 - share) * tied.weights[k]);
}

}  // namespace seldinger
