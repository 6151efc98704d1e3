#pragma once
// Generated walls: tube, arc and plane.
//
// A tube's facets run along its axis: rings of vertices stand behind each other, unturned, and every quadrilateral is cut into
// two right triangles with equal legs (quality 0.87). Turning every second ring by half a facet would give equilateral triangles,
// but a floor with bumps, each a facet long. They would be R (1 - cos(pi/n)) high, 16 um for 18 mm and 35,000 triangles. That is
// many times the depth to which a wire sinks by its weight. Unturned, the floor of a straight tube is exactly straight.
//
// Vertices lie on the true radius, so facets cut inside by at most R (1 - cos(pi/n)), n the facets around. n is a multiple of
// four with the first vertex towards `normal`. So a wire that gravity or a bend presses along +-normal or +-axis x normal lies in
// a line of vertices, at exactly R.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"

namespace seldinger {

struct GeneratedVessel {
    WallMesh mesh;          // normals into the lumen (plane: along `normal`)
    Centreline centreline;  // exact: a point per ring, radius R; empty for a plane
};

/// Lateral surface of a cylinder from `origin` along `axis`, both ends open. Uses radius, length, axis, normal, triangles.
[[nodiscard]] GeneratedVessel make_tube(const VesselSpec& spec);

/// Tube along lead_in, a circle of bend_radius towards `normal` through `angle`, lead_out; tangents are continuous and a
/// ring stands at each junction. @throws Error BadScene when the tube would cut itself (bend_radius <= radius).
[[nodiscard]] GeneratedVessel make_arc(const VesselSpec& spec);

/// Square of side `size` centred at `origin`, facing `normal`.
[[nodiscard]] GeneratedVessel make_plane(const VesselSpec& spec);

}  // namespace seldinger
