#pragma once
// Feeding a wire through the hub: the base node stays at the inlet, its tangent clamped there, and the base edge's rest length
// grows (or shrinks) with what the hand advances.
//
// h is the wire's uniform edge; for adaptive nodes it follows from the longest edge that the shape at the hub allows, 3h/2. Where
// stiffness or natural curvature jumps there is a node: a cell that has both sides of a jump keeps a preformed part in the clamp
// until half an edge more is inside. The hand then gives B k^2/2 a length for that, with k the natural curvature, and what a
// spring takes instead is lost. Both hang on h in first order.
//
// Until half an edge is inside, the wire is a rigid piece gliding through the introducer behind `point`: no unknowns, no contact.
// From then on a node is born at the inlet whenever an edge is inside, and taken out where it is pulled back to there. There, and
// only there, a change of the node set changes nothing. A base edge of length l -> 0 lies along the sleeve. With it the clamp's
// half cell l/2 and the node's cell (l + h)/2 are the half cell h/2 that clamped the edge of length h before. Shape, forces,
// energy and contacts of every sample are the same up to terms of order l/h of a polygon's own error (kappa h)^2. Here l is
// base_born of an edge or the feed of a step, whichever is more.
//
// The speed of the tipward wire does jump there. Rest length fed into the base edge pushes along it, at an angle phi = kappa h/2
// to the sleeve, and after the birth along the sleeve. So the same feed moves the wire slower by v phi^2/2.
// Against the wave impedance sqrt(EA rho A), 35 N s/m for a steel wire of 2 mm, that is a jolt of tenths of a millinewton. The
// base edge therefore continues at the rate that keeps the wire's speed. Two quantities fade: the excess of that rate over the
// feed, and the surplus s of rest length that it has brought in. s'' + 2 w s' + w^2 s = 0, w = 1/surplus_time + v/h. So neither
// force nor speed nor the length fed jumps. From rest to rest (static steps) there is no speed and no time: the next step takes
// the surplus back at once.

#include "nodes/split.h"
#include "rod/elastic.h"
#include "solve/solve_spec.h"
#include "solve/wire_constraints.h"

namespace seldinger {

struct FeedState {
    double advance = 0, turn = 0;  // at the accepted time [m], [rad]
    double surplus = 0;            // rest length inside beyond what was fed [m], and how fast it changes [m/s]
    double surplus_rate = 0;
    double edge = 0;   // h, edge length at the hub while nothing asks for less; of the piece in the introducer twice [m]
    double speed = 0;  // of the material at the inlet during the last step; not state [m/s]
    double grown = 0;  // rest length of the base edge in the last step; not state [m]
    Vec3 point = Vec3::Zero(), direction = Vec3::UnitX(), director = Vec3::UnitZ();
    std::uint8_t on = 0;      // the wire is fed
    std::uint8_t inside = 0;  // it has left the introducer and is being solved
};

/// Puts a fed wire into its introducer, with as much of it inside as the inlet says.
void start_feed(FeedState& state, const FeedSpec& spec, const WireSpec& wire, RodArrays& rods, int index);

/// The path of a hub in a control: piecewise linear in time between keys whose times increase strictly, and constant outside of
/// them.
class HubPath {
public:
    /// @param keys  outlive the path, at least one
    explicit HubPath(std::span<const FeedKey> keys) : keys_(keys) {}
    /// Where the hub is at time t.
    [[nodiscard]] FeedKey at(double t) const;
    /// How far the wire travels forwards (sign +1) or back (-1) between two times, whatever it does in between [m].
    [[nodiscard]] double travel(double from, double until, int sign) const;

private:
    std::span<const FeedKey> keys_;
};

/// Advances and turns the hub to `end` over a step of h [s], infinite where that is from rest to rest: grows the base edge, or
/// moves the rigid piece. Masses follow.
void feed_to(FeedState& state, const FeedKey& end, const WireSpec& wire, RodArrays& rods, int index, double h);

/// Adds the inlet's clamp to the constraints of a fed wire.
void add_feed_constraints(const FeedState& state, const RodView& rod, WireConstraints& out);

/// Elastic energy of the accepted state [J]. `frames` is scratch.
[[nodiscard]] double energy_now(const RodView& rod, std::span<const RodClamp> clamps, RodFrames& frames);

/// When the base edge changes [m].
struct BaseEdge {
    double whole = 0;  // what a split leaves tipwards of the new node
    double born = 0;   // and hubwards of it, at least: it is split when both are there
    double least = 0;  // shorter, it is merged
};

/// Length that the edge from s tipwards of the hub gets, h or near it, so that a node comes to the next end of a section: 0.5 to
/// 1.5 h [m].
[[nodiscard]] double even_edge(const WireSpec& wire, double s, double h);

/// Limits for a base edge that is to become `whole`. @param pushed, pulled  how far the wire goes in the next step [m]
[[nodiscard]] BaseEdge base_edge_limits(double whole, double pushed, double pulled);

/// Lets the surplus fade over h [s], without a jump of force or speed. @return rest length to add [m]
[[nodiscard]] double fade_surplus(FeedState& state, double h);

/// What a base edge that has left its limits asks for.
enum class BaseChange { None, Split, Merge };
[[nodiscard]] BaseChange base_change(const RodView& rod, const BaseEdge& limits, int capacity);
/// Carries it out. What rest length a rod gains by it goes into the feed's surplus.
void change_base(FeedState& state, const RodNodes& rod, BaseChange change, const BaseEdge& limits, SplitScratch& scratch);

}  // namespace seldinger
