#pragma once
// Inlets of the vessel: its openings, or the ends of a closed one.

#include "vessel/centreline.h"
#include "vessel/inside.h"
#include "vessel/wall_mesh.h"

#include <string>
#include <vector>

namespace seldinger {

struct Inlet {
    Vec3 point = Vec3::Zero();       // inside the lumen [m]; on the opening's plane for an opening
    Vec3 direction = Vec3::UnitX();  // unit, into the vessel, along the lumen
    double radius = 0;               // of the lumen there [m]
    int opening = -1;                // index in RepairReport::loops, -1: a closed end
};

/// Openings, or for a closed vessel the tips of the centreline, widest first. Before them is the one that inlet = "auto" takes:
/// the opening at the centreline's root (the widest, unless the centreline was given), or the closed end at its root. `inlet = n`
/// counts them from
/// 1. A tip's inlet lies one lumen radius in from the end, where the lumen has its width; tips that lead to one place are listed
/// once. Empty without centreline and openings.
[[nodiscard]] std::vector<Inlet> find_inlets(const std::vector<BoundaryLoop>& openings, const Centreline& centreline);

/// Number, from 1, of the inlet through an opening; 0: it is none.
[[nodiscard]] int inlet_through(const std::vector<BoundaryLoop>& openings, const Centreline& centreline, int opening);

/// Its place in metres and millimetres, its radius and its kind, in words.
[[nodiscard]] std::string describe(const Inlet& inlet);

/// The first of them. @throws Error BadFile when the vessel has no inlet
[[nodiscard]] Inlet pick_inlet(const std::vector<BoundaryLoop>& openings, const Centreline& centreline);

}  // namespace seldinger
