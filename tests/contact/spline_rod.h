#pragma once
// Nodes of one rod, for tests of points on its curve (kernels/shared/spline.h).

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

}  // namespace seldinger::test
