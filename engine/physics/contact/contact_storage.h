#pragma once
// Upper bound of the energy that contacts can return, from the sums per edge on the host: S in energy_balance.h.
// An upper bound, so that no honest rebound passes for energy made.
//
// Normal, damped laws: f(depth)/depth^n grows with depth (hardening included), so a metre of wire holds at most f depth/(n+1) of
// the static law. The bound takes the whole edge at its deepest quadrature point, with the stiffest section's law and without
// dashpots. While a contact flies apart, f is 0, but its spring may still release energy. The tip's own law comes on top.
// `barrier`: f falls with the gap d, so it holds at most f (d_hat - d). Multipliers: the force over the overlap allowed and
// found. Friction and rolling: springs k_t and k_t r^2 per metre of wire, of a quadrature point's length at least: F^2/(2 k_t w),
// M^2/(2 k_t w r^2).

#include "contact/edge_sums.h"

#include <span>

namespace seldinger {

class ContactStorage {
public:
    /// @param models  quadrature points of one wire, the tip's first
    ContactStorage(std::span<const QuadratureModel> models, uint normal_law);

    /// At the last evaluation [J]. @param begin  first node of the wire in the concatenated arrays
    [[nodiscard]] double most(const EdgeSums& sums, int wire, int begin, const RodView& rod) const;

private:
    [[nodiscard]] double normal(const EdgeForce& sum, double length, bool tip) const;

    QuadratureModel line_{}, tip_{};
    uint law_;
};

}  // namespace seldinger
