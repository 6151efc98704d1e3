// Fréchet distance of two polylines by bisection over the free-space diagram.
#include "models/frechet.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace seldinger {
namespace {

constexpr double negligible = 1e-15;  // [m]: curves this close are the same

/// Part of an edge, as parameters in [0, 1]; empty when low > high.
struct Interval {
    double low = 2, high = -1;
    [[nodiscard]] bool empty() const { return low > high; }
};

/// Where the segment p..q is within `leash` of c.
Interval free_part(const Vec3& c, const Vec3& p, const Vec3& q, double leash)
{
    const Vec3 along = q - p, to = p - c;
    const double length2 = along.squaredNorm(), distance2 = to.squaredNorm() - leash * leash;
    if (length2 == 0) return distance2 <= 0 ? Interval{0, 1} : Interval{};
    const double middle = -to.dot(along) / length2;
    const double root2 = middle * middle - distance2 / length2;
    if (root2 < 0) return {};
    const double root = std::sqrt(root2);
    return {std::max(0.0, middle - root), std::min(1.0, middle + root)};
}

/// Whether a leash of this length suffices. Cell (i, j) of the free-space diagram is edge i of a against edge j of b. A column's
/// left borders hold the points that monotone walks reach from the start. Only non-empty ones are visited, so close curves cost
/// as much as they have vertices.
bool leash_suffices(std::span<const Vec3> a, std::span<const Vec3> b, double leash)
{
    if ((a.front() - b.front()).norm() > leash || (a.back() - b.back()).norm() > leash) return false;
    const std::size_t rows = b.size() - 1;
    std::vector<Interval> left(rows), right(rows);  // reachable on the cell's border a = vertex i, vertex i + 1
    for (std::size_t j = 0; j < rows; ++j) {        // along a's first vertex: free from the start without a gap
        const Interval free = free_part(a[0], b[j], b[j + 1], leash);
        if (free.empty() || free.low > 0) break;
        left[j] = free;
        if (free.high < 1) break;
    }
    bool along_bottom = true;  // b's first vertex reaches this far along a
    std::size_t first = 0;     // rows below it are out of reach for good
    for (std::size_t i = 0; i + 1 < a.size(); ++i) {
        Interval bottom;
        if (along_bottom) {
            const Interval free = free_part(b[0], a[i], a[i + 1], leash);
            if (!free.empty() && free.low == 0) bottom = free;
            along_bottom = !bottom.empty() && bottom.high >= 1;
        }
        if (first > 0) bottom = {};
        std::fill(right.begin() + static_cast<std::ptrdiff_t>(first), right.end(), Interval{});
        std::size_t next_first = rows;
        Interval top_of_last;
        for (std::size_t j = first; j < rows; ++j) {
            const Interval below = j == 0 ? bottom : top_of_last;
            top_of_last = {};
            if (left[j].empty() && below.empty()) continue;
            const Interval top = free_part(b[j + 1], a[i], a[i + 1], leash), side = free_part(a[i + 1], b[j], b[j + 1], leash);
            // a cell's free part is convex: from the left border all of the top is reached, from below only the part ahead
            if (!top.empty()) {
                top_of_last = top;
                if (left[j].empty()) top_of_last.low = std::max(top.low, below.low);
            }
            if (!side.empty()) {
                right[j] = side;
                if (below.empty()) right[j].low = std::max(side.low, left[j].low);
                if (!right[j].empty()) next_first = std::min(next_first, j);
            }
        }
        std::swap(left, right);
        if (i + 2 == a.size()) break;
        first = next_first;
        if (first == rows && !along_bottom) return false;
        if (along_bottom) first = 0;
    }
    return !left[rows - 1].empty() && left[rows - 1].high >= 1;
}

/// A leash that surely suffices: both walk at the same fraction of their vertices' arc length.
double simple_walk(std::span<const Vec3> a, std::span<const Vec3> b)
{
    const auto fractions = [](std::span<const Vec3> line) {
        std::vector<double> at(line.size(), 0.0);
        for (std::size_t i = 1; i < line.size(); ++i) at[i] = at[i - 1] + (line[i] - line[i - 1]).norm();
        const double whole = at.back();
        for (double& value : at) value = whole > 0 ? value / whole : 1;
        return at;
    };
    const auto place = [](std::span<const Vec3> line, const std::vector<double>& at, double u) -> Vec3 {
        const auto above = std::upper_bound(at.begin(), at.end(), u);
        if (above == at.end()) return line.back();
        if (above == at.begin()) return line.front();
        const auto k = static_cast<std::size_t>(above - at.begin());
        const double t = (u - at[k - 1]) / (at[k] - at[k - 1]);
        return (1 - t) * line[k - 1] + t * line[k];
    };
    const std::vector<double> of_a = fractions(a), of_b = fractions(b);
    double longest = std::max((a.front() - b.front()).norm(), (a.back() - b.back()).norm());
    for (std::size_t i = 0; i < a.size(); ++i) longest = std::max(longest, (a[i] - place(b, of_b, of_a[i])).norm());
    for (std::size_t j = 0; j < b.size(); ++j) longest = std::max(longest, (b[j] - place(a, of_a, of_b[j])).norm());
    return longest;
}

}  // namespace

double frechet_distance(std::span<const Vec3> a, std::span<const Vec3> b, double relative)
{
    SEL_ASSERT(a.size() >= 2 && b.size() >= 2);
    double low = std::max((a.front() - b.front()).norm(), (a.back() - b.back()).norm()), high = simple_walk(a, b);
    const auto is_there = [](std::span<const Vec3> line) {
        return std::all_of(line.begin(), line.end(), [](const Vec3& p) { return p.allFinite(); });
    };
    // halving would not end
    if (!std::isfinite(high) || !is_there(a) || !is_there(b)) return std::numeric_limits<double>::infinity();
    if (high <= low || leash_suffices(a, b, low)) return low;
    while (high - low > relative * high && high > negligible) {
        const double middle = 0.5 * (low + high);
        (leash_suffices(a, b, middle) ? high : low) = middle;
    }
    return high;
}

}  // namespace seldinger
