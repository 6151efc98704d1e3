#pragma once
// Detection and laws of contact. Names as in the scene file, [contact].

namespace seldinger {

enum class Detection { Swept, Layer, Nodes };
enum class NormalLaw { HuntCrossley, LankaraniNikravesh, Augmented, Constraint, Impulse, Barrier };
/// Laws of kernels/shared/multiplier_law.h: they need material quadrature points and Newton's method.
[[nodiscard]] constexpr bool is_nonpenetrating(NormalLaw law) { return law >= NormalLaw::Augmented; }

/// Numbers of the laws in kernels/shared/multiplier_law.h where the user gives none, as fractions of the wire's radius.
inline constexpr double augmented_overlap = 1e-2, constraint_overlap = 1e-5, barrier_distance = 2e-2;
/// Barriers act from no farther than this, a fraction of the radius: contact is looked for just there.
inline constexpr double contact_reach = 0.1;

/// Arithmetic of the contact kernels. The rest (elastic forces, solve) is always double.
enum class Precision { Float64, Float32 };

enum class FrictionLaw { StickSlip, Smooth, Sign, None };

struct ContactSpec {
    Detection detection = Detection::Swept;
    NormalLaw normal = NormalLaw::HuntCrossley;
    FrictionLaw friction = FrictionLaw::StickSlip;
    bool stiffness_from_wall = true;  // else `stiffness`, `exponent`
    double stiffness = 0;             // [N/m^(n+1)]: force per metre of wire = stiffness |gap|^n
    double exponent = 1.5;            // n [-]
    double restitution = 0.5;         // (0, 1]
    double overlap = 0;               // that `augmented` and `constraint` allow [m]; 0: chosen, see contact/wall_law.h
    double barrier_distance = 0;      // gap from which `barrier` acts [m]; 0: chosen
    bool rolling = false;
    double rolling_alpha = 0.2;                                               // hysteresis loss [-] (D10)
    double rolling_sigma_b = 0, rolling_sigma_s = 0, rolling_hardness = 1e6;  // [Pa] (D10)
    double layer_height = 0;   // h of the published layer [m]; 0: chosen, see contact/layer.h
    double pair_distance = 0;  // H of the published pair test [m]; 0: chosen
    int samples_per_edge = 0;  // 0: spacing of one wire radius, less over sharp ridges (contact/quadrature.h)
    Precision precision = Precision::Float64;
};

}  // namespace seldinger
