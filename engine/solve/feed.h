#pragma once
// Feeding a wire through the hub: the base node stays at the inlet, its tangent clamped there, and the base edge's rest length
// grows (or shrinks) with what the hand advances (design section 1, Feeding).
//
// h is the wire's uniform edge; for adaptive nodes it follows from the longest edge that the shape at the hub allows, 3h/2.
//
// Until half an edge is inside, the wire is a rigid piece gliding through the guide behind `point`: no unknowns, no contact. From
// then on the base edge is kept within [h/2, 3h/2] by splitting and merging between steps. A split leaves the polygon's edges
// with the same strain as before, so the sum of rest lengths grows by O(h^3 curvature^2); this debt is drained from later
// feeding, over about one edge, so that neither force nor fed length jumps.

#include "rod/elastic.h"
#include "solve/newton.h"
#include "solve/solve_spec.h"

namespace seldinger {

struct FeedState {
    double advance = 0, turn = 0;  // at the accepted time [m], [rad]
    double debt = 0;               // rest length inside beyond what was fed [m]
    double edge = 0;               // h, edge length at the hub while nothing asks for less; of the piece in the guide twice [m]
    double speed = 0;              // of the material at the inlet during the last step; not state [m/s]
    double grown = 0;              // rest length of the base edge in the last step; not state [m]
    Vec3 point = Vec3::Zero(), direction = Vec3::UnitX(), director = Vec3::UnitZ();
    std::uint8_t on = 0;      // the wire is fed
    std::uint8_t inside = 0;  // it has left the rigid guide and is being solved
};

/// Puts a fed wire into its guide at advance 0.
void start_feed(FeedState& state, const FeedSpec& spec, const WireSpec& wire, RodArrays& rods, int index);

/// Advances and turns the hub to time t [s] over a step of h [s]: grows the base edge, or moves the rigid piece. Masses follow.
void feed_to(FeedState& state, const FeedSpec& spec, const WireSpec& wire, RodArrays& rods, int index, double t, double h);

/// How far the wire travels forwards (sign +1) or back (-1) between two times, whatever it does in between [m].
[[nodiscard]] double feed_travel(const FeedSpec& spec, double from, double until, int sign);

/// Adds the inlet's clamp to the constraints of a fed wire.
void add_feed_constraints(const FeedState& state, const RodView& rod, WireConstraints& out);

/// Elastic energy of the accepted state [J]. `frames` is scratch.
[[nodiscard]] double energy_now(const RodView& rod, std::span<const RodClamp> clamps, RodFrames& frames);

/// What a split or a merge did.
struct HubChange {
    bool changed = false;
    double energy = 0;  // made by it [J]
};

/// What the base edge may be [m].
struct BaseEdge {
    double shortest = 0, longest = 0;
    double inner = 0;  // what a split leaves tipwards of the new node; 0: it may not be split now

    static BaseEdge uniform(double h) { return {0.5 * h, 1.5 * h, h}; }
};

/// What adapt_hub works with; kept, so that a split allocates nothing.
struct HubScratch {
    RodFrames frames;  // of any capacity: grows
    WireConstraints inlet;
};

/// Splits or merges the base edge where it left its limits.
HubChange adapt_hub(FeedState& state, const WireSpec& wire, RodArrays& rods, int index, const BaseEdge& limits,
                    HubScratch& scratch);

}  // namespace seldinger
