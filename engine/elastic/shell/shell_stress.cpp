// Energy and stresses of a displacement of the shell.
#include "core/check.h"
#include "shell/large_shell.h"
#include "shell/shell.h"
#include "shell/shell_strain.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace seldinger {

using namespace shell_detail;

namespace {

double mises(const Vec3& s)  // plane stress
{
    return std::sqrt(s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 3 * s[2] * s[2]);
}

}  // namespace

Shell::Energy Shell::energy(std::span<const double> displacement) const
{
    SEL_ASSERT(displacement.size() == 3 * surface_.control().vertices.size());
    const Mat3 h = law();
    const double c = spec_.thickness, d = std::pow(spec_.thickness, 3) / 12;
    Energy e;
    std::array<ShellStrain, per_triangle> at;
    for (std::size_t first = 0; first < points_.size(); first += per_triangle) {
        const Vec3 stretch = strains_of(first, displacement, at);
        for (std::size_t k = 0; k < per_triangle; ++k) {
            const Vec3& bent = at[k].bending;
            e.membrane += 0.5 * points_[first + k].area * c * stretch.dot(h * stretch);
            e.bending += 0.5 * points_[first + k].area * d * bent.dot(h * bent);
        }
    }
    return e;
}

ShellStress Shell::stress(std::span<const double> displacement, const LargeShell* large, double* excess) const
{
    const std::size_t vertices = surface_.control().vertices.size();
    SEL_ASSERT(displacement.size() == 3 * vertices);
    const Mat3 h = law();
    ShellStress out;
    out.membrane.resize(points_.size()), out.bending.resize(points_.size());
    out.mises_inner.assign(vertices, 0), out.mises_outer.assign(vertices, 0);
    std::vector<double> area(vertices, 0);
    for (std::size_t first = 0; first < points_.size(); first += per_triangle) {
        std::array<ShellStrain, per_triangle> at;
        const Vec3 stretch = large ? large->strains_of(first, displacement, at, excess) : strains_of(first, displacement, at);
        const ShellPoint& last = points_[first + per_triangle - 1];
        const auto& corners = surface_.control().triangles[static_cast<std::size_t>(last.triangle)];
        for (std::size_t k = 0; k < per_triangle; ++k) {
            const ShellPoint& q = points_[first + k];
            const Vec3 membrane = h * (turn_strain(last, q) * stretch),
                                  bending = spec_.thickness / 2 * (h * at[k].bending);
            out.membrane[first + k] = membrane, out.bending[first + k] = bending;
            const double inner = mises(membrane - bending), outer = mises(membrane + bending);
            if (const double larger = std::max(inner, outer); larger > out.mises_max)
                out.mises_max = larger, out.highest = first + k;
            const double share[3] = {1 - q.u - q.v, q.u, q.v};
            for (std::size_t c = 0; c < 3; ++c) {
                const auto v = static_cast<std::size_t>(corners[c]);
                const double weight = share[c] * q.area;
                area[v] += weight, out.mises_inner[v] += weight * inner, out.mises_outer[v] += weight * outer;
            }
        }
    }
    for (std::size_t v = 0; v < vertices; ++v) out.mises_inner[v] /= area[v], out.mises_outer[v] /= area[v];
    return out;
}

double Shell::stress_of(std::int32_t triangle, std::span<const double> displacement, std::size_t& highest,
                        const LargeShell* large) const
{
    const Mat3 h = law();
    const std::size_t first = per_triangle * static_cast<std::size_t>(triangle);  // points are made in the order of triangles
    std::array<ShellStrain, per_triangle> at;
    const Vec3 stretch = large ? large->strains_of(first, displacement, at) : strains_of(first, displacement, at);
    const ShellPoint& last = points_[first + per_triangle - 1];
    double most = 0;
    for (std::size_t k = 0; k < per_triangle; ++k) {
        const Vec3 membrane = h * (turn_strain(last, points_[first + k]) * stretch);
        const Vec3 bending = spec_.thickness / 2 * (h * at[k].bending);
        const double larger = std::max(mises(membrane - bending), mises(membrane + bending));
        if (larger > most) most = larger, highest = first + k;
    }
    return most;
}

}  // namespace seldinger
