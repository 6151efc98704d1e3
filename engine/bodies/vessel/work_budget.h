#pragma once
// Bounds the work that a mesh may ask for. Several steps that find a lumen are quick on meshes that look like vessels, but
// quadratic or worse on meshes made to be slow. Such a mesh is refused instead of waited for.

#include "core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace seldinger {

/// Steps for a mesh of as many vertices as a file of a megabyte can hold, and so many more for each vertex beyond.
[[nodiscard]] inline double work_limit(double steps, double each_more, std::size_t vertices)
{
    constexpr double few = 60000;
    return steps + each_more * std::max(0.0, static_cast<double>(vertices) - few);
}

/// Counts steps, of some nanoseconds each, and refuses at the limit. Limits are steps and not seconds, so that the answer is the
/// same on every machine.
class WorkBudget {
public:
    /// @param task   for the message: "cutting its polygons into triangles"
    /// @param limit  several times what the slowest of the patients' vessels needs, and a second or two
    WorkBudget(const char* task, double limit) : task_(task), limit_(limit), left_(limit) {}

    /// @throws Error BadFile when the limit is passed
    void spend(double steps)
    {
        left_ -= steps;
        if (left_ < 0) refuse();
    }
    void allow(double more) { left_ += more; }
    [[nodiscard]] bool is_nearly_spent() const { return left_ < 0.2 * limit_; }

private:
    [[noreturn]] void refuse() const
    {
        throw Error(ErrorKind::BadFile, fmt::format("too tangled: {} takes more than {:.0f} million steps; a vessel's wall is "
                                                   "expected, without loose pieces, parts that cut through each other and "
                                                   "triangles a thousand times as long as wide",
                                                   task_, 1e-6 * limit_));
    }
    const char* task_;
    double limit_, left_;
};

}  // namespace seldinger
