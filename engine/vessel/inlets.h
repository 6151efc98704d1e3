#pragma once
// Ways into the vessel: its openings, or the ends of a closed one.

#include "vessel/centreline.h"
#include "vessel/inside.h"
#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

struct Inlet {
    Vec3 point = Vec3::Zero();       // inside the lumen [m]; on the opening's plane for an opening
    Vec3 direction = Vec3::UnitX();  // unit, into the vessel, along the lumen
    double radius = 0;               // of the lumen there [m]
    int opening = -1;                // index in RepairReport::loops, -1: a closed end
};

/// Openings, widest first; for a closed vessel the tips of the centreline, its root first. A tip's inlet lies one lumen radius
/// in from the end, where the lumen has its width. Empty without centreline and openings.
[[nodiscard]] std::vector<Inlet> find_inlets(const std::vector<BoundaryLoop>& openings, const Centreline& centreline);

/// inlet = "auto": the opening at the centreline's root, else the widest opening, else the closed end at the root.
/// @throws Error BadFile when the vessel has no way in
[[nodiscard]] Inlet pick_inlet(const std::vector<BoundaryLoop>& openings, const Centreline& centreline);

}  // namespace seldinger
