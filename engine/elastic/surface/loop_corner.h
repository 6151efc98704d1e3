#pragma once
// Triangles with one irregular corner: subdivided until a point lies in a regular part, by powers of one small matrix [Stam98,
// "Evaluation of Loop subdivision surfaces"]. The matrices depend on the corner's kind alone, not on the mesh.

#include "surface/loop_topology.h"

#include <array>
#include <vector>

namespace seldinger {

/// Corner of the triangle between neighbours `place` and `place` + 1 of a vertex.
struct LoopCorner {
    static constexpr int depth = 16;  // what is left, 2^-16 of a triangle, is taken for flat
    LoopVertex kind;
    int triangles, place;
    int points;  // K, of LoopTopology::corner_patch
    /// [depth][3][12][K]: the regular patch of child 1, 2, 3 after m rounds, from the points.
    std::vector<double> patches;
    std::vector<double> last;  // [3][K] limits of the three corners after `depth` rounds

    [[nodiscard]] const double* patch(int round, int child) const
    {
        return patches.data() + static_cast<std::ptrdiff_t>(((round * 3 + child - 1) * 12) * points);
    }
};
[[nodiscard]] LoopCorner make_loop_corner(LoopVertex kind, int triangles, int place);

}  // namespace seldinger
