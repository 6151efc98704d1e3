#pragma once
// Control edges of an elastic wall in a study, and the finest one of its reference (docs/wall.md).

#include "engine.h"

#include <vector>

namespace seldinger {

struct WallEdges {
    double own = 0;    // what `run` takes: the scene's, or the one that is chosen where it gives none [m]; 0: the wall is rigid
    double least = 0;  // the finest that is run: some 6,000 vertices, or `own` where that is finer [m]

    [[nodiscard]] bool elastic() const { return own > 0; }
    /// Edges worth trying, longest first: multiples of `own`, down to it.
    [[nodiscard]] std::vector<double> trials() const;
    /// Edge of level k of a reference, twice `own` at first and refined by `ratio`, down to `least`.
    [[nodiscard]] double of_level(int level, double ratio) const;
};

/// @param setup  with its vessel's mesh. A wall that is rigid has no edges
[[nodiscard]] WallEdges wall_edges(const WorldSetup& setup);

}  // namespace seldinger
