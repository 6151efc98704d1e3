// Compares peaks of two runs, and bounds the remaining error.
#include "models/peaks.h"

#include "models/refinement.h"

#include <algorithm>
#include <limits>

namespace seldinger {

Peaks difference(const Peaks& a, const Peaks& b)
{
    Peaks apart{};
    for (std::size_t k = 0; k < apart.size(); ++k) apart[k] = std::abs(a[k] - b[k]);
    return apart;
}

Peaks peaks_left(const std::vector<Peaks>& moved)
{
    Peaks left{};
    for (std::size_t k = 0; k < left.size(); ++k) {
        std::vector<double> column;
        for (const Peaks& row : moved) column.push_back(row[k]);
        if (column.size() > 1) column.back() = std::max(column.back(), column[column.size() - 2] / 2);
        left[k] = error_left(column);
    }
    return left;
}

Peaks PeakGoal::allowed(const Peaks& right) const
{
    constexpr double least = 1e-3;  // [N]
    Peaks allowed{};
    for (std::size_t k = 0; k < allowed.size(); ++k) {
        const double newtons = k == 2 ? diameter : 1.0;  // of one unit of the peak
        allowed[k] = tolerance * (is_relative ? std::max(right[k], least / newtons) : 1 / newtons);
    }
    return allowed;
}

bool PeakGoal::holds(const Peaks& error, const Peaks& uncertainty, const Peaks& right, double share) const
{
    if (!asked()) return true;
    const Peaks most = allowed(right);
    for (std::size_t k = 0; k < most.size(); ++k)
        if (!(error[k] + uncertainty[k] <= share * most[k])) return false;
    return true;
}

}  // namespace seldinger
