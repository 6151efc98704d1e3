// The default control edge of an elastic wall, and the finest and the coarsest of a study.
#include "models/wall_edges.h"

#include "contact/wall_body.h"
#include "wall/wall_model.h"

#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

// A factor of 60 MB, and half a gigabyte of columns where a wire touches a thousand vertices in one run.
constexpr double most_vertices = 6000;
constexpr double coarsest = 2, coarser = 1.4;  // of the own edge; a third as many vertices take a third of the time

/// Three digits: it goes into scene files.
double rounded(double length)
{
    const double unit = std::pow(10.0, std::floor(std::log10(length)) - 2);
    return std::round(length / unit) * unit;
}

}  // namespace

std::vector<double> WallEdges::trials() const
{
    if (!elastic()) return {};
    return {rounded(coarsest * own), rounded(coarser * own), own};
}

double WallEdges::of_level(int level, double ratio) const { return std::max(least, coarsest * own / std::pow(ratio, level)); }

WallEdges wall_edges(const WorldSetup& setup)
{
    if (!setup.vessel.elastic || setup.mesh.triangles.empty()) return {};
    const DefaultEdge chosen = default_wall_edge(WallModel(setup.vessel, setup.mesh, setup.centreline));
    WallEdges edges;
    edges.own = setup.vessel.wall_edge > 0 ? setup.vessel.wall_edge : chosen.edge;
    // vertices go with 1 / edge^2
    edges.least = std::min(edges.own, chosen.edge * std::sqrt(chosen.vertices / most_vertices));
    return edges;
}

}  // namespace seldinger
