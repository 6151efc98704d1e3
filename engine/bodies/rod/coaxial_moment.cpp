// The bending moment of a common centreline and its shares.
#include "rod/coaxial_moment.h"

#include "rod/coaxial_stencil.h"

namespace seldinger {

using namespace coaxial;

void measure_moments(const CoaxialShape& shape, CoaxialMoments& out)
{
    const auto& [rod, line, trial, base, frames] = shape;
    const int hub = line.n - 1;
    out.moment.assign(static_cast<std::size_t>(line.n), Complex(0));
    out.parallel.assign(static_cast<std::size_t>(line.n), 0.0);
    // not twisted, angles change by as much as the reference frames do
    out.parallel[hub] = -frames.clamp_ref_twist[0];
    for (int i = hub - 1; i > 0; --i) out.parallel[i - 1] = out.parallel[i] + frames.ref_twist[i];
    for (int i = 1; i <= hub; ++i) {
        const CoaxialCell& cell = rod.cells[i];
        if (!(cell.covered > 0)) continue;
        const Stencil s = stencil_at(shape, i);
        Complex strain = cell.covered / cell.length * s.kappa;
        for (int k = 0; k < rod.instruments; ++k) strain -= s.phase[k] * cell.rest[k];
        out.moment[i] = std::polar(1 / cell.compliance, -0.5 * (out.parallel[i - 1] + out.parallel[i])) * strain;
    }
}

CoaxialShare share_in(const CoaxialRod& rod, const CoaxialPiece& piece, const CoaxialTrial& trial, const CoaxialMoments& moments,
                      int j, int from, int until)
{
    CoaxialShare share;
    Complex wanted = 0, of_own = 0;  // sums of B_k R_k kappa_k
    for (int k = 0; k < rod.instruments; ++k) {
        const WireSection* section = piece.section[k];
        if (!section) continue;
        const bool own = k >= from && k < until;
        (own ? share.stiffness : share.others) += section->bend_stiffness;
        if (section->rest_curvature.isZero()) continue;
        const Complex natural(section->rest_curvature[0], section->rest_curvature[1]);
        const Complex turned = section->bend_stiffness * std::polar(1.0, trial.theta[k][j] - moments.parallel[j]) * natural;
        wanted += turned;
        if (own) of_own += turned;
    }
    if (share.stiffness + share.others > 0) share.natural = wanted / (share.stiffness + share.others);
    if (share.stiffness > 0) share.own = share.stiffness * share.natural - of_own;
    return share;
}

}  // namespace seldinger
