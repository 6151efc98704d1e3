#pragma once
// Adds and removes nodes while material is fed and where a rod is refined. One edge becomes two, or two become one, and axial
// force, moment, torque and momentum of the rod do not jump. A rod is a wire, or K instruments that share its nodes
// (rod/coaxial.h).
//
// A chord is shorter than its arc: with the axial force kept, the rest lengths after a split sum to
// h (kappa h)^2/32 more than before. That length is reported, a surplus that the caller takes out of later
// advance; taken out at once it would be an axial force jump of EA (kappa h)^2/32, newtons for a steel wire.

#include "rod/coaxial.h"
#include "rod/elastic.h"

namespace seldinger {

/// What a split or a merge changed besides the node set.
struct SplitResult {
    double rest_length_added = 0;  // [m], of the whole rod; < 0 for a merge. material_s of all nodes hubwards moved by it
    double base_rate = 0;  // base edge of a fed rod: how fast its rest length has to grow for it not to be stretched [m/s]
};

/// What elastic forces are computed with; kept, so that it allocates nothing once it has been provided for the rod.
struct SplitScratch {
    RodFrames frames;
    std::vector<double> gradient;
    std::vector<RodClamp> clamps;
    void provide(int capacity)
    {
        if (frames.capacity >= capacity) return;
        frames = RodFrames(capacity);
        gradient.resize(static_cast<std::size_t>(CoaxialDofs{most_coaxial}.count(capacity)));
        clamps.reserve(4);
    }
};

/// The nodes of a rod, to be split and merged: which arrays they fill, and how the material between them is computed. Members
/// that return a RodView are views of the arrays as they are now: a change of the nodes leaves those taken before stale.
class RodNodes {
public:
    /// @param wires  of `rods`: the line, whose arrays hold the rod's places and frames, then those that follow it with their own
    /// angles
    RodNodes(RodArrays& rods, std::span<const int> wires, std::span<const RodClamp> clamps, bool rest_is_placed);
    virtual ~RodNodes() = default;

    [[nodiscard]] RodView line() const { return rods_.view(wires_[0]); }
    [[nodiscard]] int instruments() const { return count_; }
    /// The arrays with the angles of instrument k; 0 is the line.
    [[nodiscard]] RodView instrument(int k) const { return rods_.view(wires_[k]); }
    /// Those of the accepted state, with node indices before a change.
    [[nodiscard]] std::span<const RodClamp> clamps() const { return clamps_; }
    [[nodiscard]] const RodClamp* clamp(int node, bool RodClamp::*what) const;
    /// Rest curvature and twist are those of the shape in which the rod was placed, not those of its spec.
    [[nodiscard]] bool rest_is_placed() const { return rest_is_placed_; }
    [[nodiscard]] int capacity() const { return rods_.capacity(wires_[0]); }
    void insert_node(int index) const;
    void erase_node(int index) const;

    /// Stretch stiffness of the material in [begin, end], as one edge [N].
    [[nodiscard]] virtual double stretch_stiffness(double begin, double end) const = 0;
    /// Rest quantities from node `first` to the hub, after material_s has changed.
    virtual void refresh_rest(int first) const = 0;
    /// Whether instrument k bears twist at a node.
    [[nodiscard]] virtual bool reaches(int k, int node) const = 0;
    /// Angle of a clamp's director, for instrument k [rad].
    [[nodiscard]] virtual double clamp_angle(const RodClamp& clamp, int k) const = 0;
    /// Curvature of the rod at rest at its end, along the binormal (signs of rod/pair.h), if edge j is there; else 0 [1/m].
    [[nodiscard]] virtual Vec3 natural_at_end(int j) const = 0;
    /// While the base edge is being split: gradient of the elastic energy by the place of the new node [N], and the tangent of
    /// the new base edge. @return false where there is no such configuration
    [[nodiscard]] virtual bool pull_at_base(SplitScratch& scratch, Vec3& pull, Vec3& tangent) const = 0;
    /// Places, velocities and frames of the line into the arrays of the other instruments.
    virtual void follow_line() const {}

protected:
    RodArrays& rods_;
    std::array<int, most_coaxial> wires_{};
    int count_;
    std::span<const RodClamp> clamps_;
    bool rest_is_placed_;
};

/// The nodes of one wire.
class WireNodes : public RodNodes {
public:
    WireNodes(RodArrays& rods, int wire, const WireSpec& spec, std::span<const RodClamp> clamps, bool rest_is_placed = false)
        : RodNodes(rods, {&wire, 1}, clamps, rest_is_placed), spec_(spec)
    {
    }
    [[nodiscard]] double stretch_stiffness(double begin, double end) const override;
    void refresh_rest(int first) const override;
    [[nodiscard]] bool reaches(int, int) const override { return true; }
    [[nodiscard]] double clamp_angle(const RodClamp& clamp, int) const override { return clamp.turns; }
    [[nodiscard]] Vec3 natural_at_end(int j) const override;
    [[nodiscard]] bool pull_at_base(SplitScratch& scratch, Vec3& pull, Vec3& tangent) const override;

private:
    const WireSpec& spec_;
};

/// Splits edge `edge` (between nodes edge and edge + 1) at `fraction` in (0, 1) of its rest length from its tip side. The new
/// node has index edge + 1. Capacity must allow one node more; views taken before are stale afterwards.
///
/// - position: cubic Hermite curve between the edge's nodes. Tangent at an inner node: that of the parabola through it and its
///   neighbours. At the rod's end: the clamp's if one holds the direction there, else that of natural curvature, which a free end
///   has. Moments at the neighbours then change by O(h^2) only. The chord's middle would raise them by 1/3.
/// - rest lengths: both new edges carry the axial force of the old one.
/// - theta: each instrument keeps its twist per length at both neighbours, the rest of the twist is at the new node.
/// - velocity, acceleration, spin rates: linear along the rod, but that no edge is stretched by it; linear momentum and each
///   instrument's spin momentum are kept exactly.
/// - stiffness, mass, rest curvature from the specs at material_s; with `rest_is_placed` rest curvature and twist are shared
///   out by length instead.
SplitResult split_edge(const RodNodes& rod, int edge, double fraction);

/// Takes out inner node `node`: edges node - 1 and node become one with their mean axial force (by length), the mean of
/// their material angles, and their momentum. No clamp may sit at the node.
SplitResult merge_edges(const RodNodes& rod, int node);

/// Feeding: splits the base edge (between nodes n-2 and n-1) of a rod whose hub stands still in a sleeve along the clamp there.
/// The new node is placed where its bending forces balance, between neighbours that stay, and moves so that no edge is stretched:
/// the tipward rod keeps its speed.
SplitResult split_base_edge(const RodNodes& rod, double fraction, SplitScratch& scratch);
/// Takes out the node next to the hub; the nodes that stay keep their velocities.
SplitResult merge_base_edges(const RodNodes& rod);

/// Point at parameter u of the cubic that leaves node `edge` and arrives at the next one along the rod's tangents there.
/// @param natural  curvature of the rod at rest at the edge's free end, if it has one, as a vector along the binormal [1/m]
[[nodiscard]] Vec3 split_point(const RodView& rod, int edge, double u, std::span<const RodClamp> clamps, const Vec3& natural);

}  // namespace seldinger
