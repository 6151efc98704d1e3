// Paths and look-ups on the vessel's axis.
#include "vessel/centreline.h"

#include "core/check.h"

#include <algorithm>
#include <limits>

namespace seldinger {

std::vector<double> Centreline::lengths() const
{
    // a point's parent may stand behind it in a file: follow parents up, remembering known ones
    std::vector<double> from_root(points.size(), -1);
    std::vector<int> climb;
    for (int i = 0; i < static_cast<int>(points.size()); ++i) {
        int at = i;
        while (from_root[static_cast<std::size_t>(at)] < 0) {
            climb.push_back(at);
            SEL_ASSERT(climb.size() <= points.size());  // a cycle of parents
            if (parent[static_cast<std::size_t>(at)] < 0) break;
            at = parent[static_cast<std::size_t>(at)];
        }
        for (; !climb.empty(); climb.pop_back()) {
            const auto k = static_cast<std::size_t>(climb.back());
            const int up = parent[k];
            from_root[k] =
                up < 0 ? 0.0
                       : from_root[static_cast<std::size_t>(up)] + (points[k] - points[static_cast<std::size_t>(up)]).norm();
        }
    }
    return from_root;
}

std::vector<int> Centreline::main_path() const
{
    if (points.empty()) return {};
    const std::vector<double> from_root = lengths();
    const auto leaf = std::max_element(from_root.begin(), from_root.end()) - from_root.begin();
    std::vector<int> path;
    for (int at = static_cast<int>(leaf); at >= 0; at = parent[static_cast<std::size_t>(at)]) path.push_back(at);
    std::reverse(path.begin(), path.end());
    return path;
}

void Centreline::set_root(int point)
{
    for (int before = -1, at = point; at >= 0;) {
        const int next = parent[static_cast<std::size_t>(at)];
        parent[static_cast<std::size_t>(at)] = before;
        before = at, at = next;
    }
}

std::vector<Vec3> Centreline::main_points() const
{
    std::vector<Vec3> path;
    for (int i : main_path()) path.push_back(points[i]);
    return path;
}

double Centreline::total_length() const
{
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (parent[i] >= 0) sum += (points[i] - points[static_cast<std::size_t>(parent[i])]).norm();
    return sum;
}

int Centreline::nearest(const Vec3& p, int hint) const
{
    if (points.empty()) return -1;
    // a caller that moves along the line: the points around its last one, accepted when the minimum is not at the rim
    constexpr int kReach = 16;
    const int count = static_cast<int>(points.size());
    auto search = [&](int from, int to) {
        int best = from;
        double best_d2 = std::numeric_limits<double>::infinity();
        for (int i = from; i < to; ++i) {
            const double d2 = (points[static_cast<std::size_t>(i)] - p).squaredNorm();
            if (d2 < best_d2) {
                best_d2 = d2;
                best = i;
            }
        }
        return best;
    };
    if (hint >= 0 && hint < count && radius.size() == points.size()) {
        const int best = search(std::max(0, hint - kReach), std::min(count, hint + kReach + 1));
        const bool at_rim = best == hint - kReach || best == hint + kReach;
        // within the lumen of that point no other stretch is nearer, save a branch that leaves there
        if (!at_rim && (points[static_cast<std::size_t>(best)] - p).norm() < radius[static_cast<std::size_t>(best)]) return best;
    }
    return search(0, count);
}

}  // namespace seldinger
