#pragma once
// Rest quantities of single edges and nodes, for feeding and refinement; set_rest_shape (rod/elastic.h) does a whole wire.

#include "rod/rod_arrays.h"

namespace seldinger {

/// Series stiffness of the material in [begin, end]: length / int ds/EA [N].
[[nodiscard]] double edge_stretch_stiffness(const WireSpec& spec, double begin, double end);

/// rest_length, stretch_stiffness, radius, spin_inertia of edge j from material_s.
void set_rest_edge(const RodView& rod, const WireSpec& spec, int j);

/// bend_stiffness, twist_stiffness, mass of node i, and unless `keep_shape` its rest curvature and twist.
void set_rest_node(const RodView& rod, const WireSpec& spec, int i, bool keep_shape);

/// By how much nodes have the displacement over edge j wrong, which have the angles of its halves at its ends: int q s ds over
/// the edge, less its length times int q ds over its half away from the tip. q: natural curvature about the two directors, none
/// with `rest_is_placed`; compliance 1/B. 0 of an edge of one material.
struct EdgeOffset {
    Vec2 natural = Vec2::Zero();  // [m]
    double compliance = 0;        // [1/N]
};
[[nodiscard]] EdgeOffset edge_offset(const RodView& rod, const WireSpec& spec, int j);

}  // namespace seldinger
