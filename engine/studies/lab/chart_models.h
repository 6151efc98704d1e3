#pragma once
// The models of a chart: each choice varied alone around the scene's own, the cheap corners where two are varied together, the
// published method, and the baselines.

#include "models/simulation.h"
#include "models/wall_edges.h"

#include <string>
#include <vector>

namespace seldinger {

struct ChartModel {
    Model model;             // named
    std::string family;      // "nodes", "step", "cheap", "adaptive", "detection", ... : one colour or marker each
    bool published = false;  // the published method, as printed or at its best (lab/published.h)
    std::string refused;     // why this build cannot run it here; empty when it can
};

/// In the order in which they are worth running: an interrupted chart has the most telling ones.
/// @param scene  a scene without a vessel has no detection, laws or friction to vary
/// @param walls  of a scene whose wall is elastic: rigid and coarser ones are compared with it
[[nodiscard]] std::vector<ChartModel> chart_models(const Scene& scene, bool quick, const std::vector<Baseline>& baselines,
                                                   const WallEdges& walls = {});

/// The longest step with which an explicit scheme can stay stable [s]: a quarter of 2 / omega of the fastest of axial, torsional
/// and bending waves on edges of this many nodes. A quarter: a fed wire's base edge shrinks to half.
[[nodiscard]] double explicit_step(const WireSpec& wire, int nodes);

}  // namespace seldinger
