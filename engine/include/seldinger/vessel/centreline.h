#pragma once
// The vessel's axis as a tree of points with the lumen's radius.

#include "vessel/wall_mesh.h"

#include <vector>

namespace seldinger {

struct Centreline {
    std::vector<Vec3> points;    // [P] [m]
    std::vector<double> radius;  // [P] largest inscribed sphere [m]
    std::vector<int> parent;     // [P] index of the previous point towards the root; -1 at a root
    [[nodiscard]] bool empty() const { return points.empty(); }

    /// Longest root-to-leaf polyline, root first (indices into points).
    [[nodiscard]] std::vector<int> main_path() const;
    /// The same as points [m].
    [[nodiscard]] std::vector<Vec3> main_points() const;
    [[nodiscard]] double total_length() const;
    /// Index of the point nearest to p; O(P) unless `hint` is near.
    [[nodiscard]] int nearest(const Vec3& p, int hint = -1) const;
};

}  // namespace seldinger
