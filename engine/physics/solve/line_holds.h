#pragma once
// Holds of instruments that share a centreline: points of their material, which slide along the line as each is fed; a force term
// on the host.
//
// A place s of the line (rod/coaxial.h) lies on an edge and in a cell, between the middles of edges a (tipwards) and b, at the
// fraction w of the cell's length l. In the half cell at the tip there is b alone, in the hub's b is the sleeve. The shape is
// interpolated:
// x(s) on its edge, t = (1 - w) t_a + w t_b and psi = (1 - w) psi_a + w psi_b, with psi_j the angle of instrument k's director on
// edge j from its hold:
//
//     position     x(s) = p(t)                                       exactly: multipliers
//     direction    U = |t_c - t|^2 / (2 c),   c = w (1 - w) l/B      [J], c in 1/(N m)
//     spin         U = psi^2 / (2 c),         c = w (1 - w) l/C_k
//
// The last two are a clamp as a single wire has it (rod/clamp.h): half springs B/(w l) and B/((1 - w) l) from the clamp to the
// middles of both edges in place of the cell's own B/l are this one and the cell's, for
//     (u_a^2/w + u_b^2/(1 - w)) B/(2 l) = (u_a + u_b)^2 B/(2 l) + ((1 - w) u_a - w u_b)^2 / (2 c),
// u_a the turn from edge a to the clamp, u_b that from the clamp to edge b. In an edge's middle the spring is rigid; c is no less
// than a share of l/B, which puts the clamp off by that share of an edge. In the half cell at the tip c = (distance to the
// middle)/B. Where the cell is not even, as at the tip of a catheter over a soft wire, direction counts what bends instead of
// lengths: with a and b the compliances from the place to both middles the half springs are 1/a and 1/b, the cell's own 1/(a +
// b), so w = a/(a + b) and c = a b/(a + b). Left out: what bends by nature within the half cell at the tip, a change of twist
// stiffness within a cell, and that other instruments' ends within a cell slide.
//
// **Position**: x(s) is on the edge that the material goes on with (coaxial_edge_of). F = lambda + K (p - x). K is ten times an
// edge's own stiffness EA/l, so that Newton's method sees next to nothing else of the place. Each time it has converged, lambda
// takes in the remaining force (refine()), until x is at p to 1e-7 of an edge. The force is remembered from step to step.
//
// **Sliding**: pushing k by d(o_k) moves the place by -d(o_k) along the line. So the holds pull at it by dU/ds along the line (of
// a position F.(x_j - x_{j+1})/rest length), + towards the tip, which its own hand feels (merged.h). A place that leaves the
// inlet is let go, and held again where it comes back.
//
// Each acts on the arrays of its instrument; forces on a passenger's positions go to the line's (solve/coaxial_problem.h).

#include "solve/coaxial_group.h"
#include "solve/force_term.h"
#include "solve/wire_constraints.h"

#include <vector>

namespace seldinger {

class LineHolds final : public ForceTerm {
public:
    /// @param constraints  [wires] outlives this: line_holds of the present step, filled before prepare()
    LineHolds(RodArrays& rods, const std::vector<WireConstraints>& constraints);
    /// A group that outlives this. @param count  holds of each of its instruments
    void add(const CoaxialGroup& group, std::span<const int> count);

    void prepare(RodArrays& rods, std::span<const std::uint8_t> live) override;
    void evaluate(const TermTrial& trial) override;
    [[nodiscard]] TermAnswer answer(int wire, Ask what) override;
    void add(int wire, std::span<double> residual, BandRows* tangent, bool symmetric) const override;
    bool refine(std::span<const std::uint8_t> solved, std::span<std::uint8_t> again) override;
    void commit(std::span<const std::uint8_t> active) override;
    void walk_state(StateWalk& walk, int wire) override;

    // ---- of the last evaluation ----
    /// On an instrument along the line, + towards the tip [N].
    [[nodiscard]] double along(int wire) const;

private:
    static constexpr int nodes = 3, unknowns = 3 * nodes + 2;  // of a cell: positions, then angles of edges a and b
    using Vector = std::array<double, unknowns>;
    using Matrix = std::array<Vector, unknowns>;

    /// State of a hold.
    struct Memory {
        Vec3 force = Vec3::Zero();  // [N]
        double turned = 0;          // about the tangent, at the end of the last step [rad]
        std::uint8_t held = 1;      // whether its place was inside then
    };
    /// An edge beside the place, or the sleeve.
    struct Side {
        int edge = -1;            // -1: there is none; n - 1: the sleeve
        int first = 0;            // of its two nodes among the cell's
        double weight = 0;        // in what is interpolated
        double near_angle = 0;    // reference angle at the start of the step, which the trials' are nearest to [rad]
    };
    /// A hold in the present step.
    struct Active {
        WireConstraints::LineHold hold;
        int node = 0;             // first of the cell's
        int edge = 0;             // that the place is on
        double bary = 0;
        Side side[2];             // a, b
        double spin_weight[2] = {0, 1};  // of these in psi
        bool ends = false;        // the instrument's own tip is between the middles: of its spin b alone counts
        double length = 0;        // l: between the middles [m]
        double bend_length = 0;   // 1/(dw/ds) of direction [m]
        double bend = 0, bend_rate = 0;    // c of direction [1/(N m)], dc/ds
        double twist = 0, twist_rate = 0;  // likewise of spin
        double stiffness = 0;     // K [N/m]
        Vec3 multiplier = Vec3::Zero(), miss = Vec3::Zero(), force = Vec3::Zero();
        // of the last evaluation
        Vector gradient{};
        Matrix hessian{};
        double along = 0, work = 0;
    };
    struct HeldWire {
        const CoaxialGroup* group = nullptr;  // null: none is held
        int member = 0;
        std::vector<Memory> memory;  // [holds]
        std::vector<Active> active;
    };
    /// State of an edge, or the sleeve, at a trial.
    struct EdgeState {
        Vec3 tangent, d1;
        double inverse = 0;  // of its length; 0: it does not move [1/m]
    };

    [[nodiscard]] Active place(const HeldWire& held, int wire, const WireConstraints::LineHold& hold);
    void set_springs(const HeldWire& held, const RodView& line, Active& active) const;
    static void set_uneven(const CoaxialBend& bend, Active& active);
    void find_angles(const HeldWire& held, int wire, Active& active);
    [[nodiscard]] EdgeState edge_state(const HeldWire& held, const TrialState& trial, int edge);
    void evaluate(const HeldWire& held, int wire, const TrialState& trial, Active& active);
    static void add_position(const RodView& line, const TrialState& trial, int begin, Active& active);
    static void add_direction(const EdgeState* edges, Active& active);
    void add_spin(const EdgeState* edges, const TrialState& trial, int begin, Active& active) const;
    [[nodiscard]] double rounding(int wire) const;
    [[nodiscard]] static int unknown(const Active& active, int local);

    RodArrays& rods_;
    const std::vector<WireConstraints>& constraints_;
    std::vector<HeldWire> wires_;  // [wires]
};

}  // namespace seldinger
