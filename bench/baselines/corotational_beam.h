#pragma once
// Two-node Euler-Bernoulli beams in frames that go with them (corotational finite elements), by backward Euler: the class of
// models behind the open simulation frameworks. [Crisfield90] for the frame, standard 12 x 12 stiffness in it.

#include "baselines/baselines.h"

#include <Eigen/Core>

namespace seldinger::baselines {

/// Per element, in its frame: axial force EA u / l; end moments (B/l)(4 a + 2 b), (B/l)(2 a + 4 b) of the end rotations a, b out
/// of the chord; torque (C/l)(b - a); shear from equilibrium. Per node six unknowns: position, and a small rotation that turns
/// its frame.
class CorotationalBeam final : public Simulation {
public:
    /// @param iterations  1: one linear solve per step, as real-time codes do; more: Newton until the residual is 1e-6 of the
    /// load
    CorotationalBeam(const Cantilever& wire, int iterations);

    [[nodiscard]] StepReport step(double dt) override;
    [[nodiscard]] StepReport settle() override;  // not offered: StepNotConverged
    [[nodiscard]] WireReadings readings() const override;
    [[nodiscard]] std::vector<Vec3> shape() const override { return position_; }
    [[nodiscard]] std::vector<ForceAt> contact_forces() const override { return {}; }

private:
    using Vec6 = Eigen::Matrix<double, 6, 1>;
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    struct Element {  // forces and stiffness on its two nodes, world axes
        Vec6 gradient_a, gradient_b;
        Mat6 aa, ab, bb;
        double energy;
    };
    [[nodiscard]] Element element(int j) const;
    void assemble(double dt);
    [[nodiscard]] double largest_residual() const;
    void solve_and_move();

    Cantilever wire_;
    int iterations_;
    double time_ = 0;
    std::vector<Vec3> position_, velocity_, spin_;
    std::vector<Mat3> frame_;  // columns: along the wire (tip to base), and two across
    std::vector<Vec3> position_t0_;
    std::vector<Mat3> frame_t0_;
    std::vector<Vec6> residual_;          // [free nodes]
    std::vector<Mat6> diagonal_, upper_;  // block tridiagonal, symmetric
    Vec3 base_force_ = Vec3::Zero();
};

}  // namespace seldinger::baselines
