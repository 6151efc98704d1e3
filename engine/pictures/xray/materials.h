#pragma once
// Attenuation of X-rays by matter: mu(E) = rho sum_i w_i (mu/rho)_i(E), of elements by xraylib [Schoonjans11,
// doi:10.1016/j.sab.2011.09.011]. Its total cross-sections are NIST's (XCOM) with every edge in place: never interpolated across
// one.

#include <string>
#include <utility>
#include <vector>

namespace seldinger {

struct Material {
    std::string name;
    double density = 0;                            // [kg/m^3]
    std::vector<std::pair<int, double>> elements;  // atomic number, share of the mass; shares sum to 1
};

/// Attenuation coefficient [1/m], narrow beam, coherent scattering included. @param energy [keV], 1 to 800
[[nodiscard]] double attenuation(const Material& material, double energy);

/// Mass attenuation of an element [m^2/kg].
[[nodiscard]] double mass_attenuation(int atomic_number, double energy);

namespace materials {
// ICRU-44 compositions as in NIST's XAAMDI tables
[[nodiscard]] const Material& water();
[[nodiscard]] const Material& blood();
[[nodiscard]] const Material& soft_tissue();
[[nodiscard]] const Material& cortical_bone();
[[nodiscard]] const Material& stainless_steel();  // Fe 70 Cr 19 Ni 10 Mn 1
[[nodiscard]] const Material& nitinol();          // Ni 55.8 % of the mass
[[nodiscard]] const Material& platinum_alloy();   // Pt 92 W 8, of coils
[[nodiscard]] const Material& polyurethane();
[[nodiscard]] const Material& barium_polymer();    // of catheters: polyurethane with 30 % of its mass BaSO4
[[nodiscard]] const Material& tungsten_polymer();  // of jackets: polyurethane with 50 % of its mass tungsten
}  // namespace materials

/// Material of a section of an instrument, judged by its density, which is kept: from 15000 kg/m^3 on platinum alloy, from 7000
/// stainless steel, from 5500 nitinol. Below that a catheter (with a lumen) is polymer with barium sulphate. A wire is polymer
/// with tungsten around a nitinol core, in the proportions that give the density.
[[nodiscard]] Material instrument_material(double density, bool has_lumen);

/// `first` and `second` by share of the volume of the second.
[[nodiscard]] Material mixed_by_volume(const Material& first, const Material& second, double share, const std::string& name);

}  // namespace seldinger
