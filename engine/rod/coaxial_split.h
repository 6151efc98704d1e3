#pragma once
// Adds and removes nodes at the hub while instruments on one centreline are fed, as for a wire (rod/split.h): forces do not jump.
//
// A new node is put where its bending forces balance, both new edges carry the old one's axial force, and each instrument keeps
// its twist per length at both neighbours. It moves so that no edge is stretched.

#include "rod/coaxial.h"
#include "rod/split.h"

namespace seldinger {

/// @param wires  of `rods`: the line, then its passengers (solve/coaxial_group.h); all have as many nodes at the same places
/// @param fraction  of the base edge that stays tipwards of the new node
SplitResult split_coaxial_base(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base,
                               double fraction);
/// Takes out the node next to the hub.
SplitResult merge_coaxial_base(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod, const CoaxialBase& base);

/// Splits the first edge in two halves: one that has grown at the tip, where another instrument has got ahead time after time. It
/// stays straight.
void split_coaxial_tip(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod);

/// prepare_coaxial(), and what of it passengers keep.
void prepare_group(RodArrays& rods, std::span<const int> wires, CoaxialRod& rod);
/// The line's places and frames into the passengers' arrays.
void follow_line(RodArrays& rods, std::span<const int> wires);

}  // namespace seldinger
