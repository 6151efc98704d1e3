#pragma once
// The branches of a vessel, one numbering for tasks, tables, Python and pages.
//
// A branch is the part behind the last fork on the path from the root to an end of the centreline. Branches count from 1 in the
// order in which they leave on that path; the end of the trunk (the longest path) counts last. A point belongs to a branch from
// its mouth on, where the branch has left the lumen's ball about its fork; before that it is in the vessel that the branch
// leaves.

#include "vessel/centreline.h"

#include <vector>

namespace seldinger {

class Branches {
public:
    Branches() = default;
    explicit Branches(const Centreline& line);

    [[nodiscard]] int count() const { return static_cast<int>(own_.size()); }
    /// Points of branch `number` (from 1) behind its last fork, from the fork outwards: indices into the centreline. Never empty.
    [[nodiscard]] const std::vector<int>& points(int number) const { return own_[static_cast<std::size_t>(number - 1)]; }
    /// Arc length of a point along the centreline from its root [m].
    [[nodiscard]] double from_root(int point) const { return from_root_[static_cast<std::size_t>(point)]; }
    /// How far a point of branch `number` lies behind its mouth, < 0 before it [m].
    [[nodiscard]] double depth(int number, int point) const { return from_root(point) - mouth_[static_cast<std::size_t>(number - 1)]; }

    struct Place {
        int branch = 0;    // from 1; 0: before any mouth, or no centreline
        double depth = 0;  // of the nearest point of the axis behind the mouth of that branch, along it [m]
    };
    [[nodiscard]] Place locate(const Centreline& line, const Vec3& p) const;

private:
    void find_mouths(const Centreline& line);
    std::vector<std::vector<int>> own_;
    std::vector<double> from_root_;  // [P]
    std::vector<double> mouth_;      // of each branch, from the root [m]
    std::vector<int> branch_of_;     // [P]; 0: before any mouth
};

}  // namespace seldinger
