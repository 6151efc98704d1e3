#pragma once
// Adaptive nodes of instruments that share a centreline. nodes/adapt.h judges a line's nodes; its edges are split and merged
// anywhere along it. As for wires (nodes/split.h), forces of the instruments do not jump.
//
// Moments: M = dE/d(integrated curvature) of a cell, of all instruments together. Where an instrument ends or changes its section
// the curvature jumps and M does not, wherever in a cell that is (rod/coaxial.h): the measure of nodes/adapt.h holds as for a
// wire.
//
// Twist: instruments curved by nature turn each other, by a torque per length q_k(s) that begins and ends where their curves do.
// Each node's twist is that of its cell's middle. So the angle of k is off by J h^2/(12 C_k), as a bending angle is off by a
// jump of shear. J is the jump of the slope of its torque at the node. That moves the tip of k by as much as it is off the
// axis:
//
//     e(h) = sum_k r_k J_k h^2/(12 C_k)                                                       [m]
//
// r_k: distance of the line from its own tangent at the node, at k's tip or at longest_lever, whichever is nearer. An instrument
// alone at a place is judged as a wire, which has no such term.

#include "nodes/split.h"
#include "rod/coaxial.h"

namespace seldinger {

/// NodeDemands::moment [n] [N m] and ::turning [n] [1/m] of a configuration. O(n), no allocation.
void measure_coaxial(const CoaxialShape& shape, std::span<Vec3> moment, std::span<double> turning);

/// prepare_coaxial(), and what of it the instruments keep in their own arrays.
/// @param wires  of `rods`: the line, then its passengers (solve/coaxial_group.h); all have as many nodes at the same places
void prepare_group(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod);
/// The line's places and frames into the passengers' arrays.
void follow_line(RodArrays& rods, std::span<const int> wires);

/// The accepted configuration.
[[nodiscard]] CoaxialTrial accepted_trial(RodArrays& rods, std::span<const int> wires);

/// The nodes of instruments on one centreline, to be split and merged. prepare_coaxial() has been called for their offsets.
class CoaxialNodes : public RodNodes {
public:
    /// @param frames  scratch, coaxial_frames()
    CoaxialNodes(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base, RodFrames& frames);
    CoaxialNodes(const CoaxialNodes&) = delete;
    CoaxialNodes& operator=(const CoaxialNodes&) = delete;
    [[nodiscard]] double stretch_stiffness(double begin, double end) const override;
    void refresh_rest(int first) const override;
    [[nodiscard]] bool reaches(int k, int node) const override { return rod_.cells[node].twist_covered[k] > 0; }
    [[nodiscard]] double clamp_angle(const RodClamp& clamp, int k) const override { return instrument(k).theta[clamp.node]; }
    [[nodiscard]] Vec3 natural_at_end(int j) const override;
    [[nodiscard]] bool pull_at_base(SplitScratch& scratch, Vec3& pull, Vec3& tangent) const override;
    void follow_line() const override;

private:
    [[nodiscard]] std::span<const int> wires() const { return {wires_.data(), static_cast<std::size_t>(count_)}; }
    CoaxialRod& rod_;
    const CoaxialBase& base_;
    RodFrames& frames_;
    RodClamp sleeve_;
};

}  // namespace seldinger
