// Paths from the root, sorted by where they leave.
#include "vessel/branches.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace seldinger {

std::vector<int> path_from_root(const Centreline& line, int leaf)
{
    std::vector<int> path;
    for (int at = leaf; at >= 0; at = line.parent[static_cast<std::size_t>(at)]) path.push_back(at);
    std::reverse(path.begin(), path.end());
    return path;
}

std::vector<int> child_counts(const Centreline& line)
{
    std::vector<int> children(line.points.size());
    for (const int parent : line.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    return children;
}

std::size_t after_last_fork(const std::vector<int>& path, const std::vector<int>& children)
{
    for (std::size_t k = path.size() - 1; k-- > 0;)
        if (children[static_cast<std::size_t>(path[k])] > 1) return k + 1;
    return 0;
}

double length_to(const Centreline& line, const std::vector<int>& path, std::size_t end)
{
    double length = 0;
    for (std::size_t k = 1; k <= end && k < path.size(); ++k)
        length += (line.points[static_cast<std::size_t>(path[k])] - line.points[static_cast<std::size_t>(path[k - 1])]).norm();
    return length;
}

std::vector<int> branch_leaves(const Centreline& line)
{
    const std::vector<int> children = child_counts(line), trunk = line.empty() ? std::vector<int>{} : line.main_path();
    std::vector<std::pair<double, int>> found;
    for (int leaf = 0; leaf < static_cast<int>(line.points.size()); ++leaf) {
        if (children[static_cast<std::size_t>(leaf)] > 0) continue;
        const std::vector<int> path = path_from_root(line, leaf);
        const bool is_trunk = leaf == trunk.back();
        found.emplace_back(is_trunk ? std::numeric_limits<double>::infinity()
                                    : length_to(line, path, after_last_fork(path, children)), leaf);
    }
    std::sort(found.begin(), found.end());
    std::vector<int> leaves;
    for (const auto& [distance, leaf] : found) leaves.push_back(leaf);
    return leaves;
}

}  // namespace seldinger
