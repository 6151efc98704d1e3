#pragma once
// Contact area and pressure of a wire at a contact point.
//
// A wire of radius r that overlaps a flat wall by delta meets it in the chord
//
//     b = 2 sqrt(delta (2 r - delta))     [m],   delta at most r
//
// across, so that a sample that represents the length l of wire and bears the normal force F lies on the area b l [m^2] with the
// mean pressure F / (b l) [Pa]. In the middle of the chord the pressure of the wall's own bed (D6b) is 1.5 times as large: k_f
// delta against 2/3 k_f delta. The wire's round tip meets it in a disc of diameter b: area pi b^2 / 4, pressure of the bed's
// middle twice the mean.
//
// delta is the overlap of the accepted state where the law sinks in (hunt-crossley, lankarani-nikravesh). Laws without overlap
// (augmented, constraint, impulse, barrier) give no delta. It is then the depth at which the wall's own bed would carry the
// force, without hardening, as in rolling resistance (D10). Area and pressure are those of the same wire on that bed.
//
// Where it ends. The wall is taken as flat across the wire. In a lumen of radius R the bed's chord is longer by 1/sqrt(1 - r/R):
// 2 % for a 0.035 inch wire in an aorta, 10 % for r/R = 1/6. A wire as thick as its lumen has no limit. The wall's surface beside
// the wire stays in place (a bed, not a half space), as in the law itself. A wall that deforms as a shell does so in series, with
// delta its local overlap. Two instruments: the common chord of their circles times the touching length. If two cross,
// contact is a lens: area is up to 4/pi too large, and mean pressure as much too small. A delta under half a micrometre is below
// a surface's roughness.

#include "math/vec3.h"
#include "shared/contact_types.h"

namespace seldinger {

struct ContactPatch {
    double area = 0;      // [m^2]
    double pressure = 0;  // mean [Pa]
};

/// Width of the chord [m]; 0 for a gap. @param depth  overlap [m]  @param radius  of the wire [m]
[[nodiscard]] double overlap_width(double depth, double radius);

/// The same of two round bodies that overlap side by side: the common chord of their circles.
/// @param radius_a, radius_b  [m]  @param inside  a lies in b's lumen, of radius_b
[[nodiscard]] double overlap_width(double depth, double radius_a, double radius_b, bool inside);

/// Contact patch of one contact point. @param model  of its quadrature point; `length` 0: the tip's point law
/// @param normal_law  SEL_NORMAL_*  @param gap  [m]  @param force  normal [N]; 0: nothing
[[nodiscard]] ContactPatch contact_patch(const QuadratureModel& model, uint normal_law, double gap, double force);

}  // namespace seldinger
