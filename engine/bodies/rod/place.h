#pragma once
// Start of a wire that is not fed: its nodes along a given shape.

#include "rod/rod_arrays.h"

#include <span>

namespace seldinger {

/// Node number that a wire of this spec starts with; "adaptive" means uniform edges of 0.4 max_edge (not below min_edge).
[[nodiscard]] int uniform_node_count(const WireSpec& spec);
/// Uniform edge length [m].
[[nodiscard]] double uniform_edge(const WireSpec& spec);

/// Puts n = uniform_node_count nodes along the shape, from base to tip, so that every edge's chord is its rest length. The start
/// then has no stretch (at EA = 1e4 N the chord of a 5 mm edge on a 40 mm arc would start with 6 N). In a `stretched` placement
/// they share the whole length of the points. Sets material_s, velocities,
/// frames with the director `place.normal` at the hub, rest shape and masses.
/// @param path  points of the vessel's axis, from the entry on [m]; needed by the shape "centreline" only. @throws Error BadScene
/// where the shape is too short
void place_wire(RodArrays& rods, int wire, const WireSpec& spec, std::span<const Vec3> path);

/// Puts the nodes of a rod along a polyline that begins at its hub; chords are the lengths of material between them. Beyond its
/// end it continues straight.
void lay_along(const RodView& rod, std::span<const Vec3> path);

/// Least distance between two axes as they lie [m].
[[nodiscard]] double axis_distance(const RodView& a, const RodView& b);

}  // namespace seldinger
