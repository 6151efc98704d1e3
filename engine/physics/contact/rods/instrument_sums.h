#pragma once
// Sums of contact between instruments on the host: forces by node, tangent by blocks of three nodes of a and three of b, sums by
// instrument; always in the order of the cells.
//
// Work. A force F on a, -F on b does F . da and -F . db. Half of F . (da - db) is the contact's own work on a: stored, damped or
// lost to friction. The rest, F . (da + db)/2, comes from b, whose share is its negative.

#include "contact/edge_sums.h"
#include "math/banded_solver.h"
#include "shared/instrument_types.h"
#include "solve/force_term.h"

#include <array>
#include <span>
#include <vector>

namespace seldinger {

/// Positions and spin angles of all nodes, at the trial and at the start of the step, in the concatenated layout.
struct InstrumentMoves {
    std::span<const double> position, position_t0;  // [nodes][3] [m]
    std::span<const double> theta, theta_t0;        // [nodes] [rad]
};

/// One system's.
class InstrumentSums {
public:
    /// Unknowns of three nodes of a and three of b, in the order of RodDofs.
    static constexpr int side = 3 * RodDofs::per_node, size = 2 * side;
    using Vector = std::array<double, size>;

    /// @param first_wire  of the world; `wires` of them      @param rods  outlives this
    InstrumentSums(const RodArrays& rods, int first_wire, int wires);

    void clear();
    /// @param force, points  of the slot, [force.count] points: they stay where they are until clear(), for the tangent
    void take(const InstrumentForce& force, const InstrumentPoint* points, int wire_a, int wire_b, const InstrumentMoves& moves);

    [[nodiscard]] bool acts() const { return !taken_.empty(); }
    [[nodiscard]] bool blocked() const { return blocked_; }
    [[nodiscard]] bool sliding() const { return sliding_; }
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const;
    void couple(const SystemUnknowns& system, BandedSolver& tangent, bool symmetric) const;
    void add_nodal_forces(int wire, std::span<Vec3> forces) const;
    [[nodiscard]] const ContactTotals& totals(int wire) const { return of(wire).totals; }
    [[nodiscard]] double largest_force(int wire) const { return of(wire).largest; }
    [[nodiscard]] double stored(int wire) const { return of(wire).stored; }
    [[nodiscard]] double from_other(int wire) const { return of(wire).from_other; }

private:
    struct alignas(32) Block {
        double value[size][size];
        int wire_a, wire_b, node_a, node_b;
    };
    struct OfWire {
        ContactTotals totals;
        double largest = 0, stored = 0, from_other = 0;
    };
    [[nodiscard]] OfWire& of(int wire) { return wires_[static_cast<std::size_t>(wire - first_wire_)]; }
    [[nodiscard]] const OfWire& of(int wire) const { return wires_[static_cast<std::size_t>(wire - first_wire_)]; }
    /// A record that exerts something.
    struct Taken {
        const InstrumentForce* force;
        const InstrumentPoint* points;
        int wire_a, wire_b;
    };
    /// The tangent, put together when it is asked for: the last trial of a step is asked for forces only.
    void assemble(bool symmetric) const;
    Block& block(int wire_a, int wire_b, int node_a, int node_b) const;
    /// Adds a force on six nodes to those of the wires. @return work on a, on b
    std::array<double, 2> exert(const Taken& of, int node_a, int node_b, const Vector& pushed, const InstrumentMoves& moves);
    void sum_up(const InstrumentForce& force, int wire, double own_normal, double own_friction, double from_other);

    const RodArrays& rods_;
    int first_wire_, first_node_;
    std::vector<OfWire> wires_;
    std::vector<std::array<double, RodDofs::per_node>> nodal_;  // of the system's wires, from first_node_ on
    std::vector<Taken> taken_;
    mutable std::vector<Block> blocks_;
    mutable std::size_t used_ = 0;  // of them
    mutable bool assembled_ = false, symmetric_ = false;  // whether they are the tangent; without what sliding does
    bool blocked_ = false, sliding_ = false;
};

}  // namespace seldinger
