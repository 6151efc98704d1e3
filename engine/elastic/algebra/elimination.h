#pragma once
// Fill of the elimination of a sparse symmetric matrix, before any number is known.

#include "math/dissection.h"

#include <cstdint>
#include <vector>

namespace seldinger {

/// Columns of the factor gathered in panels: runs of columns whose rows below the run's own square are taken for the same.
struct Elimination {
    std::vector<std::int32_t> order;              // old vertex of each new one; children of the elimination tree before parents
    std::vector<std::int32_t> first;              // [panels + 1] first column
    std::vector<std::vector<std::int32_t>> rows;  // [panel] new vertices below its own square, increasing
    std::vector<std::int32_t> parent;             // [panel] that its first row belongs to, -1: none
    double entries = 0;                           // below the diagonal
};

/// @param order  old vertex of each new one; the result fills as much but is postordered
[[nodiscard]] Elimination eliminate(const Graph& graph, const std::vector<std::int32_t>& order);

}  // namespace seldinger
