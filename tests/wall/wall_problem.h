#pragma once
// A wall under loads, solved at once: what tests of the shell have in common.

#include "shell/wall_compliance.h"
#include "wall_fixtures.h"

#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

namespace seldinger::test {

/// The surface through the mesh's vertices, its shell, a force and the fixed unknowns.
class WallProblem {
public:
    WallProblem(const WallMesh& mesh, const ShellSpec& spec, const PrestressAt& prestress = {})
        : surface(mesh),
          left_over(surface.interpolate(mesh.vertices)),
          shell(surface, spec),
          matrices(shell.assemble(prestress)),
          force(3 * mesh.vertices.size(), 0),
          fixed(force.size(), 0)
    {
    }

    void add_stencil(const LoopStencil& s, const Vec3& f)
    {
        for (int k = 0; k < s.size; ++k)
            for (int a = 0; a < 3; ++a) force[3 * s.vertex[k] + a] += s.n[k] * f[a];
    }
    /// At the surface's point nearest to p.
    void add_force(const Vec3& p, const Vec3& f)
    {
        LoopFoot foot;
        surface.closest(p, foot);
        LoopStencil s;
        surface.basis(foot.triangle, foot.u, foot.v, s);
        add_stencil(s, f);
    }
    void add_load(const std::function<Vec3(const ShellPoint&)>& per_area)
    {
        LoopStencil s;
        for (const ShellPoint& q : shell.points()) {
            surface.basis(q.triangle, q.u, q.v, s);
            add_stencil(s, q.area * per_area(q));
        }
    }
    [[nodiscard]] Vec3 displacement(const std::vector<double>& w, const Vec3& p) const
    {
        LoopFoot foot;
        surface.closest(p, foot);
        LoopStencil s;
        surface.basis(foot.triangle, foot.u, foot.v, s);
        Vec3 u = Vec3::Zero();
        for (int k = 0; k < s.size; ++k)
            for (int a = 0; a < 3; ++a) u[a] += s.n[k] * w[3 * s.vertex[k] + a];
        return u;
    }
    /// Fixes axes of control vertices for which `which` says so.
    void fix(const std::function<std::array<bool, 3>(int vertex)>& which)
    {
        for (int v = 0; v < int(fixed.size()) / 3; ++v)
            for (int a = 0; a < 3; ++a)
                if (which(v)[a]) fixed[3 * v + a] = 1;
    }
    [[nodiscard]] bool rim(int v) const { return surface.topology().kind[v] != LoopVertex::Inner; }
    [[nodiscard]] int nearest(const Vec3& p) const
    {
        int best = 0;
        const auto& x = surface.control().vertices;
        for (int v = 0; v < int(x.size()); ++v)
            if ((x[v] - p).norm() < (x[best] - p).norm()) best = v;
        return best;
    }
    [[nodiscard]] SparseMatrix stiffness() const
    {
        std::vector<Eigen::Triplet<double>> t;
        for (int c = 0; c < matrices.area.outerSize(); ++c)
            for (SparseMatrix::InnerIterator it(matrices.area, c); it; ++it)
                for (int a = 0; a < 3; ++a) t.emplace_back(3 * int(it.row()) + a, 3 * c + a, shell.spec().support * it.value());
        SparseMatrix k(matrices.elastic.rows(), matrices.elastic.cols());
        k.setFromTriplets(t.begin(), t.end());
        return k + matrices.elastic + matrices.pressure;
    }
    /// Equilibrium with the fixed unknowns and the holds of the spec. @return [3V], empty when it has none
    [[nodiscard]] std::vector<double> solve() const
    {
        std::vector<int> to(force.size(), -1);
        int n = 0;
        for (std::size_t i = 0; i < force.size(); ++i)
            if (!fixed[i] && !matrices.held[i / 3]) to[i] = n++;
        const SparseMatrix k = stiffness();
        std::vector<Eigen::Triplet<double>> t;
        for (int c = 0; c < k.outerSize(); ++c)
            for (SparseMatrix::InnerIterator it(k, c); it; ++it)
                if (to[it.row()] >= 0 && to[c] >= 0) t.emplace_back(to[it.row()], to[c], it.value());
        SparseMatrix m(n, n);
        m.setFromTriplets(t.begin(), t.end());
        Eigen::VectorXd b(n);
        for (std::size_t i = 0; i < force.size(); ++i)
            if (to[i] >= 0) b[to[i]] = force[i];
        const Eigen::SimplicialLLT<SparseMatrix> llt(m);
        if (llt.info() != Eigen::Success) return {};
        const Eigen::VectorXd x = llt.solve(b);
        std::vector<double> w(force.size(), 0);
        for (std::size_t i = 0; i < force.size(); ++i)
            if (to[i] >= 0) w[i] = x[to[i]];
        return w;
    }

    LoopSurface surface;
    double left_over;
    Shell shell;
    ShellMatrices matrices;
    std::vector<double> force;  // [3V]
    std::vector<char> fixed;    // [3V]
};

/// Tube about z of given rings: coarse spacing, fine near the middle. Normals inwards.
inline WallMesh graded_tube(double radius, double length, int around, double fine, double fine_half, double coarse)
{
    std::vector<double> z = {0};
    for (double step = fine; z.back() < length / 2 - 0.3 * step;) {
        if (z.back() > fine_half) step = std::min(coarse, 1.25 * step);
        z.push_back(z.back() + step);
    }
    const double squeeze = length / 2 / z.back();
    for (double& at : z) at *= squeeze;
    const int half = int(z.size()) - 1;
    WallMesh mesh = tube(radius, length, around, 2 * half);
    for (int j = 0; j <= 2 * half; ++j)
        for (int i = 0; i < around; ++i) mesh.vertices[j * around + i].z() = j < half ? -z[half - j] : z[j - half];
    if (half % 2)  // a ring that is not turned lies in the middle: vertices at angle 0
        for (Vec3& x : mesh.vertices) {
            const double a = pi / around, c = std::cos(a), s = std::sin(a);
            x = Vec3(c * x.x() + s * x.y(), -s * x.x() + c * x.y(), x.z());
        }
    return mesh;
}

}  // namespace seldinger::test
