// Constants of the wall that follow from its shape.
#include "wall/wall_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

double median(std::vector<double> radius)
{
    if (radius.empty()) return std::numeric_limits<double>::infinity();
    const auto middle = radius.begin() + static_cast<std::ptrdiff_t>(radius.size() / 2);
    std::nth_element(radius.begin(), middle, radius.end());
    return *middle;
}

}  // namespace

WallModel::WallModel(const VesselSpec& made_of, const WallMesh& shape, const Centreline& axis)
    : spec(made_of), mesh(shape), centreline(axis), typical_lumen_radius(median(axis.radius))
{
}

double lumen_radius_at(const WallModel& wall, const Vec3& place)
{
    constexpr double touching = 0.1;  // of a sphere's radius: facets, and points that stand apart along the axis
    const Centreline& axis = wall.centreline;
    if (wall.spec.shape == VesselShape::Plane) return wall.spec.size / 2;
    const auto apart = [&](std::size_t i) { return (place - axis.points[i]).norm() - axis.radius[i]; };
    double radius = std::numeric_limits<double>::infinity(), nearest = radius;
    for (std::size_t i = 0; i < axis.points.size(); ++i)
        if (apart(i) < nearest) nearest = apart(i), radius = axis.radius[i];
    for (std::size_t i = 0; i < axis.points.size(); ++i)
        if (apart(i) <= nearest + touching * axis.radius[i]) radius = std::max(radius, axis.radius[i]);
    return radius;
}

}  // namespace seldinger
