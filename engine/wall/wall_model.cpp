// Constants of the wall that follow from its shape; how its state changes.

#include "wall/wall_model.h"

#include "core/check.h"

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

void WallState::move_to(std::span<const Vec3> to, std::size_t vertices)
{
    SEL_ASSERT(to.size() == vertices);
    displacement.resize(vertices, Vec3::Zero());
    displacement_t0.resize(vertices, Vec3::Zero());
    double farthest2 = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
        SEL_ASSERT(to[v].allFinite());
        farthest2 = std::max(farthest2, (to[v] - displacement[v]).squaredNorm());
        displacement[v] = to[v];
    }
    moved += std::sqrt(farthest2) * (1 + 1e-12);  // rounded up
    ++epoch;
}

bool WallState::accept()
{
    if (epoch_t0 == epoch) return false;
    displacement_t0 = displacement;
    epoch_t0 = epoch;
    return true;
}

}  // namespace seldinger
