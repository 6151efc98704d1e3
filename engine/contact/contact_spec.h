#pragma once
// How contact is found and what law it follows. Names as in the scene file, [contact].

namespace seldinger {

enum class Detection { Swept, Capsule, Layer, Nodes };
enum class NormalLaw { HuntCrossley, LankaraniNikravesh, Augmented, Constraint, Impulse, Barrier };
enum class FrictionLaw { StickSlip, Smooth, Sign, None };

struct ContactSpec {
    Detection detection = Detection::Swept;
    NormalLaw normal = NormalLaw::HuntCrossley;
    FrictionLaw friction = FrictionLaw::StickSlip;
    bool stiffness_from_wall = true;  // else `stiffness`, `exponent`
    double stiffness = 0;             // [N/m^(n+1)]: force per metre of wire = stiffness |gap|^n
    double exponent = 1.5;            // n [-]
    double restitution = 0.5;         // (0, 1]
    double mu_static = 0.12, mu_sliding = 0.10;
    bool rolling = false;
    double rolling_alpha = 0.2;       // hysteresis loss [-] (D10)
    double rolling_sigma_b = 0, rolling_sigma_s = 0, rolling_hardness = 1e6;  // [Pa] (D10)
    double layer_height = 0;          // h of the published layer [m]; 0: chosen, see contact/layer.h
    double pair_distance = 0;         // H of the published pair test [m]; 0: chosen
    int samples_per_edge = 0;         // 0: spacing of one wire radius
};

}  // namespace seldinger
