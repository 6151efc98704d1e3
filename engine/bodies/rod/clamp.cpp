// Angle between a clamp and the edges that meet there, and the energy of its springs.
#include "rod/clamp.h"

#include "core/check.h"

namespace seldinger {

double clamp_reference(const RodClamp& clamp, int side, const Vec3& tangent, const Vec3& d1, double last)
{
    // the director before it was turned, so that full turns of the clamp stay out of the angle that is unwrapped
    const Vec3 unturned = turned(clamp.director, clamp.tangent, -clamp.turns);
    const double chi = one_plus_cos(clamp.tangent, tangent);
    const double angle = side == 0 ? signed_angle(parallel_transport(d1, tangent, clamp.tangent, chi), unturned, clamp.tangent)
                                   : signed_angle(parallel_transport(unturned, clamp.tangent, tangent, chi), d1, tangent);
    return unwrap(angle, last);
}

bool update_clamp(const RodView& rod, const RodTrial& trial, const RodClamp& clamp, int k, RodFrames& frames)
{
    SEL_ASSERT(clamp.node >= 0 && clamp.node < rod.n);
    frames.clamp_node[k] = clamp.node;
    for (int side = 0; side < 2; ++side) {
        double &ref = frames.clamp_ref_twist[2 * k + side], &twist = frames.clamp_twist[2 * k + side];
        ref = twist = 0;
        const int edge = clamp_edge(rod, clamp.node, side);
        if (edge < 0) continue;
        if (!(one_plus_cos(clamp.tangent, frames.tangent[edge]) > fold_limit)) return false;
        if (!clamp.spin || !frames.spins) continue;
        const double last = side == 0 ? rod.clamp_twist_a[clamp.node] : rod.clamp_twist_b[clamp.node];
        ref = clamp_reference(clamp, side, frames.tangent[edge], frames.d1[edge], last);
        twist = side == 0 ? clamp.turns - trial.theta[edge] + ref : trial.theta[edge] - clamp.turns + ref;
    }
    return true;
}

ClampSide clamp_side(const RodView& rod, const RodClamp& clamp, const RodFrames& frames, int k, int side)
{
    ClampSide result;
    result.edge = clamp_edge(rod, clamp.node, side);
    const int j = result.edge;
    result.half = 0.5 * rod.rest_length[j];
    result.share = result.half / rod.voronoi_length(clamp.node);
    result.twist = frames.clamp_twist[2 * k + side];

    Pair& pair = result.pair;
    (side == 0 ? pair.te : pair.tf) = frames.tangent[j];
    (side == 0 ? pair.tf : pair.te) = clamp.tangent;
    (side == 0 ? pair.inv_e : pair.inv_f) = 1 / frames.edge_length[j];
    pair.chi = one_plus_cos(pair.te, pair.tf);
    pair.kb = (2 / pair.chi) * pair.te.cross(pair.tf);
    pair.q = curvature_q(rod.curvature);

    result.spins = frames.spins;
    result.material = frames.spins && frames.material;
    if (!result.material) return result;
    RestBend& rest = result.rest;
    rest.kappa1 = result.share * rod.rest_kappa1[clamp.node];
    rest.kappa2 = result.share * rod.rest_kappa2[clamp.node];
    if (clamp.spin) {
        rest.n1 = turned(side == 0 ? frames.m1[j] : clamp.director, pair.te, 0.5 * result.twist);
    } else {
        rest.mu = side == 0 ? -0.5 : 0.5;  // the frame is the edge's own
        rest.n1 = side == 0 ? frames.m1[j] : parallel_transport(frames.m1[j], pair.tf, pair.te, pair.chi);
    }
    return result;
}

double clamp_energy(const RodView& rod, const RodClamp& clamp, const ClampSide& side)
{
    double energy = 0;
    if (clamp.direction) {
        const Pair& pair = side.pair;
        double squared = squared_curvature(pair.q, pair.chi, pair.kb);  // of kappa - rest_kappa
        if (side.material)
            squared = (kappa_in(pair, side.rest.n1) - Vec2(side.rest.kappa1, side.rest.kappa2)).squaredNorm();
        energy += rod.bend_stiffness[clamp.node] / (2 * side.half) * squared;
    }
    if (clamp.spin) {
        const double strain = side.twist - side.share * rod.rest_twist[clamp.node];
        energy += rod.twist_stiffness[clamp.node] / (2 * side.half) * strain * strain;
    }
    return energy;
}

void add_clamp(const RodView& rod, const RodClamp& clamp, const ClampSide& side, HessianMode mode, PairTerms& out)
{
    if (clamp.direction) add_bend(side.pair, rod.bend_stiffness[clamp.node] / side.half, side.rest, mode, out);
    if (clamp.spin && side.spins)
        add_twist(side.pair, rod.twist_stiffness[clamp.node] / side.half, side.twist - side.share * rod.rest_twist[clamp.node],
                  mode, out);
}

}  // namespace seldinger
