#pragma once
// Adds and removes nodes while material is fed and where the wire is refined. One edge becomes two, or two become one, and axial
// force, moment, torque and momentum of the wire do not jump.
//
// A chord is shorter than its arc: with the axial force kept, the rest lengths after a split sum to
// h (kappa h)^2/32 more than before. That length is reported, a surplus that the caller takes out of later
// advance; taken out at once it would be an axial force jump of EA (kappa h)^2/32, newtons for a steel wire.

#include "rod/elastic.h"

namespace seldinger {

/// What a split or a merge changed besides the node set.
struct SplitResult {
    double rest_length_added = 0;  // [m], of the whole wire; < 0 for a merge. material_s of all nodes hubwards moved by it
    double base_rate = 0;  // base edge of a fed wire: how fast its rest length has to grow for it not to be stretched [m/s]
};

/// Splits edge `edge` (between nodes edge and edge + 1) at `fraction` in (0, 1) of its rest length from its tip side. The new
/// node has index edge + 1. Capacity must allow one node more; views taken before are stale afterwards.
///
/// - position: cubic Hermite curve between the edge's nodes. Tangent at an inner node: that of the parabola through it and its
///   neighbours. At the wire's end: the clamp's if one holds the direction there, else that of natural curvature, which a free end
///   has. Moments at the neighbours then change by O(h^2) only. The chord's middle would raise them by 1/3.
/// - rest lengths: both new edges carry the axial force of the old one.
/// - theta: twist per length is kept at both neighbours, the rest of the twist is at the new node.
/// - velocity, acceleration, spin rates: linear along the wire, but that no edge is stretched by it; linear and spin momentum are
///   kept exactly.
/// - stiffness, mass, rest curvature from the spec at material_s; with `rest_is_placed` rest curvature and twist are shared
///   out by length instead.
/// @param clamps  those of the accepted state, with node indices before the split
SplitResult split_edge(RodArrays& rods, int wire, int edge, double fraction, const WireSpec& spec,
                       std::span<const RodClamp> clamps, bool rest_is_placed = false);

/// Takes out inner node `node`: edges node - 1 and node become one with their mean axial force (by length), the mean of
/// their material angles, and their momentum. No clamp may sit at the node.
SplitResult merge_edges(RodArrays& rods, int wire, int node, const WireSpec& spec, std::span<const RodClamp> clamps,
                        bool rest_is_placed = false);

/// What split_base_edge works with; kept, so that it allocates nothing once it has been provided for the wire.
struct SplitScratch {
    RodFrames frames;
    std::vector<double> gradient;
    std::vector<RodClamp> clamps;
    void provide(int capacity)
    {
        if (frames.capacity >= capacity) return;
        frames = RodFrames(capacity);
        gradient.resize(static_cast<std::size_t>(RodDofs::count(capacity)));
        clamps.reserve(4);
    }
};

/// Feeding: splits the base edge (between nodes n-2 and n-1) of a wire whose hub stands still in a sleeve along the clamp there.
/// The new node is placed where its bending forces balance, between neighbours that stay, and moves so that no edge is stretched:
/// the tipward wire keeps its speed.
SplitResult split_base_edge(RodArrays& rods, int wire, double fraction, const WireSpec& spec, std::span<const RodClamp> clamps,
                            SplitScratch& scratch);
/// Takes out the node next to the hub; the nodes that stay keep their velocities.
SplitResult merge_base_edges(RodArrays& rods, int wire, const WireSpec& spec, std::span<const RodClamp> clamps);

/// Point at parameter u of the cubic that leaves node `edge` and arrives at the next one along the wire's tangents there.
/// @param natural  curvature of the wire at rest at the edge's free end, if it has one, as a vector along the binormal [1/m]
[[nodiscard]] Vec3 split_point(const RodView& rod, int edge, double u, std::span<const RodClamp> clamps, const Vec3& natural);
/// Velocity of the new node a+1: linear along the wire, and what both new edges ask for if they are to be stretched as fast as
/// the old one was [1/s]. A polygon that bends while it slides along itself does not move linearly between two nodes. Axial forces
/// answer the difference v (kappa h)^2/8 with the impedance sqrt(EA rho A): tenths of a millinewton at some centimetres a second.
[[nodiscard]] Vec3 split_velocity(const RodView& rod, int a, double fraction, double strain_rate);

/// By how much the node next to the hub is to move across `tangent`, of the base edge, where `gradient` is what elastic forces
/// ask of it: by the bending stiffness of small turns there.
[[nodiscard]] Vec3 born_node_shift(const RodView& rod, const Vec3& tangent, const Vec3& gradient);

}  // namespace seldinger
