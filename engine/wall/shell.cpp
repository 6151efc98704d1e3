// Quadrature points of the shell, its matrices, and stresses of a displacement.
#include "wall/shell.h"

#include "core/check.h"
#include "core/error.h"
#include "wall/block_pattern.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

namespace seldinger {

namespace {

using Matrix2 = Eigen::Matrix2d;
using Strain = Eigen::Matrix<double, 6, 1>;

void check(const ShellSpec& spec)
{
    const auto demand = [](bool fine, const char* what, double value) {
        if (!fine) throw Error(ExitCode::BadScene, std::string("elastic wall: ") + what + ", not " + std::to_string(value));
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

/// Barycentres of the four triangles that a control triangle is cut into, as (u, v); the middle one last.
constexpr std::size_t per_triangle = 4;
constexpr double quadrature[per_triangle][2] = {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}, {1.0 / 3, 1.0 / 3}};

double mises(const Eigen::Vector3d& s)  // plane stress
{
    return std::sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3 * s[2] * s[2]);
}

}  // namespace

Shell::Shell(const LoopSurface& surface, const ShellSpec& spec) : surface_(surface), spec_(spec)
{
    check(spec);
    spreads_.assign(surface.control().vertices.size(), Eigen::Matrix3d::Zero());
    find_spreads();
    for (std::int32_t t = 0; t < surface.topology().triangle_count(); ++t) {
        double area = 0;
        for (const auto& [u, v] : quadrature) add_point(t, u, v, 1.0 / 8), area += points_.back().area;
        points_.back().membrane_area = area;
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
    std::vector<Eigen::Matrix3d> spread(x.size());
    for (int sweep = -1; sweep < 60; ++sweep)
        for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
            const LoopTopology::LimitMask mask = mesh.limit_mask(v);
            const auto i = static_cast<std::size_t>(v);
            if (sweep < 0) {  // about the limit
                Vec3 centre = mask.own * x[i];
                for (int k = 0; k < mask.count; ++k) centre += mask.each * x[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])];
                spread[i] = mask.own * (x[i] - centre) * (x[i] - centre).transpose();
                for (int k = 0; k < mask.count; ++k) {
                    const Vec3 r = x[static_cast<std::size_t>(mask.neighbours[static_cast<std::size_t>(k)])] - centre;
                    spread[i] += mask.each * r * r.transpose();
                }
                continue;
            }
            Eigen::Matrix3d rest = spread[i];
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
        const Eigen::Matrix3d spread = spreads_[static_cast<std::size_t>(w[k].vertex)] / (scale * scale);
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

Eigen::Matrix3d Shell::law() const
{
    const double nu = spec_.poisson;
    Eigen::Matrix3d h;
    h << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    return spec_.youngs / (1 - nu * nu) * h;
}

namespace {

/// rho = db - (b eps + eps b) / 2 with 2 eps_12, 2 rho_12 in third place.
Strain join(const ShellPoint& q, const Eigen::Vector3d& eps, const Eigen::Vector3d& db)
{
    Strain s;
    s.head<3>() = eps;
    s[3] = db[0] - q.b11 * eps[0] - q.b12 * eps[2] / 2;
    s[4] = db[1] - q.b22 * eps[1] - q.b12 * eps[2] / 2;
    s[5] = db[2] - (q.b11 + q.b22) * eps[2] / 2 - q.b12 * (eps[0] + eps[1]);
    return s;
}

}  // namespace

Strain Shell::strain(const ShellPoint& q, std::span<const double> displacement) const
{
    Vec3 u1 = Vec3::Zero(), u2 = u1;
    Eigen::Vector3d db = Eigen::Vector3d::Zero();
    for (const Weight& w : weights(q)) {
        const Eigen::Map<const Vec3> d(displacement.data() + 3 * w.vertex);
        u1 += w.n_1 * d, u2 += w.n_2 * d;
        const double across = d.dot(q.normal);
        db += across * Eigen::Vector3d(w.n_11, w.n_22, 2 * w.n_12);
    }
    return join(q, {q.e1.dot(u1), q.e2.dot(u2), q.e1.dot(u2) + q.e2.dot(u1)}, db);
}

Shell::Energy Shell::energy(std::span<const double> displacement) const
{
    SEL_ASSERT(displacement.size() == 3 * surface_.control().vertices.size());
    const Eigen::Matrix3d h = law();
    const double c = spec_.thickness, d = std::pow(spec_.thickness, 3) / 12;
    Energy e;
    for (const ShellPoint& q : points_) {
        const Strain s = strain(q, displacement);
        e.membrane += 0.5 * q.membrane_area * c * s.head<3>().dot(h * s.head<3>());
        e.bending += 0.5 * q.area * d * s.tail<3>().dot(h * s.tail<3>());
    }
    return e;
}

namespace {

/// A tangential tensor (11, 22, 12) of one point in the frame of another one beside it.
Eigen::Vector3d turned(const Eigen::Vector3d& t, const ShellPoint& from, const ShellPoint& to)
{
    Matrix2 m, r;
    m << t[0], t[2], t[2], t[1];
    r << to.e1.dot(from.e1), to.e1.dot(from.e2), to.e2.dot(from.e1), to.e2.dot(from.e2);
    const Matrix2 n = r * m * r.transpose();
    return {n(0, 0), n(1, 1), n(0, 1)};
}

}  // namespace

ShellStress Shell::stress(std::span<const double> displacement) const
{
    const std::size_t vertices = surface_.control().vertices.size();
    SEL_ASSERT(displacement.size() == 3 * vertices);
    const Eigen::Matrix3d h = law();
    ShellStress out;
    out.membrane.reserve(points_.size()), out.bending.reserve(points_.size());
    out.mises_inner.assign(vertices, 0), out.mises_outer.assign(vertices, 0);
    std::vector<double> area(vertices, 0);
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const ShellPoint &q = points_[k], &middle = points_[k / per_triangle * per_triangle + per_triangle - 1];
        out.membrane.push_back(turned(h * strain(middle, displacement).head<3>(), middle, q));
        out.bending.push_back(spec_.thickness / 2 * (h * strain(q, displacement).tail<3>()));
        const double inner = mises(out.membrane.back() - out.bending.back()),
                     outer = mises(out.membrane.back() + out.bending.back());
        const double share[3] = {1 - q.u - q.v, q.u, q.v};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto v = static_cast<std::size_t>(surface_.control().triangles[static_cast<std::size_t>(q.triangle)][c]);
            const double weight = share[c] * q.area;
            area[v] += weight, out.mises_inner[v] += weight * inner, out.mises_outer[v] += weight * outer;
        }
    }
    for (std::size_t v = 0; v < vertices; ++v) out.mises_inner[v] /= area[v], out.mises_outer[v] /= area[v];
    return out;
}

namespace {

/// u x (.) as a matrix.
Eigen::Matrix3d cross_matrix(const Vec3& u)
{
    Eigen::Matrix3d m;
    m << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
    return m;
}

/// N^ab in the frame of a point [N/m].
Matrix2 prestress_in_frame(const ShellPoint& q, const Prestress& prestress, double pressure)
{
    const Eigen::Vector2d along(prestress.axis.dot(q.e1), prestress.axis.dot(q.e2));
    const double hoop = pressure * prestress.radius, axial = prestress.axial_part * hoop;
    const double length = along.norm();
    // where the wall faces the axis (a cap) both directions are alike
    if (!(length > 1e-9 * prestress.axis.norm())) return axial * Matrix2::Identity();
    const Eigen::Vector2d z = along / length, t(-z.y(), z.x());
    return hoop * t * t.transpose() + axial * z * z.transpose();
}

}  // namespace

ShellMatrices Shell::assemble(const PrestressAt& prestress) const
{
    const std::size_t vertices = surface_.control().vertices.size();
    std::vector<std::vector<std::int32_t>> stencils;
    for (std::size_t q = 0; q < points_.size(); q += per_triangle) {
        stencils.emplace_back();
        for (const Weight& w : weights(points_[q])) stencils.back().push_back(w.vertex);
    }
    const BlockPattern pattern(static_cast<std::int32_t>(vertices), stencils);
    const bool loaded = spec_.pressure != 0;
    if (loaded && !prestress)
        throw Error(ExitCode::BadScene, "elastic wall: a mean pressure needs the vessel's axis and radius (centreline)");
    std::vector<double> elastic(9 * pattern.block_count(), 0), pressure(loaded ? elastic.size() : 0, 0),
        area(pattern.block_count(), 0);

    const Eigen::Matrix3d h = law();
    const double c = spec_.thickness, d = std::pow(spec_.thickness, 3) / 12;
    using Strains = Eigen::Matrix<double, 6, 3>;
    std::vector<Strains> strains, stresses;
    for (const ShellPoint& q : points_) {
        const auto w = weights(q);
        strains.resize(w.size()), stresses.resize(w.size());
        for (std::size_t k = 0; k < w.size(); ++k) {
            for (int axis = 0; axis < 3; ++axis)
                strains[k].col(axis) =
                    join(q, {w[k].n_1 * q.e1[axis], w[k].n_2 * q.e2[axis], w[k].n_2 * q.e1[axis] + w[k].n_1 * q.e2[axis]},
                         q.normal[axis] * Eigen::Vector3d(w[k].n_11, w[k].n_22, 2 * w[k].n_12));
            stresses[k].topRows<3>() = q.membrane_area * c * h * strains[k].topRows<3>();
            stresses[k].bottomRows<3>() = q.area * d * h * strains[k].bottomRows<3>();
        }
        const Matrix2 n = loaded ? prestress_in_frame(q, prestress(q.position), spec_.pressure) : Matrix2::Zero();
        const Eigen::Matrix3d by_1 = -cross_matrix(q.e2), by_2 = cross_matrix(q.e1);
        for (std::size_t i = 0; i < w.size(); ++i)
            for (std::size_t j = 0; j < w.size(); ++j) {
                if (w[i].vertex < w[j].vertex) continue;
                const std::size_t block = pattern.find(w[i].vertex, w[j].vertex);
                Eigen::Map<Eigen::Matrix3d>(&elastic[9 * block]) += strains[i].transpose() * stresses[j];
                area[block] += q.area * w[i].n * w[j].n;
                if (!loaded) continue;
                // the mesh faces the lumen: the volume's variation has the opposite sign of that with the outward normal
                const double geometric = n(0, 0) * w[i].n_1 * w[j].n_1 + n(1, 1) * w[i].n_2 * w[j].n_2 +
                                         n(0, 1) * (w[i].n_1 * w[j].n_2 + w[i].n_2 * w[j].n_1);
                const Eigen::Matrix3d live = w[i].n * (w[j].n_1 * by_1 + w[j].n_2 * by_2) -
                                             w[j].n * (w[i].n_1 * by_1 + w[i].n_2 * by_2);  // + transpose; both are skew
                Eigen::Map<Eigen::Matrix3d>(&pressure[9 * block]) +=
                    q.area * (geometric * Eigen::Matrix3d::Identity() + 0.5 * spec_.pressure * live);
            }
    }
    ShellMatrices m;
    m.elastic = pattern.matrix(elastic, 3);
    m.pressure = loaded ? pattern.matrix(pressure, 3) : SparseMatrix(m.elastic.rows(), m.elastic.cols());
    m.area = pattern.matrix(area, 1);
    m.held.assign(vertices, 0);
    if (spec_.rims_held)
        for (std::size_t v = 0; v < vertices; ++v) m.held[v] = surface_.topology().kind[v] != LoopVertex::Inner;
    return m;
}

}  // namespace seldinger
