#pragma once
// Tangent of the large shell, for Newton's method in tests. The engine takes what linear theory leaves out explicitly, and has
// none.

#include "shell/block_pattern.h"
#include "shell/large_shell.h"
#include "shell/shell_strain.h"

#include <array>

namespace seldinger {

struct LargeShellTangent {
    const LargeShell& of;

    /// Second derivatives of g = z . x_3 by the tangents and z = s^ab x_|ab: with c = x_,1 x x_,2 and t the part of z along the
    /// surface, d2g/dc2 = -(t x_3^T + x_3 t^T + g (1 - x_3 x_3^T)) / |c|^2, d2g/dz dc = (1 - x_3 x_3^T) / |c|.
    struct Curvature {
        Mat3 h11, h12, h22, hz1, hz2;

        Curvature(const LargeShell::Point& p, const Vec3& z)
        {
            const Mat3 along = Mat3::Identity() - outer(p.normal, p.normal);
            const Vec3 t = z - p.normal.dot(z) * p.normal;
            const Mat3 of_area =
                (outer(t, p.normal) + outer(p.normal, t) + p.normal.dot(z) * along) * (-1 / (p.stretch * p.stretch));
            const Mat3 by_1 = -skew(p.x_2), by_2 = skew(p.x_1);  // dc
            h11 = by_1.transpose() * of_area * by_1;
            h12 = by_1.transpose() * of_area * by_2 - skew(t / p.stretch);
            h22 = by_2.transpose() * of_area * by_2;
            hz1 = along * by_1 * (1 / p.stretch), hz2 = along * by_2 * (1 / p.stretch);
        }
    };

    /// Bending, membrane stress on the tangents and pressure at a point. @param membrane  stress on its strain (11, 22, 12) [N m]
    template <class Add>
    void add_point(const ShellPoint& q, const LargeShell::Point& p, const Vec3& membrane, const Add& add) const
    {
        const ShellSpec& spec = of.shell_.spec();
        const Mat3 law = q.area * std::pow(spec.thickness, 3) / 12 * of.shell_.law();
        const Vec3 m = law * p.strain.bending, n = membrane + shell_detail::join_transposed(q, m);
        Curvature curved(p, m[0] * p.x_s[0] + m[1] * p.x_s[1] + 2 * m[2] * p.x_s[2]);
        const double third = spec.pressure * q.area / 3;
        curved.h11 += n[0] * Mat3::Identity(), curved.h22 += n[1] * Mat3::Identity();
        curved.h12 += n[2] * Mat3::Identity() - third * skew(p.u);
        const Mat3 on_1 = -third * skew(p.u_2), on_2 = third * skew(p.u_1);
        const auto w = of.shell_.weights(q);
        std::array<Mat3, capacity> bending, moment, by_1, by_2, by_z, by_u;
        std::array<double, capacity> bent;
        Vec3 across_1[3], across_2[3];
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 tilt = p.tilt(p.x_s[c]);
            across_1[c] = p.x_2.cross(tilt), across_2[c] = tilt.cross(p.x_1);
        }
        for (std::size_t k = 0; k < w.size(); ++k) {
            const Shell::Weight& v = w[k];
            const double second[3] = {v.n_11, v.n_22, v.n_12};
            const Mat3 stretched = Mat3::rows(v.n_1 * p.x_1, v.n_2 * p.x_2, v.n_2 * p.x_1 + v.n_1 * p.x_2);
            Vec3 db[3];
            for (std::size_t c = 0; c < 3; ++c)
                db[c] = (c == 2 ? 2.0 : 1.0) * (second[c] * p.normal + v.n_1 * across_1[c] + v.n_2 * across_2[c]);
            const Mat3 turned = Mat3::rows(db[0], db[1], db[2]);
            for (std::size_t axis = 0; axis < 3; ++axis)
                bending[k].col(axis) = shell_detail::join(q, stretched.col(axis), turned.col(axis)).bending;
            moment[k] = law * bending[k];
            bent[k] = m[0] * v.n_11 + m[1] * v.n_22 + 2 * m[2] * v.n_12;
            by_1[k] = v.n_1 * curved.h11 + v.n_2 * curved.h12.transpose() + bent[k] * curved.hz1 + v.n * on_1;
            by_2[k] = v.n_1 * curved.h12 + v.n_2 * curved.h22 + bent[k] * curved.hz2 + v.n * on_2;
            by_z[k] = v.n_1 * curved.hz1.transpose() + v.n_2 * curved.hz2.transpose();
            by_u[k] = v.n_1 * on_1.transpose() + v.n_2 * on_2.transpose();
        }
        add([&](std::size_t i, std::size_t j) {
            return bending[i].transpose() * moment[j] + w[j].n_1 * by_1[i] + w[j].n_2 * by_2[i] + bent[j] * by_z[i] +
                   w[j].n * by_u[i];
        });
    }

    template <class Add>
    void add_triangle(std::size_t triangle, const LargeShell::Moved& now, const Add& add) const
    {
        const LargeShell::Triangle& rest = of.triangles_[triangle];
        const Mat3 law = now.area * of.shell_.spec().thickness * of.shell_.law();
        const Vec3 pulled = law * now.strain;
        std::array<Mat3, capacity> strain, stress;  // per displacement of a control vertex
        strain.fill(Mat3::Zero());
        for (std::size_t k = 0; k < LargeShell::per_triangle; ++k) {
            const ShellPoint& q = of.shell_.points()[LargeShell::per_triangle * triangle + k];
            const LargeShell::Point& p = now.at[k];
            add_point(q, p, rest.of_point[k].transpose() * pulled, add);
            const auto w = of.shell_.weights(q);
            for (std::size_t i = 0; i < w.size(); ++i)
                strain[i] +=
                    rest.of_point[k] * Mat3::rows(w[i].n_1 * p.x_1, w[i].n_2 * p.x_2, w[i].n_2 * p.x_1 + w[i].n_1 * p.x_2);
        }
        std::array<std::span<const double>, LargeShell::edge_points> n_s;
        std::array<double, LargeShell::edge_points> tension;
        for (std::size_t e = 0; e < LargeShell::edge_points; ++e) {
            n_s[e] = of.edge_weights(triangle, e);
            tension[e] = rest.of_edge[e].dot(pulled);
            for (std::size_t i = 0; i < n_s[e].size(); ++i)
                strain[i] += outer(rest.of_edge[e], n_s[e][i] * (rest.edge[e] + now.u_s[e]));
        }
        for (std::size_t i = 0; i < n_s[0].size(); ++i) stress[i] = law * strain[i];
        add([&](std::size_t i, std::size_t j) {
            double tied = 0;
            for (std::size_t e = 0; e < LargeShell::edge_points; ++e) tied += tension[e] * n_s[e][i] * n_s[e][j];
            return strain[i].transpose() * stress[j] + tied * Mat3::Identity();
        });
    }

    /// d2E/du2, symmetric, in the pattern of ShellMatrices::elastic; not positive definite beyond a limit of load.
    [[nodiscard]] SparseMatrix matrix(std::span<const double> displacement) const
    {
        const BlockPattern pattern = of.shell_.pattern();
        std::vector<double> values(9 * pattern.block_count(), 0);
        for (std::size_t t = 0; t < of.triangles_.size(); ++t) {
            const auto w = of.shell_.weights(of.shell_.points()[LargeShell::per_triangle * t]);
            const StencilBlocks blocks(pattern, w);
            add_triangle(t, of.move(t, displacement), [&](const auto& block) { blocks.add<3>(values, w.size(), block); });
        }
        return pattern.matrix(values, 3);
    }

private:
    static constexpr std::size_t capacity = LoopStencil::capacity;
};

}  // namespace seldinger
