#pragma once
// Clamps: a prescribed tangent (and director) at a node, coupled to the edges there by half a Voronoi cell of wire each.
// With a = rest_length/2 the spring B/a is the wire between the node and the middle of its edge, where the edge's tangent is that
// of the wire to second order. Freezing the whole edge instead would shorten the free length by that half.

#include "rod/pair.h"

namespace seldinger {

/// One edge at a clamp. Side 0: the edge on the tip side (clamp is the pair's f); side 1: hub side (clamp is e).
struct ClampSide {
    int edge = -1;
    Pair pair;
    double half = 0;       // a [m]
    double share = 0;      // of the node's rest curvature and twist that lies on this side
    double twist = 0;      // tau between clamp and edge, 0 without spin [rad]
    bool spins = true;     // RodFrames::spins; else no rest and no twist
    bool material = true;  // there is a frame that `rest` is fixed to; else the wire is straight by nature
    RestBend rest;
};

/// Edge on a side of a node, -1 where the wire ends.
inline int clamp_edge(const RodView& rod, int node, int side)
{
    const int edge = node - 1 + side;
    return edge >= 0 && edge < rod.n - 1 ? edge : -1;
}

/// Angle between the clamp's unturned director and an edge's reference director, in the sense of tip to hub, nearest to `last`.
[[nodiscard]] double clamp_reference(const RodClamp& clamp, int side, const Vec3& tangent, const Vec3& d1, double last);

/// Twist between clamp `k` and its edges. @return false when an edge is folded against the clamp
[[nodiscard]] bool update_clamp(const RodView& rod, const RodTrial& trial, const RodClamp& clamp, int k, RodFrames& frames);

/// Everything about one side that energy and derivatives need; clamp_edge() must not be -1.
[[nodiscard]] ClampSide clamp_side(const RodView& rod, const RodClamp& clamp, const RodFrames& frames, int k, int side);

/// Energy of one side [J].
[[nodiscard]] double clamp_energy(const RodView& rod, const RodClamp& clamp, const ClampSide& side);

/// Adds gradient and Hessian of one side.
void add_clamp(const RodView& rod, const RodClamp& clamp, const ClampSide& side, HessianMode mode, PairTerms& out);

/// What clamps at a node take the place of.
struct ClampedNode {
    bool bend = false, twist = false;
};
inline ClampedNode clamped_at(std::span<const RodClamp> clamps, int node)
{
    ClampedNode result;
    for (const RodClamp& clamp : clamps) {
        if (clamp.node != node) continue;
        result.bend |= clamp.direction;
        result.twist |= clamp.spin;
    }
    return result;
}

}  // namespace seldinger
