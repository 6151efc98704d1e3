#pragma once
// Edges of an elastic wall's control mesh relative to the decay length of a dent.

#include "vessel/centreline.h"
#include "vessel/vessel_spec.h"
#include "vessel/wall_mesh.h"
#include "wall/wall_readings.h"

namespace seldinger {

struct WallModel;

/// Length over which the dent of a ring (tube) or line (plane) load decays [m]: 1/Re m of the root of D m^4 - N m^2 + k = 0 that
/// decays fastest, with k = E t/R^2 + k_s and the tension N = p R that mean pressure gives a tube. Without it 1/beta, beta^4 =
/// k/(4 D); with much of it sqrt(D/N) [Hetenyi46, sec. 30, 51]. Infinite for a plane on nothing. @param lumen_radius  R [m];
/// infinite: a plane
[[nodiscard]] double decay_length(const VesselSpec& spec, double lumen_radius);
/// The same for a wall: the median where instruments are expected to touch (VesselSpec::touched), else that of the typical
/// radius.
[[nodiscard]] double decay_length(const WallModel& wall);

/// How far the control mesh alone may have a reading from its limit, as a share of it.
struct WallMeshBand {
    double move = 0, stress = 0;  // of the largest displacement; of the largest stress [-]
};
/// @param edge  of the control mesh where the reading is [m]   @param decay  decay_length() [m]
[[nodiscard]] WallMeshBand wall_mesh_band(double edge, double decay, bool plane);

/// The edge that leaves this share of the largest displacement [m]: wall_mesh_band(edge, decay, plane).move is `move`.
[[nodiscard]] double edge_of_band(double move, double decay, bool plane);

/// How far linear theory has displacement and stress from those under large displacements, as a share of both. The slope of a
/// dent as deep as w takes w R/lambda^2 of the hoop's strain w/R beside it, and R/lambda^2 is about 2/t: first order in w/t on a
/// tube, second on a plane. The constants are the largest that equilibria of both theories have shown (docs/wall.md).
/// @param move  w, the largest displacement [m]
[[nodiscard]] double linear_theory_band(double move, double thickness, bool plane);

/// Under a line load q [N/m] the moment has a peak with a corner, q lambda/4 of a plate on its bed [Hetenyi46]. Elements of edge
/// l cut off about q l/18 of it: that is the rest against the closed form on planes with l of 0.25 to 0.9 lambda, within 3 % of
/// the whole (contact/test_elastic_contact). With it the von Mises stress at the surface is larger by 6/t^2 sqrt(1 - nu + nu^2) q
/// l/18.
///
/// A load F on a length L of less than l has a logarithm in place of the corner: elements see it as spread over a disc of 0.48 l,
/// and what they cut off is 6/t^2 F (1 + nu)/(4 pi) (1/2 + ln(0.96 l/L)). With q = F/L, L from l/5 to l, both agree within 30 %.
/// Near a point load a thin plate has no largest stress. A thick one has that of a load on a disc of 0.325 t [Westergaard 1926;
/// Roark, table 11.2], or on a line of 1.07 t: its moment F (1 + nu)/(4 pi) (c - ln(L/2)) is that of a disc of radius L/(2
/// sqrt(e)). So L is never below t.
struct LostPeak {
    double stress = 0, band = 0;  // [Pa]; ± of the sum: 3/4 of it, of edges beyond the decay length more
};
[[nodiscard]] LostPeak lost_peak(double load, double edge, double decay, double thickness, double poisson);

}  // namespace seldinger
