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

}  // namespace seldinger
