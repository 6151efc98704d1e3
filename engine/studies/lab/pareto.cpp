// Picks the points of least cost for their error out of a list.
#include "lab/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {

std::vector<std::size_t> pareto_front(std::span<const CostAndError> points, double gain)
{
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (std::isfinite(points[i].cost) && std::isfinite(points[i].error)) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
    });
    std::vector<std::size_t> front;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : order) {
        if (!(points[i].error < least - gain)) continue;
        least = points[i].error;
        front.push_back(i);
    }
    return front;
}

}  // namespace seldinger
