// Numbers the ends of a centreline and says which of its branches a point lies in.
#include "vessel/branches.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace seldinger {
namespace {

std::vector<int> child_counts(const Centreline& line)
{
    std::vector<int> children(line.points.size());
    for (const int parent : line.parent)
        if (parent >= 0) ++children[static_cast<std::size_t>(parent)];
    return children;
}

/// Arc length of every point, summed from the root outwards; a parent may come after its child in the list.
std::vector<double> lengths_from_root(const Centreline& line)
{
    std::vector<double> length(line.points.size(), -1);
    std::vector<int> climb;
    for (int i = 0; i < static_cast<int>(line.points.size()); ++i) {
        for (int at = i; at >= 0 && length[static_cast<std::size_t>(at)] < 0; at = line.parent[static_cast<std::size_t>(at)]) climb.push_back(at);
        for (; !climb.empty(); climb.pop_back()) {
            const auto k = static_cast<std::size_t>(climb.back());
            const int up = line.parent[k];
            length[k] = up < 0 ? 0.0 : length[static_cast<std::size_t>(up)] + (line.points[k] - line.points[static_cast<std::size_t>(up)]).norm();
        }
    }
    return length;
}

/// Points behind the last fork on the path to `leaf`, from there outwards; all of the path where there is no fork.
std::vector<int> own_stretch(const Centreline& line, const std::vector<int>& children, int leaf)
{
    std::vector<int> stretch = {leaf};
    for (int at = line.parent[static_cast<std::size_t>(leaf)]; at >= 0 && children[static_cast<std::size_t>(at)] < 2;
         at = line.parent[static_cast<std::size_t>(at)])
        stretch.push_back(at);
    std::reverse(stretch.begin(), stretch.end());
    return stretch;
}

/// How far past the point `nearest` of its stretch `own` the foot of p lies on the two edges that meet there, < 0 before it [m].
double past_point(const Centreline& line, const std::vector<int>& own, int nearest, const Vec3& p)
{
    const auto at = [&](int i) { return line.points[static_cast<std::size_t>(i)]; };
    const Vec3 here = at(nearest);
    double past = 0, closest = (p - here).norm();
    const auto try_edge = [&](int to, double sign) {
        const Vec3 edge = at(to) - here;
        const double length = edge.norm();
        if (length == 0) return;
        const double along = std::clamp((p - here).dot(edge) / length, 0.0, length), away = (p - here - (along / length) * edge).norm();
        if (away < closest) closest = away, past = sign * along;
    };
    if (line.parent[static_cast<std::size_t>(nearest)] >= 0) try_edge(line.parent[static_cast<std::size_t>(nearest)], -1);
    const auto child = std::find(own.begin(), own.end(), nearest) + 1;
    if (child < own.end()) try_edge(*child, 1);
    return past;
}

}  // namespace

Branches::Branches(const Centreline& line)
{
    if (line.empty()) return;
    const std::vector<int> children = child_counts(line);
    const int trunk_end = line.main_path().back();
    from_root_ = lengths_from_root(line);
    std::vector<std::pair<double, int>> leaves;
    for (int leaf = 0; leaf < static_cast<int>(line.points.size()); ++leaf) {
        if (children[static_cast<std::size_t>(leaf)] > 0) continue;
        leaves.emplace_back(leaf == trunk_end ? std::numeric_limits<double>::infinity() : from_root(own_stretch(line, children, leaf).front()), leaf);
    }
    std::sort(leaves.begin(), leaves.end());
    for (const auto& [leaves_at, leaf] : leaves) own_.push_back(own_stretch(line, children, leaf));
    find_mouths(line);
}

void Branches::find_mouths(const Centreline& line)
{
    branch_of_.assign(line.points.size(), 0);
    for (int number = 1; number <= count(); ++number) {
        const std::vector<int>& own = points(number);
        const int fork = line.parent[static_cast<std::size_t>(own.front())];
        const auto is_out = [&](int i) {
            const auto f = static_cast<std::size_t>(fork);
            return fork < 0 || (line.points[static_cast<std::size_t>(i)] - line.points[f]).norm() > line.radius[f];
        };
        // one that ends within the ball about its fork has its mouth at its end
        const auto mouth = std::min(std::find_if(own.begin(), own.end(), is_out), own.end() - 1);
        mouth_.push_back(from_root(*mouth));
        std::for_each(mouth, own.end(), [&](int i) { branch_of_[static_cast<std::size_t>(i)] = number; });
    }
}

Branches::Place Branches::locate(const Centreline& line, const Vec3& p) const
{
    if (own_.empty()) return {};
    const int nearest = line.nearest(p);
    const int branch = branch_of_[static_cast<std::size_t>(nearest)];
    if (branch == 0) return {};
    return {branch, std::max(0.0, depth(branch, nearest) + past_point(line, points(branch), nearest, p))};
}

}  // namespace seldinger
