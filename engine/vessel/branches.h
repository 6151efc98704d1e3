#pragma once
// Branches of a vessel's axis and their numbers, which scenes, pictures and Python share.

#include "vessel/centreline.h"

#include <vector>

namespace seldinger {

/// Points from the root to a leaf, root first.
[[nodiscard]] std::vector<int> path_from_root(const Centreline& line, int leaf);
/// Children of each point [P].
[[nodiscard]] std::vector<int> child_counts(const Centreline& line);
/// Index in `path` behind its last fork; 0 without any. @param children  child_counts
[[nodiscard]] std::size_t after_last_fork(const std::vector<int>& path, const std::vector<int>& children);
/// Length of `path` up to point `end` of it [m].
[[nodiscard]] double length_to(const Centreline& line, const std::vector<int>& path, std::size_t end);

/// Leaves of the centreline in the order in which their branches leave the path from the root; the trunk's own end last. Branch k
/// of a scene is the k-th, from 1.
[[nodiscard]] std::vector<int> branch_leaves(const Centreline& centreline);

}  // namespace seldinger
