#pragma once
// Forces on one wire that the host computes without neighbours: weight and dead loads, links (springs to points), damping by
// mass. The verbs are those of solve/force_term.h; these terms are part of every wire's equations, summed with them in one pass.

#include "math/band_matrix.h"
#include "rod/elastic.h"
#include "solve/time_scheme.h"
#include "solve/wire_constraints.h"
#include "solve/wire_unknowns.h"

#include <vector>

namespace seldinger {

/// Weight and dead forces, the same at every trial; dead moments, which turn the edge that they act on.
class DeadLoads {
public:
    explicit DeadLoads(int capacity);
    void begin(const RodView& rod, const WireConstraints& constraints, const Vec3& gravity);
    /// Weight and forces on all unknowns [N].
    [[nodiscard]] const double* forces() const { return forces_.data(); }
    /// Minus the moments' forces and torques into R; torques on the spins of others in its centreline: solve/coaxial_problem.h.
    void add_moments_to_residual(const RodFrames& frames, std::span<double> r) const;
    /// @param symmetric  the symmetric part alone
    void add_moments_to_tangent(const RodFrames& frames, BandRows& tangent, bool symmetric) const;
    /// Whether there are moments: these have no potential.
    [[nodiscard]] bool unsymmetric() const;
    /// Adds the dead forces, without weight [N].
    void add_to_sum(Vec3& sum) const;
    /// What residuals are compared with: |force| and |moment|/length, summed [N].
    [[nodiscard]] double scale(double length) const;
    void prefetch(int unknowns) const;

private:
    const WireConstraints* constraints_ = nullptr;
    std::vector<double> forces_;  // [unknowns]
};

/// Springs from points of the wire to anchors: f = k (anchor - x), x at the mean of the step where the scheme takes means.
class Links {
public:
    void begin(const WireConstraints& constraints, double end_share);
    void add_to_residual(const WireUnknowns& q, std::span<double> r) const;
    void add_to_tangent(BandRows& tangent) const;
    void add_to_sum(const WireUnknowns& q, Vec3& sum) const;
    /// |f| at the start, summed [N].
    [[nodiscard]] double scale(const RodView& rod) const;

private:
    [[nodiscard]] Vec3 pull(const WireConstraints::Spring& spring, const WireUnknowns& q) const;
    const WireConstraints* constraints_ = nullptr;
    double end_share_ = 1;
};

/// f = -c_m M v, the resistance of the surroundings.
class MassDamping {
public:
    void begin(const IntegratorSpec& spec, Motion motion) { rate_ = motion == Motion::Static ? 0 : spec.damping_mass; }
    /// c_m v into accelerations, which are multiplied by inertia later.
    void add_to_accelerations(const TimeScheme& time, const WireUnknowns& q, std::span<double> a) const;
    /// Its part of what multiplies inertia on the diagonal.
    [[nodiscard]] double diagonal_rate(const TimeScheme& time) const { return rate_ * time.damping_rate(); }
    void add_to_sum(const TimeScheme& time, const WireUnknowns& q, Vec3& sum) const;
    /// Energy that it takes in the step [J].
    [[nodiscard]] double work(const TimeScheme& time, const WireUnknowns& q) const;

private:
    double rate_ = 0;  // [1/s]
};

/// A stiffness between the ends of edge j: K (dx_{j+1} - dx_j) is the force on node j + 1, and its opposite that on node j.
void add_edge_block(BandRows& matrix, int j, const Mat3& k);

}  // namespace seldinger
