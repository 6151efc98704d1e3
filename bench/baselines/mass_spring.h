#pragma once
// A chain of point masses, axial springs and bending springs, by symplectic Euler: the class of models behind most real-time
// simulators. No twist. The clamp is a bending spring of half an edge (2 B / h) between the first edge and the clamp's direction,
// second order in the edge length. Fixing the first two masses, as is usual, is first order and would flatter the other
// methods.

#include "baselines/baselines.h"

namespace seldinger::baselines {

/// Softened: axial springs of 4 B / h instead of EA / h, so that bending and not stretching limits the step. The usual remedy;
/// the wire then stretches visibly, and the more so the coarser it is.
enum class Axial { True, Softened };

/// Axial spring  E = EA/(2h) (|e| - h)^2 ;  bending spring  E = B/(2h) phi^2, phi the angle between two edges.
class MassSpring final : public Simulation {
public:
    MassSpring(const Cantilever& wire, Axial axial);

    /// Divides dt into steps of 0.7 of the stability limit 2/omega of its shortest wave.
    [[nodiscard]] StepReport step(double dt) override;
    [[nodiscard]] StepReport settle() override;  // not offered: StepNotConverged
    [[nodiscard]] WireReadings readings() const override;
    [[nodiscard]] std::vector<Vec3> shape() const override { return position_; }
    [[nodiscard]] std::vector<ForceAt> contact_forces() const override { return {}; }

private:
    void find_forces();
    void sub_step(double h);
    [[nodiscard]] double elastic_energy() const;

    Cantilever wire_;
    double axial_stiffness_, longest_step_;  // k [N/m], [s]
    double time_ = 0;
    std::vector<Vec3> position_, velocity_, force_;
};

}  // namespace seldinger::baselines
