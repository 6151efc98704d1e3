#pragma once
// Variables of the energy of a cell of a common centreline, and its derivatives: for rod/coaxial*.cpp alone.

#include "rod/coaxial.h"
#include "rod/pair.h"

namespace seldinger::coaxial {

using Complex = CoaxialCell::Complex;

/// What a stencil's energy depends on.
struct Stencil {
    Pair pair;
    Vec3 n1 = Vec3::Zero();  // first director of the midway reference frame, at te
    Complex kappa;           // in it
    bool end = false;        // the tip's half cell: it has the curvature it likes, and only turning the instruments costs
    std::array<double, most_coaxial> phi{}, twist{};
    std::array<Complex, most_coaxial> phase{};
};

/// Gradient and Hessian of a stencil. Terms shared by the instruments are in `common`; of `own` only those with an angle count.
struct StencilTerms {
    PairTerms common;
    std::array<PairTerms, most_coaxial> own;
    double cross[most_coaxial][most_coaxial] = {};  // each second derivative by an angle of k and one of l
};

/// Stencil of node i: inner, the hub with the clamp as hub-side partner, or the tip.
[[nodiscard]] Stencil stencil_at(const CoaxialShape& shape, int i);
/// [J]
[[nodiscard]] double cell_energy(const CoaxialCell& cell, const Stencil& s, int instruments);
/// d(energy of the cell) when its integrals change by `rate` [J].
[[nodiscard]] double cell_energy_rate(const CoaxialCell& cell, const CoaxialCell& rate, const Stencil& s, int instruments);
void add_cell(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out);
/// The tip's half cell.
void add_end(const CoaxialCell& cell, const Stencil& s, int instruments, HessianMode mode, StencilTerms& out);

}  // namespace seldinger::coaxial
