// Energy and stresses of a displacement of the shell.
#include "core/check.h"
#include "wall/shell.h"
#include "wall/shell_strain.h"

#include <cmath>

namespace seldinger {

using namespace shell_detail;

namespace {

double mises(const Eigen::Vector3d& s)  // plane stress
{
    return std::sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3 * s[2] * s[2]);
}

}  // namespace

Shell::Energy Shell::energy(std::span<const double> displacement) const
{
    SEL_ASSERT(displacement.size() == 3 * surface_.control().vertices.size());
    const Eigen::Matrix3d h = law();
    const double c = spec_.thickness, d = std::pow(spec_.thickness, 3) / 12;
    Energy e;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const ShellPoint& q = points_[k];
        if (k % per_triangle == 0) mean = membrane_strain(q.triangle, displacement);
        const Eigen::Vector3d bent = strain(q, displacement).tail<3>();
        e.membrane += 0.5 * q.area * c * mean.dot(h * mean);
        e.bending += 0.5 * q.area * d * bent.dot(h * bent);
    }
    return e;
}

ShellStress Shell::stress(std::span<const double> displacement) const
{
    const std::size_t vertices = surface_.control().vertices.size();
    SEL_ASSERT(displacement.size() == 3 * vertices);
    const Eigen::Matrix3d h = law();
    ShellStress out;
    out.membrane.reserve(points_.size()), out.bending.reserve(points_.size());
    out.mises_inner.assign(vertices, 0), out.mises_outer.assign(vertices, 0);
    std::vector<double> area(vertices, 0);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const ShellPoint &q = points_[k], &last = points_[k / per_triangle * per_triangle + per_triangle - 1];
        if (k % per_triangle == 0) mean = membrane_strain(q.triangle, displacement);
        out.membrane.push_back(h * turn_strain(last, q) * mean);
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

}  // namespace seldinger
