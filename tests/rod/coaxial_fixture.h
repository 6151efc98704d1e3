#pragma once
// Instruments in one centreline with everything they need, for tests: where they start, their equilibrium by damped Newton.

#include "math/eigen.h"
#include "rod/coaxial.h"
#include "rod/transport.h"
#include "support/approx.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <random>
#include <vector>

namespace seldinger::test {

using std::numbers::pi;
using test::about;

/// A wire of one stiffness, curved over a part at its tip. [N m^2], [1/m], [m]
inline WireSpec instrument_spec(double length, double bend, double twist, double curved = 0, double curvature = 0)
{
    WireSpec spec;
    spec.length = length;
    spec.shaft.radius = 0.5e-3;
    spec.shaft.density = 6500;
    spec.shaft.bend_stiffness = bend;
    spec.shaft.twist_stiffness = twist;
    // of a round wire of that radius: stretches by 1e-6 of its length under the forces here, and EA l^2/B = 16 for edges of 1 mm
    spec.shaft.stretch_stiffness = 4 * bend / (spec.shaft.radius * spec.shaft.radius);
    if (curved > 0) {
        spec.sections.push_back({0, curved, spec.shaft});
        spec.sections[0].section.rest_curvature = {curvature, 0};
    }
    return spec;
}

class Coaxial {
public:
    /// Straight from the origin along +x, with the tip of the longest at node 0 and all angles 0. A natural curvature (k, 0)
    /// bends towards +y and one that is turned by `angle` towards (cos, -sin) in (y, z).
    /// @param inserted  beyond the sleeve [m]
    Coaxial(std::vector<WireSpec> instruments, const std::vector<double>& inserted, int edges)
        : specs(std::move(instruments)),
          n(edges + 1),
          arrays(std::vector<int>{n}),
          line(arrays.view(0)),
          rod(n, static_cast<int>(specs.size())),
          frames(coaxial_frames(n)),
          hessian(n, rod.instruments)
    {
        const double length = *std::ranges::max_element(inserted);
        for (int i = 0; i < n; ++i) {
            line.material_s[i] = length * i / edges;
            line.set_pos(i, {length - line.material_s[i], 0, 0});
        }
        for (int k = 0; k < rod.instruments; ++k) rod.instrument[k] = {&specs[k], inserted[k] - length};
        base.tangent = -Vec3::UnitX();
        base.director = Vec3::UnitY();
        initialise_frames(line, base.director);
        prepare_coaxial(rod, line);
    }
    Coaxial(const Coaxial&) = delete;

    [[nodiscard]] CoaxialTrial now() const
    {
        CoaxialTrial trial{line.x, line.y, line.z, {}};
        for (int k = 0; k < rod.instruments; ++k) trial.theta[k] = rod.theta[k];
        return trial;
    }
    /// Makes the trial configuration of `frames` the accepted one.
    void take(const CoaxialTrial& trial)
    {
        for (int k = 0; k < rod.instruments; ++k) std::copy_n(trial.theta[k].begin(), n, rod.theta[k].begin());
        accept_frames(line, {trial.x, trial.y, trial.z, trial.theta[0]}, frames);
    }
    [[nodiscard]] int size() const { return rod.dofs().count(n); }
    [[nodiscard]] bool update() { return update_coaxial(rod, line, now(), base, frames); }
    [[nodiscard]] double energy() const { return coaxial_energy({rod, line, now(), base, frames}); }
    [[nodiscard]] CoaxialHands hands() const { return coaxial_hands({rod, line, now(), base, frames}); }

    /// Energy and gradient (may be null) at the accepted state moved by `step` [unknowns]; NaN where there is none.
    double at(const Eigen::VectorXd& step, Eigen::VectorXd* gradient = nullptr, bool accept = false)
    {
        const CoaxialDofs dofs = rod.dofs();
        std::vector<double> q[3 + most_coaxial];
        CoaxialTrial trial;
        for (int c = 0; c < 3; ++c) {
            const auto from = c == 0 ? line.x : c == 1 ? line.y : line.z;
            q[c].assign(from.begin(), from.end());
        }
        for (int k = 0; k < rod.instruments; ++k) q[3 + k] = rod.theta[k];
        for (int p = 0; p < dofs.per_node(); ++p)
            for (int i = 0; i < n; ++i) q[p][i] += step[dofs.position(i, p)];
        trial.x = q[0], trial.y = q[1], trial.z = q[2];
        for (int k = 0; k < rod.instruments; ++k) trial.theta[k] = q[3 + k];
        if (!update_coaxial(rod, line, trial, base, frames)) return std::nan("");
        if (gradient) {
            gradient->setZero(size());
            add_coaxial({rod, line, trial, base, frames}, {gradient->data(), static_cast<std::size_t>(size())}, nullptr,
                        HessianMode::None);
        }
        const double energy = coaxial_energy({rod, line, trial, base, frames});
        if (accept) take(trial);
        return energy;
    }

    [[nodiscard]] Eigen::VectorXd zero() const { return Eigen::VectorXd::Zero(size()); }
    [[nodiscard]] Eigen::VectorXd assemble(HessianMode mode)
    {
        Eigen::VectorXd gradient = zero();
        hessian.reset(n);
        add_coaxial({rod, line, now(), base, frames}, {gradient.data(), static_cast<std::size_t>(size())}, &hessian, mode);
        return gradient;
    }
    [[nodiscard]] Eigen::MatrixXd dense(HessianMode mode)
    {
        (void)assemble(mode);
        Eigen::MatrixXd h(size(), size());
        for (int i = 0; i < size(); ++i)
            for (int j = 0; j < size(); ++j) h(i, j) = hessian.at(i, j);
        return h;
    }

    /// Unknowns that do not move: the hub, the clamp's angles where the hand is at it, idle angles.
    [[nodiscard]] std::vector<char> held() const
    {
        const CoaxialDofs dofs = rod.dofs();
        std::vector<char> result(static_cast<std::size_t>(size()), 0);
        for (int c = 0; c < 3; ++c) result[dofs.position(n - 1, c)] = 1;
        for (int k = 0; k < rod.instruments; ++k) {
            if (!(base.behind[k] > 0)) result[dofs.spin(n - 1, k)] = 1;
            for (int j = 0; j < n; ++j)
                if (coaxial_idle(rod, j, k)) result[dofs.spin(j, k)] = 1;
        }
        return result;
    }

    /// Angles of instrument k to `angle`, all of them.
    void roll(int k, double angle) { std::fill_n(rod.theta[k].begin(), n, angle); }
    /// The hand (or clamp) turns instrument k by so much more; the whole of it goes along.
    void turn(int k, double by)
    {
        for (double& theta : rod.theta[k]) theta += by;
        base.hand[k] += by;
    }

    /// Into the shape that the present angles have without twisting: turning angles of the cells, hub to tip.
    void bend_to_rest()
    {
        Vec3 t = base.tangent, d1 = base.director;
        for (int i = n - 1; i > 0; --i) {
            CoaxialCell::Complex rest = 0;
            for (int k = 0; k < rod.instruments; ++k) rest += std::polar(1.0, rod.theta[k][i - 1]) * rod.cells[i].rest[k];
            // towards the hub t turns by `rest` towards (d1, d2), so towards the tip the other way
            const Vec3 axis = t.cross(rest.real() * d1 + rest.imag() * t.cross(d1));
            if (axis.norm() > 0) {
                const Vec3 unit = axis.normalized();
                const Mat3 turn = to_mat3(Eigen::AngleAxisd(-axis.norm(), eigen(unit)).toRotationMatrix());
                t = turn * t;
                d1 = turn * d1;
            }
            line.set_pos(i - 1, line.pos(i) - line.rest_length[i - 1] * t);
        }
        std::array<std::vector<double>, most_coaxial> angles = rod.theta;
        initialise_frames(line, base.director);
        const Vec3 te = line.tangent(n - 2);  // parallel from the clamp, as the angles are
        line.set_ref_d1(n - 2, parallel_transport(base.director, base.tangent, te, one_plus_cos(base.tangent, te)));
        for (int j = n - 3; j >= 0; --j) {
            const Vec3 from = line.tangent(j + 1), to = line.tangent(j);
            line.set_ref_d1(j, unit_normal(parallel_transport(line.ref_d1(j + 1), from, to, one_plus_cos(from, to)), to));
        }
        rod.theta = angles;
    }

    /// Newton with the exact Hessian, made definite by a shift of its diagonal, steps cut where energy does not fall; frames are
    /// accepted at every iterate. @return iterations; -1 not within `most`
    int equilibrate(int most = 200)
    {
        if (!update()) return -1;
        const std::vector<char> fixed = held();
        const double length = line.material_s[n - 1];
        double shift = 0;
        for (int iteration = 0; iteration < most; ++iteration) {
            if (!update()) return -1;
            Eigen::VectorXd gradient = assemble(HessianMode::Exact), step;
            for (int q = 0; q < size(); ++q)
                if (fixed[q]) gradient[q] = 0;
            if (!solve(fixed, gradient, shift, step)) return -1;
            const double start = energy(), slope = gradient.dot(step);
            double largest = 0;  // in lengths and radians
            for (int q = 0; q < size(); ++q)
                largest = std::max(largest, std::abs(step[q]) / (q % rod.dofs().per_node() < 3 ? length : 1.0));
            double part = std::min(1.0, 0.3 / std::max(largest, 1e-300));
            // rounding of the energy: it is not asked to fall by less
            while (part > 1e-12) {
                const double moved = at(part * step);
                if (std::isfinite(moved) && moved <= start + 1e-4 * part * slope + 1e-12 * std::abs(start) + 1e-18) break;
                part *= 0.5;
            }
            if (!std::isfinite(at(part * step, nullptr, true))) return -1;
            if (shift == 0 && part == 1 && largest < 1e-9) return iteration;
        }
        return -1;
    }

    /// Whether the exact Hessian is positive definite at the accepted state.
    [[nodiscard]] bool stable()
    {
        if (!update()) return false;
        const Eigen::VectorXd gradient = assemble(HessianMode::Exact);
        Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix(held(), 0));
        return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0;
    }

    [[nodiscard]] Vec3 tip() const { return line.pos(0); }
    /// Point of the centreline at coordinate s, linear between nodes: instrument k ends at -offset.
    [[nodiscard]] Vec3 point(double s) const
    {
        int j = 0;
        while (j + 2 < n && line.material_s[j + 1] <= s) ++j;
        const double w = (s - line.material_s[j]) / line.rest_length[j];
        return (1 - w) * line.pos(j) + w * line.pos(j + 1);
    }
    [[nodiscard]] Vec3 end(int k) const { return point(-rod.instrument[k].offset); }
    /// Material angle of instrument k about the direction of insertion, relative to the clamp's director carried along in
    /// parallel, at coordinate s [deg]; between edges' middles linear.
    [[nodiscard]] double angle_deg(int k, double s)
    {
        REQUIRE(update());
        std::vector<double> angle(static_cast<std::size_t>(n));
        angle[n - 1] = rod.theta[k][n - 1];
        double ref = 0;
        for (int j = n - 2; j >= 0; --j) {
            ref += j == n - 2 ? frames.clamp_ref_twist[0] : frames.ref_twist[j + 1];
            angle[j] = rod.theta[k][j] - ref;
        }
        const auto middle = [&](int j) {
            return j == n - 1 ? line.material_s[j] : 0.5 * (line.material_s[j] + line.material_s[j + 1]);
        };
        int j = 0;
        while (j + 2 < n && (middle(j + 1) <= s || coaxial_idle(rod, j, k))) ++j;
        const double w = std::max(0.0, (s - middle(j)) / (middle(j + 1) - middle(j)));
        return -180 / pi * ((1 - w) * angle[j] + w * angle[j + 1]);
    }

    std::vector<WireSpec> specs;
    int n;
    RodArrays arrays;
    RodView line;
    CoaxialRod rod;
    CoaxialBase base;
    RodFrames frames;
    CoaxialHessian hessian;

private:
    [[nodiscard]] Eigen::SparseMatrix<double> matrix(const std::vector<char>& fixed, double shift) const
    {
        std::vector<Eigen::Triplet<double>> entries;
        const int reach = rod.dofs().half_bandwidth();
        for (int j = 0; j < size(); ++j)
            for (int i = j; i <= std::min(size() - 1, j + reach); ++i) {
                if (fixed[i] || fixed[j]) {
                    if (i == j) entries.emplace_back(i, j, 1.0);
                } else if (const double value = hessian.at(i, j); value != 0 || i == j) {
                    entries.emplace_back(i, j, i == j ? value + shift * std::abs(value) : value);
                }
            }
        Eigen::SparseMatrix<double> result(size(), size());
        result.setFromTriplets(entries.begin(), entries.end());
        return result;
    }
    bool solve(const std::vector<char>& fixed, const Eigen::VectorXd& gradient, double& shift, Eigen::VectorXd& step) const
    {
        shift = 0;
        for (int tries = 0; tries < 40; ++tries, shift = std::max(1e-9, 4 * shift)) {
            Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix(fixed, shift));
            if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) continue;
            step = factor.solve(-gradient);
            return true;
        }
        return false;
    }
};

}  // namespace seldinger::test
