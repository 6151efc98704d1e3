#pragma once
// Splits the bending moment of a common centreline among its instruments, in a frame that is transported along the line.
//
// M(s), the line's, is linear between nodes. With B = sum B_k over the instruments there, the curvature of the line is r + M/B, r
// = sum B_k R_k kappa_k / B. Instrument k carries M_k = B_k (r + M/B - R_k kappa_k): M_k jumps where B or r do, M does not.

#include "rod/coaxial.h"

#include <vector>

namespace seldinger {

struct CoaxialMoments {
    using Complex = CoaxialCell::Complex;
    std::vector<Complex> moment;   // [nodes] M [N m]
    std::vector<double>
        parallel;  // [nodes] angle of the parallel frame in each edge's reference frame, the last one the clamp's [rad]
};

/// Measures the moments of a configuration.
void measure_moments(const CoaxialShape& shape, CoaxialMoments& out);

/// Share of the instruments `from` to `until` - 1 among all instruments there.
struct CoaxialShare {
    double stiffness = 0, others = 0;       // their B, that of the rest [N m^2]
    CoaxialMoments::Complex own = 0;        // sum of B_k (r - R_k kappa_k) [N m]
    CoaxialMoments::Complex natural = 0;    // r [1/m]
    /// Their part of the line's moment.
    [[nodiscard]] CoaxialMoments::Complex of(CoaxialMoments::Complex moment) const
    {
        return stiffness > 0 ? stiffness / (stiffness + others) * moment + own : 0.0;
    }
    [[nodiscard]] CoaxialMoments::Complex curvature(CoaxialMoments::Complex moment) const
    {
        return stiffness + others > 0 ? natural + moment / (stiffness + others) : 0.0;
    }
};
/// In a piece of the line, on edge j.
[[nodiscard]] CoaxialShare share_in(const CoaxialRod& rod, const CoaxialPiece& piece, const CoaxialTrial& trial,
                                    const CoaxialMoments& moments, int j, int from, int until);

}  // namespace seldinger
