// Area and pressure of a contact point from its overlap or, where the law has none, from its force.

#include "contact/contact_patch.h"

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

ContactPatch contact_patch(const QuadratureModel& model, uint normal_law, double gap, double force)
{
    if (!(force > 0)) return {};
    const double depth = normal_law == SEL_NORMAL_DAMPED ? -gap : depth_carrying(force / model.weight, model);
    const double width = overlap_width(depth, model.radius);
    const double area = model.length > 0 ? width * model.length : std::numbers::pi / 4 * width * width;
    // a damped law may still push in the step in which the overlap has just closed: no area, and no pressure to tell of
    return area > 0 ? ContactPatch{area, force / area} : ContactPatch{};
}

}  // namespace seldinger
