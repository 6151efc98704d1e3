#pragma once
// Adaptive nodes: finds edges that are too long for the present shape and nodes that are not needed, and changes them.
//
// The error of an edge of length h, as the distance by which it moves the tip (kappa: curvature; B: bending stiffness; D: jump
// of the shear force at its nodes by contact, links and point loads; l: lever, the distance over which an error of angle acts):
//
//     e(h) = h (kappa h)^2/24  +  l a (kappa h)^3  +  l D h^2/(12 B)                                     [m]
//
// first: arc against chord, what a wire that lies along a wall gains in length; second: the discrete curvature
// (phi + a phi^3)/h of (D2) against phi/h, a = 0 for the angle and 1/12 for 2 tan(phi/2) (rod/curvature.h); third: the moment
// taken as linear over an edge (M'' h^3/12 of angle, M'' h = D in a node's cell). A second order method has a density of error
// c(s) h^2. It needs the fewest nodes for a given sum of errors when c h^3 is the same for every edge, so each is allowed
// WireSpec::edge_error. An estimate by M and its differences, not by curvature, does not see a jump of stiffness: there the
// curvature jumps, but a node's compliance is exact wherever the jump lies in its cell (rest_shape.cpp).
//
// No memory: splits and merges follow from the present shape alone. A split needs e > 1 edge_error, a merge needs e of the merged
// edge < (0.65)^3 = 0.27 edge_error. Since e changes by 4 to 8 with a factor of 2 in h, the nodes of a resting wire come to rest
// too.

#include "nodes/split.h"

#include <limits>

namespace seldinger {

/// Two neighbouring edges differ by at most this factor: the forces of (D2, D3) are second order only where lengths vary slowly.
constexpr double edge_ratio_limit = 2.0;

// An error of angle moves the tip by its distance from there; in a vessel the walls take over after the distance between
// two touches, a few lumen radii.
constexpr double longest_lever = 0.03;  // [m]

/// Part of a bending moment that passes the span of a beam over many supports at equal distances: three moments in a row have
/// M_k-1 + 4 M_k + M_k+1 = 0 (Clapeyron), so that each is -(2 - sqrt 3) of the one before.
constexpr double passes_span = 0.2679491924311227;

/// A change of the node set. Lists of changes run from hub to tip, so that none moves the index of a later one.
struct NodeChange {
    bool split = true;
    int at = 0;             // split: the edge; merge: the node that goes
    double fraction = 0.5;  // split: of the edge's rest length from its tip side
};

/// What a wire's nodes are judged by besides its shape.
struct NodeDemands {
    std::span<const double> kept;     // material distances [m]; the nearest node to each stays
    Vec3 hub_tangent = Vec3::Zero();  // direction held at the hub, tip to hub; zero: none, and so no moment there
    bool may_merge = true;
    bool may_refine = true;  // else only what the ratio of neighbours asks for
    // longest edge beside nodes with contact [m]: their contacts bend with them
    std::span<const Vec3> contact = {};  // [n] [N]
    double touching_edge = std::numeric_limits<double>::infinity();
    std::span<const std::uint8_t> bowed = {};  // [n] nodes that stay for what lies under them
    bool fed = false;        // the base edge belongs to feeding (solve/feed.h), which makes it from 0 to h long
    // of instruments that share a centreline (nodes/coaxial_nodes.h); else a wire's own
    std::span<const Vec3> moment = {};     // [n] bending moments M [N m]
    std::span<const double> turning = {};  // [n] error of the tip by twist, of an edge of length h times 12/h^2 [1/m]
};

/// Scratch of one wire; allocated once.
class NodePlanner {
public:
    NodePlanner() = default;
    NodePlanner(const WireSpec& spec, int capacity);

    /// Longest edge [m] that the present shape allows in the place of each edge, in [min_edge, max_edge]. O(n).
    /// @return [n-1]; valid until the next call
    std::span<const double> longest_edges(const RodView& rod, const WireSpec& spec, const NodeDemands& demands);
    /// Length to which a fed wire's base edge grows before a node is born behind it [m]: by the shape there, or up to a section's
    /// boundary in it, which gets that node. Contacts there are left out.
    [[nodiscard]] double base_edge(const RodView& rod, const WireSpec& spec, const NodeDemands& demands);
    /// How far the finite length of all edges has the tip from its position [m]. Needs no adaptive nodes. The root of the sum of
    /// squares of three errors, which have different causes and directions; each is the sum of its magnitudes over the edges, as
    /// if all erred alike:
    ///
    ///     along     h (kappa h)^2/24, and on the inside of a bend twice that: there edges are tangents, not chords
    ///     turned    l (a (kappa h)^3 + D h^2/(12 B)) as in e(h)
    ///               + c |M_j+1 - M_j| h^2/(6 B) + |sum c o|
    ///     twist     turning h^2/12
    ///
    /// In a tip that lies at the sum of h kappa_i s_i, the trapezoid rule errs by h^2/12 times the integral of (kappa s)'' =
    /// kappa'' s + 2 kappa'. Where natural curvature or stiffness jumps within an edge, nodes have its angle by o from its place
    /// (rod/rest_shape.h). These offsets are known with their signs: both ends of a preformed bend leave only what they differ
    /// by.
    ///
    /// An error of angle acts over the lever l. Up to the contact nearest to the tip, at s_1, that is the edge's own distance
    /// from the tip. Beyond, the wire turns over its contacts as a beam over supports: an angle between the first two, at s,
    /// turns the wire at s_1 by (s_2 - s)/(s_2 - s_1) of itself; one in a further span by passes_span of that per span. Besides,
    /// an angle in a span of length S lifts it by up to S/4 of itself. On a wire that turns by an angle P there, that area S^2/8
    /// makes the tip come P S/8 farther. A displacement acts in full (c = 1) up to the contact nearest to the tip. In a span of
    /// length S it is an angle of 1/S.
    [[nodiscard]] double tip_error(const RodView& rod, const WireSpec& spec, const NodeDemands& demands);
    /// How much energy the finite length of edges is wrong by, between the distances `from` and `to` from the tip. With the
    /// moments M at nodes [N m] and the contact forces F [N], the nodes' energy sum l M^2/(2 B) differs from that of a smooth
    /// wire under the same loads by at most
    ///
    ///     sum over edges  h dM min(dM/B, dkappa)/12     work of a moment on a curvature, both linear along an edge, of which nodes see the ends
    ///     sum over nodes  F kappa h^2/8                 the distance of an arc from the chord's middle, or from where its tangents meet, on which the wall works
    ///     |sum over edges (M_j+1 - M_j).o/h|            the displacements o by jumps of natural curvature and stiffness, against the shear there
    ///
    /// The second is a bound over all places of the load: a chord's middle, where its arc is farthest, and a node, where two
    /// tangents of the arc meet, are both kappa h^2/8 from the arc. (Over all places alike the distance is kappa h^2/12 in the
    /// mean.) dM and dkappa are differences between the ends of an edge. dM/B is dkappa where there is no natural curvature. A
    /// preformed bend that a lumen holds straight has the moments of its natural curvature at nodes, and no curvature between
    /// them to err in. The first is exact for loads at nodes: a cantilever of n edges under an end load has 1/(2 n^2) of its
    /// energy too much, which is how much too far its end goes. Loads between nodes have sum M M'' h^3/(12 B) beside it, which
    /// for an even load is the negative of the first, but for the wire's ends (by parts): the first alone bounds both.
    [[nodiscard]] BendingError bending_error(const RodView& rod, const WireSpec& spec, const NodeDemands& demands,
                                             double from = 0, double to = std::numeric_limits<double>::infinity());
    /// At most a few splits (the worst edges, and those that the ratio of neighbours then asks for), or else at most one merge.
    /// @return from hub to tip; valid until the next call
    std::span<const NodeChange> plan(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int capacity);

private:
    void measure(const RodView& rod, const NodeDemands& demands);
    /// e(h) = cubic h^3 + square h^2.
    struct EdgeErrors {
        double cubic, square;  // [1/m^2], [1/m]
    };
    [[nodiscard]] EdgeErrors errors_between(const RodView& rod, int from, int to, double lever) const;
    [[nodiscard]] Vec3 displaced(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int j) const;
    /// Of each edge, the distance over which an error of its angle moves the tip [m], and the part of a displacement in it that
    /// does.
    struct Reach {
        double lever = 0, carried = 1;
    };
    [[nodiscard]] std::vector<Reach> reaches(const RodView& rod, std::span<const Vec3> contact) const;
    [[nodiscard]] double longest_edge(const RodView& rod, const WireSpec& spec, int from, int to) const;
    void note_touching(const RodView& rod, const NodeDemands& demands);
    void plan_splits(const RodView& rod, const WireSpec& spec, const NodeDemands& demands, int capacity);
    void spread_marks(const RodView& rod, const WireSpec& spec, int from);
    void plan_merge(const RodView& rod, const WireSpec& spec, const NodeDemands& demands);
    [[nodiscard]] double boundary_fraction(const WireSpec& spec, double begin, double end) const;

    std::vector<double> boundaries_;              // [m] where sections begin and end
    std::vector<double> longest_;                 // [n-1]
    std::vector<double> curvature_, shear_jump_;  // [n] [1/m], [N]
    std::vector<double> turning_;                 // [n] NodeDemands::turning [1/m]
    std::vector<Vec3> moment_, bend_;             // [n] [N m]; curvature as a vector along the binormal [1/m]
    std::vector<double> touching_;                // [n] longest edge beside it that its contact allows [m]
    std::vector<std::uint8_t> marked_;            // [n-1] to be split; [n] kept
    std::vector<NodeChange> changes_;
};

/// Carries the changes out: momentum, axial force and twist are kept (nodes/split.h).
/// @return rest length added [m]
double apply_changes(const RodNodes& rod, std::span<const NodeChange> changes);

/// Takes `amount` [m] of rest length out of the whole wire, evenly, and refreshes its rest shape.
void shorten_evenly(const RodView& rod, const WireSpec& spec, double amount, bool rest_is_placed);

}  // namespace seldinger
