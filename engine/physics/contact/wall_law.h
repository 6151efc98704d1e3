#pragma once
// The numbers of the contact laws of one section of wire against one wall (D6b, D6c, D7, D10), from the user's settings.

#include "contact/contact_spec.h"
#include "rod/wire_spec.h"
#include "shared/contact_sides.h"
#include "shared/contact_types.h"
#include "vessel/vessel_spec.h"

namespace seldinger {

/// Gravity by which "the wire's own weight" is reckoned in the laws' constants [m/s^2]; not the scene's, which may be zero.
inline constexpr double weight_gravity = 9.81;

/// beta of (D7) that gives back just the restitution e asked for: ln((1+beta)/(1-beta e)) = beta (1+e); 0 for e = 1.
/// [Gonthier04; Carvalho19]. @param e  in (0, 1]
[[nodiscard]] double exact_damping(double e);

/// beta = 3/4 (1 - e^2) [Lankarani90], the published choice: restitution never below 0.663.
[[nodiscard]] double published_damping(double e);

/// Foundation modulus of a thin layer on a stiff bed, k_f = E (1-nu) / ((1+nu) (1-2nu) H)  [N/m^3] (D6)
[[nodiscard]] double foundation_modulus(const VesselSpec& wall);

/// Line law of two bodies that lie along each other: f = (4/3) k_f sqrt(2 r*) depth^1.5 per metre (D6b). Both sides give r* and
/// k_f. For a rigid wire along a lumen 1/r* = 1/r - 1/R.
[[nodiscard]] double line_stiffness(const LawSide& a, const LawSide& b);

/// Point law of a wire's round tip. The bed is that whose line law is `line` depth^n: a bed of pressure p = c depth^(n - 1/2)
/// carries
///   line  c sqrt(2 r*) B(1/2, n + 1/2) depth^n per metre,     tip  2 pi r c depth^(n + 1/2) / (n + 1/2),
/// which for n = 3/2, c = k_f is (D6b) and (D6c). @return stiffness [N/m^(n+1/2)] of the tip's law, exponent n + 1/2
[[nodiscard]] double tip_stiffness(double line, double n, double wire_radius, double lumen_radius);

/// Depth [m] at which k depth^n carries `load`.
[[nodiscard]] double depth_under(double load, double stiffness, double exponent);

/// SEL_NORMAL_* of a law.
[[nodiscard]] uint kernel_law(NormalLaw law);
/// SEL_FRICTION_* of kernels/shared/contact_types.h.
[[nodiscard]] uint kernel_law(FrictionLaw law);

/// Speed at which `smooth` friction has half of its cone [m/s]. Usual in regularised laws.
inline constexpr double smooth_friction_speed = 1e-3;

/// Everything that the kernels need for a quadrature point of `weight` metres on this section; lengths of multiplier laws as
/// `contact` has them (make_quadrature fills in what the user left open).
[[nodiscard]] QuadratureModel line_model(const WireSection& section, const ContactSpec& contact, const VesselSpec& wall,
                                         double lumen_radius, double weight);

/// The tip's own point law f = pi k_f r depth^2 (D6c), added to its share of the line law; with a stiffness given by the user the
/// law of the same bed (tip_stiffness). Without it a tip pushed head on sinks half a radius before anything behind it touches.
[[nodiscard]] QuadratureModel tip_model(const WireSection& section, const ContactSpec& contact, const VesselSpec& wall,
                                        double lumen_radius);

}  // namespace seldinger
