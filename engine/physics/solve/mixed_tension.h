#pragma once
// Tensions of a wire's edges as separate unknowns, condensed out of the equations ([Magisano17], newton/direction.h).
//
// The shape's own tension N(q) = EA (|e|/l - 1) changes by EA phi^2/2 when an edge turns by phi, far more than any real force.
// The mixed equations keep N as an unknown and linearise its law: from the base, where a direction d starts,
//
//   N_predicted(alpha) = (1 - alpha) N_base + alpha EA/l (|e|_base - l + t_base . (d_{j+1} - d_j))
//
// Geometric stiffness and the test of a trial take N_predicted; at the solution both agree. Conserving, lengths and directions
// are means over the step: N = EA (m/l - 1), m the mean length, acting along the mean direction b.

#include "math/band_matrix.h"
#include "rod/elastic.h"
#include "solve/wire_unknowns.h"

#include <vector>

namespace seldinger {

/// Length, direction and tension of a wire's edges at the trial that `frames` are of; conserving, means over the step.
struct EdgeStretch {
    const RodView& rod;
    const RodFrames& frames;
    const RodFrames& start;  // of q_0; conserving
    bool conserving;
    double base_grown;  // rest length that the base edge of a fed wire has gained over the step [m]

    [[nodiscard]] double length(int j) const;
    /// The same over the rest length is the strain, also of an edge whose rest length has grown over the step.
    [[nodiscard]] double strained_length(int j) const;
    [[nodiscard]] double tension(int j) const;  // [N]
    [[nodiscard]] Vec3 direction(int j) const;
};

class MixedTension {
public:
    explicit MixedTension(int capacity);

    /// At the start of a step: that of the shape, or what `of_edge(j)` says.
    template <class OfEdge>
    void begin(const RodView& rod, const OfEdge& of_edge)
    {
        for (int j = 0; j < rod.n - 1; ++j) predicted_[j] = of_edge(j);
    }
    /// The trial becomes the base, with the tension that was predicted for it.
    void set_base(const EdgeStretch& now);
    /// Tension at base + alpha d, as the linear equations have it.
    void predict(const EdgeStretch& now, std::span<const double> d, double alpha);
    /// The same after a further `correction` from the trial, where frames are.
    void correct(const EdgeStretch& now, std::span<const double> correction);
    /// R with the tension that was not predicted taken along the base's tangents, in place of R.
    void change_residual(const EdgeStretch& now, std::span<double> r) const;
    /// Puts the predicted tension in place of the shape's in the tangent. @param symmetric  its symmetric part alone
    void change_tangent(const EdgeStretch& now, HessianMode mode, bool symmetric, BandRows& tangent) const;
    /// After one linearised step: its own tensions into the residual, in place of those of the trial's shape, which turning by
    /// phi has raised by EA phi^2/2. Reactions are then forces of the equations that have been solved.
    /// @return what the base edge had beyond [N]
    double take_linear(const EdgeStretch& now, std::span<double> residual) const;

    void prefetch(int nodes) const;

private:
    // [capacity] per edge: tension at the base and predicted for the trial [N], the base's elongation [m], its tangents and the
    // directions of its tensions
    std::vector<double> base_, predicted_, base_longer_;
    std::vector<Vec3> base_tangent_, base_direction_;
};

}  // namespace seldinger
