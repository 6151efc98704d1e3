// TEMP Closest point of the limit surface.
#include "wall/loop_surface.h"
#include <Eigen/LU>
#include <cmath>
#include <limits>
namespace seldinger {
void LoopSurface::build_start() {}
void LoopSurface::descend(const Vec3& p, LoopFoot& foot) const { (void)p; (void)foot; }
void LoopSurface::closest(const Vec3& p, LoopFoot& foot) const
{
    static thread_local std::vector<Vec3> limits; static thread_local const LoopSurface* of = nullptr;
    if (of != this || limits.size() != control_.vertices.size()) {
        limits.resize(control_.vertices.size());
        LoopStencil s;
        for (std::size_t v = 0; v < limits.size(); ++v) { limit_of_vertex((int)v, s); limits[v].setZero(); for (int k = 0; k < s.size; ++k) limits[v] += s.n[k] * control_.vertices[s.vertex[k]]; }
        of = this;
    }
    std::int32_t best = -1; double d2 = 1e300;
    for (std::size_t t = 0; t < control_.triangles.size(); ++t) {
        const auto& tri = control_.triangles[t];
        const Vec3 c = (limits[tri[0]] + limits[tri[1]] + limits[tri[2]]) / 3;
        const double d = (c - p).squaredNorm();
        if (d < d2) d2 = d, best = (int)t;
    }
    // Newton over triangle and its neighbours: sample projection
    double best_d = 1e300; LoopFoot out;
    const auto base = control_.triangles[best];
    for (std::size_t t = 0; t < control_.triangles.size(); ++t) {
        const auto& tri = control_.triangles[t];
        bool shares = false;
        for (int a : tri) for (int b : base) shares = shares || a == b;
        if (!shares) continue;
        double u = 1. / 3, v = 1. / 3;
        for (int it = 0; it < 12; ++it) {
            LoopFoot f = at((int)t, u, v);
            const Vec3 r = p - f.position;
            Eigen::Matrix2d g; g << f.tangent_u.squaredNorm(), f.tangent_u.dot(f.tangent_v), f.tangent_u.dot(f.tangent_v), f.tangent_v.squaredNorm();
            const Eigen::Vector2d s = g.inverse() * Eigen::Vector2d(r.dot(f.tangent_u), r.dot(f.tangent_v));
            double nu = u + s[0], nv = v + s[1];
            nu = std::max(0., nu); nv = std::max(0., nv); if (nu + nv > 1) { const double e = (nu + nv - 1) / 2; nu -= e; nv -= e; nu = std::min(1.,std::max(0., nu)); nv = std::min(1 - nu, std::max(0., nv)); }
            const bool done = std::abs(nu - u) + std::abs(nv - v) < 1e-12;
            u = nu; v = nv;
            if (done) break;
        }
        LoopFoot f = at((int)t, u, v);
        f.distance = (p - f.position).norm();
        if (f.distance < best_d) best_d = f.distance, out = f;
    }
    foot = out;
}
}  // namespace seldinger
