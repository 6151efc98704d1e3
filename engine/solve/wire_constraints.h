#pragma once
// What holds and loads a wire during one step, resolved to nodes and times (solve/constraints.h builds it).

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
    };  // position = (1-bary) x_edge + bary x_{edge+1}
    std::vector<PointLoad> loads;
    struct Spring {
        int edge;
        double bary;
        Vec3 anchor;
        double stiffness;
    };
    std::vector<Spring> springs;
    Vec3 hub_flow = Vec3::Zero();  // of material through the last node of a fed wire, which itself stands still [m/s]
    double base_grown = 0;         // rest length that the base edge of a fed wire has gained over the step [m]
};

}  // namespace seldinger
