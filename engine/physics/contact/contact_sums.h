#pragma once
// Compares two views of contact: the samples behind readings, which each evaluation leaves on the device, and the forces on the
// nodes, whose sums the solver balanced. Where they differ, the samples are those of another state.
//
// Both add the same numbers in another order. A sum of n non-negative numbers has an error of at most (n - 1) eps, eps the
// rounding of a product [Higham, Accuracy and Stability of Numerical Algorithms, 2002, sec. 4.2]. The difference of two sums has
// twice that, and as much again for the magnitudes rounded before. In a float32 context the device's sums round to 2^-24.
//
// A reading of the load along a wire (force_per_length.h) cannot exceed its sum. The load between two places is a difference of
// running sums of slopes F/l times lengths. These are differences of coordinates, rounded in proportion to the coordinate: where
// one short stretch touches far from the tip, that is most of the error. It is at most 4 n eps (sum F + s sum F/l), n the number
// of ends and s the farthest of them from the tip.

#include "contact/edge_sums.h"
#include "contact/force_per_length.h"

namespace seldinger {

/// Whether normal forces and friction of samples come to those of the nodes. @param samples  their number
[[nodiscard]] bool add_up(double normal, double friction, std::size_t samples, const ContactTotals& totals, bool float32);

/// Whether force on a patch, and force per length times its window, are at most the sum of all normal forces.
[[nodiscard]] bool within_sum(const ContactAlong& along, const WireLoads& loads);

}  // namespace seldinger
