#pragma once
// Models on the Pareto front: no other one is both cheaper and more accurate.

#include <span>
#include <vector>

namespace seldinger {

struct CostAndError {
    double cost = 0, error = 0;
};

/// Indices of the points that no other point beats in one and equals or beats in the other, by rising cost. Among equal points
/// the first. Points that are not finite are left out.
/// @param gain  a dearer point is worth having only when its error is smaller by more than this: what errors are uncertain by
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const CostAndError> points, double gain = 0);

}  // namespace seldinger
