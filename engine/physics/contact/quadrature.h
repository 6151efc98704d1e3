#pragma once
// Points at which contact is evaluated: quadrature points fixed in the material, whatever the nodes do.
//
// Quadrature point 0 of a wire is its tip (point law). Quadrature point k >= 1 represents the k-th stretch of `spacing` metres
// from the tip and lies at its middle. Detection `nodes` puts the points at the control nodes. Uniform feeding keeps these at
// whole multiples of the edge length. The default spacing is one wire radius. If every quadrature point is farther than r/2 from
// the wall (the hardening law never lets the axis nearer), the straight axis between two of them cannot meet the wall at all.
//
// A quadrature point is a ball, and over a ridge of the wall (an edge that stands out into the lumen) a row of balls is not a
// rod. While one of them crosses the ridge, its force is tilted against the wire by up to half the angle between the facets. The
// integral over the wire has no such axial part, by symmetry, but a quadrature has, once its points are too few on the wire's
// length that the ridge presses. Where the mesh's ridges are sharp, mean_ridge_angle (vessel/ridges.h), the default spacing is
// finer, down to r/4.

#include "contact/contact_setup.h"
#include "rod/rod_arrays.h"
#include "shared/contact_types.h"
#include "wall/wall_model.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace seldinger {

struct WireQuadrature {
    int begin = 0;     // of this wire in the concatenated quadrature point arrays
    int capacity = 0;  // quadrature points of the whole wire
    int live = 0;      // quadrature points inside now: 0 .. live-1
    // of the step being solved; commit raises it. From 2: a record of zeros must not pass for the last step's
    std::uint32_t epoch = 2;
    double spacing = 0;     // [m]
    double placed_to = -1;  // material coordinate of the last node but one when they were placed last [m]
    // For a wire that shares its nodes with others (D12): position of its material in their coordinate, s = own - offset, and the
    // length from its tip that is not inside another one [m].
    double offset = 0, exposed = std::numeric_limits<double>::infinity();
    double placed_offset = 0;  // when they were placed last
    std::vector<double> s;  // [capacity] material coordinate [m]
};

struct QuadratureSet {
    std::vector<WireQuadrature> wires;
    std::vector<QuadratureModel> models;  // [all] constant
    std::vector<QuadraturePlace> places;  // [all] written by place_quadrature
    [[nodiscard]] int total() const { return static_cast<int>(models.size()); }
};

/// Bounds, above which quadrature points (some 400 bytes each) would fill the memory before any computation. One is for a wire's
/// length in smallest radii, several times that of 3 m of 0.1 mm; the other for nodes times samples_per_edge.
inline constexpr double most_slender = 5e5, most_samples = 2e6;

/// Contact coefficients per section come from the wire's sections.
[[nodiscard]] QuadratureSet make_quadrature(const ContactSetup& setup);

/// Puts the quadrature points of a wire on its edges by material coordinate and sets `live`. @param begin  index of the wire's
/// first node in the concatenated arrays. Places at the start of the step are kept in edge_t0, bary_t0 when `start` is set, and
/// those of quadrature points that were not live then are marked SEL_NO_EDGE.
void place_quadrature(QuadratureSet& set, int wire, const RodView& rod, int begin, bool start);

/// The same once the wire has been fed since: only quadrature points beyond the last node but one may have changed, unless that
/// node has moved.
void place_new_quadrature(QuadratureSet& set, int wire, const RodView& rod, int begin);

}  // namespace seldinger
