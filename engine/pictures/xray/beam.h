#pragma once
// A beam of several energies behind matter (D15):  I = I_0 sum_E S(E) exp(-sum_m mu_m(E) L_m), for packed rays.

#include "xray/materials.h"
#include "xray/spectrum.h"

#include <cstdint>
#include <vector>

namespace seldinger {

enum Matter { Soft, Blood, Bone, Iodine, MatterCount };

/// Rays side by side and what each runs through.
struct Rays {
    std::vector<float> amount[MatterCount];  // lengths [m]; of iodine, mass per area [kg/m^2]
    struct Piece {
        std::int32_t ray, material;  // of the instruments
        float length;                // [m]
    };
    std::vector<Piece> pieces;  // of instruments

    [[nodiscard]] int count() const { return static_cast<int>(amount[Soft].size()); }
    /// As many rays, through nothing yet.
    void clear(int count)
    {
        for (auto& a : amount) a.assign(count, 0.0f);
        pieces.clear();
    }
};

class Beam {
public:
    explicit Beam(std::vector<SpectrumLine> lines);
    /// @param of  materials of instruments that pieces number
    void set_instruments(const std::vector<Material>& of);

    /// What arrives of each ray, as in an Exposure. @param signal, second  [rays.count()]
    void arrive(const Rays& rays, float* signal, float* second) const;
    /// -ln(I/I_0) of each ray. @param out  [rays.count()]
    void line_integrals(const Rays& rays, float* out) const;

private:
    /// sum_m mu_m L_m at one energy.
    void exponents(std::size_t line, const Rays& rays, std::vector<float>& out) const;

    std::vector<SpectrumLine> lines_;
    double mean_energy_ = 0;                     // of the photons in the open beam [keV]
    std::vector<std::vector<float>> mu_;         // per line: soft, blood, bone, iodine [1/m], [m^2/kg]
    std::vector<std::vector<float>> mu_pieces_;  // per line: of each material of the instruments [1/m]
};

}  // namespace seldinger
