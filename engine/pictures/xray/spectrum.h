#pragma once
// Spectrum of an X-ray tube, as a few energies with weights.
//
// Bremsstrahlung of a thick target after Kramers [Kramers 1923, doi:10.1080/14786442308565244]: photons per energy
// N(E) ~ (E_0 - E)/E, E_0 = e kVp. It is hardened by 8 um of tungsten (the anode itself), 2.5 mm of aluminium (least total
// filtration of IEC 60601-1-3 at 70 kV and above) and 0.1 mm of copper (fluoroscopy). The anode's lines, a few per cent of the
// photons at 75 kV and none below 69.5 kV, are left out. The detector takes in energy: a photon counts E times what 0.6 mm of
// caesium iodide at 75 % packing absorbs of it.

#include <vector>

namespace seldinger {

struct SpectrumLine {
    double energy = 0;   // [keV]
    double photons = 0;  // share of the photons that are detected; they sum to 1
    double signal = 0;   // share of the signal in the open beam, S(E) of (D15); they sum to 1
};

/// @param kvp  tube voltage [kV], 40 to 150. @return bins of about equal signal, none across the K edge of I (33.17), W (69.53)
/// or Pt (78.39 keV); each is represented by its mean energy. @throws Error BadScene: a voltage outside
[[nodiscard]] std::vector<SpectrumLine> tube_spectrum(double kvp, int bins = 10);

/// One energy. @param energy [keV], 5 to 200. @throws Error BadScene
[[nodiscard]] std::vector<SpectrumLine> single_energy(double energy);

}  // namespace seldinger
