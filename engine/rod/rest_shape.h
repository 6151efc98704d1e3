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

}  // namespace seldinger
