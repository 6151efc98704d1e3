#pragma once
// Nodes of one rod, for tests and points on its curve (kernels/shared/spline.h).

#include "shared/spline.h"

#include <vector>

namespace seldinger::test {

struct SplineRod {
    std::vector<double> position, material, theta;
    [[nodiscard]] SplineView view() const
    {
        return {position.data(), material.data(), theta.data(), static_cast<uint>(material.size())};
    }
};

/// The curve's point at arc length s from the tip.
inline vec3 point_of_material(SplineView rod, real s)
{
    const SplinePlace p = spline_place(spline_at(rod, s), rod.count);
    return spline_sum(rod, p.node, p.w);
}

}  // namespace seldinger::test
