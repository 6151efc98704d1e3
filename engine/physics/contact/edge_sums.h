#pragma once
// Result of the device's reduction on the host: force, moment and tangent summed per edge of wire with contact, in the form of
// the solver's banded system. The same for every detection method.

#include "math/band_matrix.h"
#include "rod/rod_arrays.h"
#include "shared/contact_types.h"
#include "solve/force_term.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// Sums over a wire's contacts at the last evaluation.
struct ContactTotals {
    int contacts = 0;
    double depth = 0;    // deepest overlap [m], >= 0
    int deepest = -1;    // tip-side node of the edge where it is; -1: none, or not on the wall
    double outside = 0;  // farthest axis point beyond the wall [m], >= 0
    double normal = 0, friction = 0, sliding = 0, rolling = 0, length = 0;
    ContactWork work;
    ContactTotals& operator+=(const ContactTotals& other);
};

/// SEL_SETTLE_* of the kernels.
[[nodiscard]] inline uint settling_flag(Settling how)
{
    return how == Settling::Stuck ? SEL_SETTLE_STUCK : how == Settling::Sliding ? SEL_SETTLE_SLIDING : 0;
}

struct EdgeSums {
    std::vector<EdgeForce> edges;          // [active edges] read back from the device
    std::vector<std::uint32_t> edge_node;  // [active edges] tip-side node in the concatenated arrays
    std::vector<int> wire_edges;           // [wires + 1] range of each wire in the two above

    /// Admissible, unsymmetric, largest force.
    void answer(int wire, TermAnswer& to) const;
    /// Rounding of forces computed in float, see TermAnswer. A gap is made of vectors as long as the edge and the wire's
    /// radius, each rounded to 2^-24. It moves the force by the contact's stiffness times that.
    [[nodiscard]] double rounding(int wire, int begin, const RodView& rod) const;
    /// @param begin  first node of the wire in the concatenated arrays; see ForceTerm::add
    void add(int wire, int begin, std::span<double> gradient, BandRows* jacobian, bool symmetric) const;
    /// Replaces each edge's symmetric tangent by its positive part, with angles times the wire's radius as lengths.
    void make_positive(int wire, double radius);
    void add_nodal_forces(int wire, int begin, std::span<Vec3> forces) const;
    /// The forces' work on material that slides by a unit along the edges that it lies on, towards the tip [N].
    [[nodiscard]] double along(int wire, int begin, const RodView& rod) const;
    /// @param radius  of the wire [m]
    [[nodiscard]] ContactTotals totals(int wire, double radius) const;
};

}  // namespace seldinger
