// Quadrature points of the shell, the weights of control vertices at them, and strains.
#include "shell/shell.h"

#include "core/check.h"
#include "core/error.h"
#include "shell/shell_strain.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

namespace seldinger {

using namespace shell_detail;

namespace {

using Matrix2 = Eigen::Matrix2d;

void check(const ShellSpec& spec)
{
    const auto demand = [](bool fine, const char* what, double value) {
        if (!fine) throw Error(ErrorKind::BadScene, std::string("elastic wall: ") + what + ", not " + std::to_string(value));
    };
    demand(std::isfinite(spec.youngs) && spec.youngs > 0, "Young's modulus must be above 0", spec.youngs);
    demand(spec.poisson > -1 && spec.poisson <= 0.5, "Poisson's ratio must lie between -1 and 0.5", spec.poisson);
    demand(std::isfinite(spec.thickness) && spec.thickness > 0, "thickness must be above 0", spec.thickness);
    demand(std::isfinite(spec.support) && spec.support >= 0, "support must not be negative", spec.support);
    demand(std::isfinite(spec.support_damping) && spec.support_damping >= 0, "damping of the support must not be negative",
           spec.support_damping);
    demand(std::isfinite(spec.relaxation) && spec.relaxation >= 0, "relaxation time must not be negative", spec.relaxation);
    demand(std::isfinite(spec.pressure), "pressure must be finite", spec.pressure);
}

}  // namespace

Shell::Shell(const LoopSurface& surface, const ShellSpec& spec) : surface_(surface), spec_(spec)
{
    check(spec);
    spreads_.assign(surface.control().vertices.size(), Mat3::Zero());
    find_spreads();
    for (std::int32_t t = 0; t < surface.topology().triangle_count(); ++t) {
        for (const auto& [u, v] : quadrature) add_point(t, u, v, 1.0 / 8);
        add_membrane(points_.size() - per_triangle);
    }
}

/// @param share  of the point in the area of the (u, v) triangle, which is 1/2
void Shell::add_point(std::int32_t triangle, double u, double v, double share)
{
    LoopCurvedStencil s;
    surface_.basis(triangle, u, v, s);
    Vec3 x = Vec3::Zero(), xu = x, xv = x, xuu = x, xuv = x, xvv = x;
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.size); ++k) {
        const Vec3& p = surface_.control().vertices[static_cast<std::size_t>(s.vertex[k])];
        x += s.n[k] * p, xu += s.n_u[k] * p, xv += s.n_v[k] * p;
        xuu += s.n_uu[k] * p, xuv += s.n_uv[k] * p, xvv += s.n_vv[k] * p;
    }
    const Vec3 normal = xu.cross(xv);
    ShellPoint q;
    q.triangle = triangle, q.u = u, q.v = v;
    q.area = share * normal.norm();
    q.position = x;
    q.normal = normal.normalized();
    q.e1 = xu.normalized();
    q.e2 = q.normal.cross(q.e1);

    // d(u, v) / d(s1, s2): inverse of the tangents in the frame
    Matrix2 tangents;
    tangents << xu.dot(q.e1), xv.dot(q.e1), xu.dot(q.e2), xv.dot(q.e2);
    const Matrix2 inverse = tangents.inverse();
    // Gamma^c_ab: (u, v) components of the tangential part of x_,ab
    const auto components = [&](const Vec3& second) {
        return Eigen::Vector2d(inverse * Eigen::Vector2d(second.dot(q.e1), second.dot(q.e2)));
    };
    const Eigen::Vector2d guu = components(xuu), guv = components(xuv), gvv = components(xvv);
    const auto in_frame = [&](double uu, double uv, double vv) {
        Matrix2 m;
        m << uu, uv, uv, vv;
        return Matrix2(inverse.transpose() * m * inverse);
    };
    const Matrix2 b = in_frame(xuu.dot(q.normal), xuv.dot(q.normal), xvv.dot(q.normal));
    q.b11 = b(0, 0), q.b22 = b(1, 1), q.b12 = b(0, 1);

    q.first_vertex = static_cast<std::int32_t>(weights_.size());
    q.vertex_count = s.size;
    for (std::size_t k = 0; k < static_cast<std::size_t>(s.size); ++k) {
        const Eigen::Vector2d n_uv(s.n_u[k], s.n_v[k]), n_s = inverse.transpose() * n_uv;
        const Matrix2 second = in_frame(s.n_uu[k] - guu.dot(n_uv), s.n_uv[k] - guv.dot(n_uv), s.n_vv[k] - gvv.dot(n_uv));
        weights_.push_back({s.vertex[k], s.n[k], n_s[0], n_s[1], second(0, 0), second(1, 1), second(0, 1)});
    }
    mend(q);
    points_.push_back(q);
}

/// Limits L of the products X X^T exceed those of x x^T by the spread of each mask; L S is that spread. Gauss-Seidel.
void Shell::find_spreads()
{
    const LoopTopology& mesh = surface_.topology();
    const auto& x = surface_.control().vertices;
    std::vector<Mat3> spread(x.size());
    for (int sweep = -1; sweep < 60; ++sweep)
        for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
            const LoopTopology::LimitMask mask = mesh.limit_mask(v);
            const auto i = static_cast<std::size_t>(v);
            if (sweep < 0) {  // about the limit
                Vec3 centre = mask.own * x[i];
                for (int k = 0; k < mask.count; ++k)
                    centre += mask.each * x[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])];
                spread[i] = outer(mask.own * (x[i] - centre), x[i] - centre);
                for (int k = 0; k < mask.count; ++k) {
                    const Vec3 r = x[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])] - centre;
                    spread[i] += outer(mask.each * r, r);
                }
                continue;
            }
            Mat3 rest = spread[i];
            for (int k = 0; k < mask.count; ++k)
                rest -= mask.each * spreads_[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])];
            spreads_[i] = rest / mask.own;
        }
}

/// Least-squares fit of a quadratic to the patch's control vertices in tangent-plane coordinates; what Loop's second derivatives
/// of it miss is added to the weights.
void Shell::mend(const ShellPoint& q)
{
    Weight* w = weights_.data() + q.first_vertex;
    const double scale = std::sqrt(8 * q.area);  // about an edge
    Eigen::Matrix<double, Eigen::Dynamic, 6> monomials(q.vertex_count, 6);
    Eigen::Matrix<double, 3, Eigen::Dynamic> loop(3, q.vertex_count);
    for (int k = 0; k < q.vertex_count; ++k) {
        const Vec3 r = (surface_.control().vertices[static_cast<std::size_t>(w[k].vertex)] - q.position) / scale;
        const double a = r.dot(q.e1), b = r.dot(q.e2);
        const Mat3 spread = spreads_[static_cast<std::size_t>(w[k].vertex)] / (scale * scale);
        monomials.row(k) << 1, a, b, (a * a - q.e1.dot(spread * q.e1)) / 2, (b * b - q.e2.dot(spread * q.e2)) / 2,
            a * b - q.e1.dot(spread * q.e2);
        loop.col(k) << w[k].n_11, w[k].n_22, w[k].n_12;
    }
    // six vertices beside a corner may lie on a conic: the fit is then the smallest one
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> fit(q.vertex_count, 6);
    fit.setThreshold(1e-3);
    fit.compute(monomials);
    Eigen::Matrix<double, 3, 6> missed = -loop * monomials;
    for (int i = 0; i < 3; ++i) missed(i, 3 + i) += 1 / (scale * scale);
    const Eigen::Matrix<double, 3, Eigen::Dynamic> more = missed * fit.pseudoInverse();
    for (int k = 0; k < q.vertex_count; ++k) w[k].n_11 += more(0, k), w[k].n_22 += more(1, k), w[k].n_12 += more(2, k);
}

Mat3 Shell::law() const
{
    const double nu = spec_.poisson;
    return spec_.youngs / (1 - nu * nu) * Mat3::rows({1, nu, 0}, {nu, 1, 0}, {0, 0, (1 - nu) / 2});
}

ShellStrain Shell::strain(const ShellPoint& q, std::span<const double> displacement) const
{
    // derivatives along e1, e2, second ones 11, 22, 12
    Vec3 u1 = Vec3::Zero(), u2 = u1, u11 = u1, u22 = u1, u12 = u1;
    for (const Weight& w : weights(q)) {
        const Vec3 d(displacement.data() + 3 * w.vertex);
        u1 += w.n_1 * d, u2 += w.n_2 * d, u11 += w.n_11 * d, u22 += w.n_22 * d, u12 += w.n_12 * d;
    }
    return join(q, {q.e1.dot(u1), q.e2.dot(u2), q.e1.dot(u2) + q.e2.dot(u1)},
                {q.normal.dot(u11), q.normal.dot(u22), 2 * q.normal.dot(u12)});
}

Vec3 Shell::strains_of(std::size_t first, std::span<const double> displacement,
                                  std::span<ShellStrain, per_triangle> at) const
{
    const ShellPoint* q = points_.data() + first;
    for (std::size_t k = 0; k < per_triangle; ++k) at[k] = strain(q[k], displacement);
    const auto w = weights(*q);
    const auto per_displacement = membrane(first);
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < w.size(); ++k)
        sum += per_displacement[k] * Vec3(displacement.data() + 3 * w[k].vertex);
    return sum;
}

}  // namespace seldinger
