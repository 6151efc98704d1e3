#pragma once
// Holds and loads of a wire during one step, resolved to nodes and times (solve/constraints.h builds it).

#include "rod/elastic.h"

#include <utility>
#include <vector>

namespace seldinger {

struct WireConstraints {
    std::vector<std::pair<int, double>> prescribed;  // unknown of the wire (RodDofs), its value at the end of the step
    std::vector<RodClamp> clamps;                    // at the end of the step
    struct PointLoad {
        int edge;
        double bary;
        Vec3 force, moment;
        int member = 0;  // of a common centreline: place of the instrument that it acts on, whose spin the moment turns
    };  // position = (1-bary) x_edge + bary x_{edge+1}
    std::vector<PointLoad> loads;
    std::vector<PointLoad> carried;  // forces that steps before have left (Solver::force_left): no scale of the wire's own loads
    struct Spring {
        int edge;
        double bary;
        Vec3 anchor;
        double stiffness;
        int member = 0;  // likewise
        [[nodiscard]] Vec3 pull(const RodView& rod) const
        {
            return stiffness * (anchor - (1 - bary) * rod.pos(edge) - bary * rod.pos(edge + 1));
        }
    };
    std::vector<Spring> springs;
    /// Hold of an instrument that shares its centreline with others, at a point of its material (solve/line_holds.h).
    struct LineHold {
        int hold;  // which of the instrument's holds
        double s;  // coordinate of the centreline [m]
        bool position, direction, spin;
        Vec3 at;                 // where the place is held [m]
        Vec3 tangent, director;  // tip -> hub; the latter before it is turned
        double turned;           // about the tangent [rad]
    };
    std::vector<LineHold> line_holds;
    Vec3 hub_flow = Vec3::Zero();  // of material through the last node of a fed wire, which itself stands still [m/s]
    double base_grown = 0;         // rest length that the base edge of a fed wire has gained over the step [m]

    /// Nothing holds and nothing acts; memory is kept.
    void clear()
    {
        prescribed.clear();
        clamps.clear();
        loads.clear();
        carried.clear();
        springs.clear();
        line_holds.clear();
        hub_flow.setZero();
    }
};

}  // namespace seldinger
