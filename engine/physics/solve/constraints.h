#pragma once
// Holds, loads and links of one wire, from the scene (solve_spec.h) to nodes and edges at a given time.
//
// What a hold keeps (position, tangent, director) is taken once, from the wire as it is placed at t = 0. Afterwards points
// are found by their material distance from the tip, never by node index, so that nodes may come and go.

#include "solve/solve_spec.h"
#include "solve/wire_constraints.h"

#include <span>
#include <vector>

namespace seldinger {

class WireHolds {
public:
    /// Checks the specs against the wire as placed and keeps what the holds hold. Throws Error (BadScene) for a point that
    /// is not on the wire, a hold that holds nothing, and two holds that hold the same thing at the same node.
    /// @param rod          placed, frames set
    /// @param wire_length  the whole wire's [m]; a fed wire has less of it inside
    WireHolds(std::span<const HoldSpec> holds, std::span<const LoadSpec> loads, std::span<const LinkSpec> links,
              const RodView& rod, double wire_length);

    /// Overwrites `out` with the constraints at time t [s] (infinity: ramps and moves are over). No allocation once `out`
    /// has been filled before. A load or link on a part of the wire that is not inside yet is left out.
    void fill(double t, const RodView& rod, WireConstraints& out) const;
    /// A point of the wire's material on the nodes that it has now.
    struct Place {
        int edge;
        double bary;
        bool inside;
    };
    /// @param offset  of an instrument's material along the line that it is in (rod/coaxial.h), 0 for a wire alone [m]
    [[nodiscard]] static Place locate(const WirePoint& at, const RodView& rod, double offset);
    /// Adds a load at time t. @param member  as of add_loads
    static void add_load(const LoadSpec& load, double t, const RodView& line, double offset, int member, WireConstraints& out);
    /// Loads and links alone, of an instrument that shares its centreline with others: added to the line's constraints.
    /// @param offset  of its material along the line (rod/coaxial.h) [m]     @param member  its place among them
    void add_loads(double t, const RodView& line, double offset, int member, WireConstraints& out) const;

    /// Holds of an instrument that shares its centreline with others: places of its material, wherever nodes are.
    /// @param own  the line as placed, with this instrument's angles     @param offset  of its material along the line [m]
    /// @throws Error (BadScene) as the constructor does
    void take_line_holds(std::span<const HoldSpec> holds, const RodView& own, double offset);
    /// These at time t; of a place that is not inside nothing.
    void add_line_holds(double t, const RodView& line, double offset, WireConstraints& out) const;

    /// Material distances [m] from the tip at which a node must stay (holds between the ends): not to be merged away.
    [[nodiscard]] std::span<const double> held_distances() const { return held_distances_; }
    /// Time at which the last move, turn or ramp comes to its end [s]; 0 without any.
    [[nodiscard]] double moving_until() const;
    /// Times [s] through which an equilibrium follows holds and links to the ends of their moves, turns and ramps; the last is
    /// infinity. Where something moves, the first is 0: work is counted from an equilibrium on.
    /// Between two of them no hold or link moves by more than 0.5 % of `length` [m] or turns by more than 45 degrees.
    [[nodiscard]] std::vector<double> path(double length) const;
    /// Distance between where hold k was asked for and the node that took it [m].
    [[nodiscard]] double offset(int hold) const { return holds_[hold].offset; }
    /// Node that hold k acts on.
    [[nodiscard]] int node(int hold, const RodView& rod) const;

private:
    struct Hold {
        HoldSpec spec;
        double material_s = 0,
               offset = 0;  // of the node [m]; base and tip follow the wire's ends instead; in a line: asked for, 0
        Vec3 position = Vec3::Zero();       // as placed [m]
        Vec3 tangent = Vec3::UnitX(), director = Vec3::UnitZ();
    };

    [[nodiscard]] static int nearest_node(const WirePoint& at, double material_s, const RodView& rod);
    void refuse_contradictions(const RodView& rod) const;

    std::vector<Hold> holds_;
    std::vector<LoadSpec> loads_;
    std::vector<LinkSpec> links_;
    std::vector<double> held_distances_;
};

/// Tangent (tip -> hub) and first material director of the wire at a node, second order in the edge length also at the ends.
struct NodeFrame {
    Vec3 tangent, director;
};
[[nodiscard]] NodeFrame node_frame(const RodView& rod, int node);

}  // namespace seldinger
