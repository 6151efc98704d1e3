// Area and pressure of a contact point from its overlap or, where the law has none, from its force.
#include "contact/loads/contact_patch.h"

#include "shared/multiplier_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

double overlap_width(double depth, double radius)
{
    const double delta = std::clamp(depth, 0.0, radius);
    return 2 * std::sqrt(delta * (2 * radius - delta));
}

double overlap_width(double depth, double radius_a, double radius_b, bool inside)
{
    const double delta = std::clamp(depth, 0.0, std::min(radius_a, radius_b));
    const double apart = inside ? radius_b - radius_a + delta : radius_a + radius_b - delta;
    if (!(delta > 0) || !(apart > 0)) return 0;
    // the chord is this far from a's centre
    const double from_a = (radius_b * radius_b - radius_a * radius_a - apart * apart) / (2 * apart);
    return 2 * std::sqrt(std::max(0.0, radius_a * radius_a - from_a * from_a));
}

ContactPatch contact_patch(const QuadratureModel& model, uint normal_law, double gap, double force)
{
    if (!(force > 0)) return {};
    const double depth = normal_law == SEL_NORMAL_DAMPED ? -gap : depth_carrying(force / model.weight, model);
    const double width = overlap_width(depth, model.radius);
    const double area = model.length > 0 ? width * model.length : std::numbers::pi / 4 * width * width;
    // a damped law may still push in the step in which the overlap has just closed: area and pressure are 0
    return area > 0 ? ContactPatch{area, force / area} : ContactPatch{};
}

}  // namespace seldinger
