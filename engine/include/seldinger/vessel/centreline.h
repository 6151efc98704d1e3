#pragma once
// The vessel's axis as a tree of points with the lumen's radius.

#include "vessel/wall_mesh.h"

#include <string>
#include <vector>

namespace seldinger {

struct Centreline {
    std::vector<Vec3> points;    // [P] [m]
    std::vector<double> radius;  // [P] largest inscribed sphere [m]
    std::vector<int> parent;     // [P] index of the previous point towards the root; -1 at a root
    std::vector<std::string> names;  // that a file gives its branches; empty: none
    std::vector<int> name_of;        // [P] index of the point's name, -1: none; empty without names
    [[nodiscard]] bool empty() const { return points.empty(); }

    /// Longest root-to-leaf polyline, root first (indices into points).
    [[nodiscard]] std::vector<int> main_path() const;
    /// The same as points [m].
    [[nodiscard]] std::vector<Vec3> main_points() const;
    [[nodiscard]] double total_length() const;
    /// Index of the point nearest to p; O(P) unless `hint` is near.
    [[nodiscard]] int nearest(const Vec3& p, int hint = -1) const;
    /// Arc length of each point from its root [m].
    [[nodiscard]] std::vector<double> lengths() const;
    /// The same tree with its root at another point; points stay where they are in the list.
    void set_root(int point);
};

}  // namespace seldinger
