// Checks that contact samples, forces on nodes and readings along a wire belong to one state.
#include "contact/contact_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seldinger {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

bool equal(double a, double b, double allowed) { return std::abs(a - b) <= allowed * std::max(std::abs(a), std::abs(b)); }

}  // namespace

bool add_up(double normal, double friction, std::size_t samples, const ContactTotals& totals, bool float32)
{
    const double of_device = float32 ? static_cast<double>(std::numeric_limits<float>::epsilon()) : rounding;
    const double allowed = 4 * static_cast<double>(samples + 1) * of_device;
    // non-finite values have their own flag (StepNonFinite)
    if (!std::isfinite(totals.normal + totals.friction)) return true;
    return equal(normal, totals.normal, allowed) && equal(friction, totals.friction, allowed);
}

bool within_sum(const ContactAlong& along, const WireLoads& loads)
{
    double sum = 0, slopes = 0, farthest = 0;
    for (const LoadSample& sample : loads.samples) {
        sum += sample.force;
        if (sample.length > 0) slopes += sample.force / sample.length;
        farthest = std::max(farthest, std::abs(sample.s) + sample.length / 2);
    }
    if (loads.samples.empty()) return along.patch_force == 0 && along.per_length_max == 0;
    const double allowed = 8 * static_cast<double>(loads.samples.size()) * rounding * (sum + farthest * slopes);
    return along.patch_force <= sum + allowed && along.per_length_max * along.window <= sum + allowed;
}

}  // namespace seldinger
