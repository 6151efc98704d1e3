#pragma once
// The twelve functions of a regular Loop patch: the quartic box spline of three directions.

#include "surface/loop_topology.h"

#include <array>
#include <vector>

namespace seldinger {

/// Control vertices of a patch: 0, 1, 2 are its corners, 3, 4, 5 lie across edges 01, 12, 20. The outer ones follow
/// counter-clockwise: 6, 7 about corner 0 (6 beside 5, 7 beside 3), 8, 9 about corner 1 (8 beside 3, 9 beside 4), 10, 11 about
/// corner 2 (10 beside 4).
struct LoopBasis {
    double n[12], n_u[12], n_v[12];       // values, derivatives by (u, v): weights of corners 1, 2
    double n_uu[12], n_uv[12], n_vv[12];  // second derivatives, where asked for
};

/// @param u, v  in the triangle: u, v >= 0, u + v <= 1   @param curved  second derivatives as well
void loop_basis(double u, double v, bool curved, LoopBasis& basis);

// Triangles with one irregular corner: subdivided until a point lies in a regular part, by powers of one small matrix [Stam98,
// "Evaluation of Loop subdivision surfaces"]. The matrices depend on the corner's kind alone, not on the mesh.

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
