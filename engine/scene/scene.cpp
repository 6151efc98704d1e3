#include "scene/scene.h"

#include <cmath>
#include <numbers>

namespace seldinger {

long Scene::steps() const
{
    return std::lround(duration / dt);
}

void set_stiffness_from_material(WireSection& section)
{
    const double r2 = section.radius * section.radius;
    const double shear = section.youngs / (2 * (1 + section.poisson));
    section.stretch_stiffness = section.youngs * std::numbers::pi * r2;
    section.bend_stiffness = section.youngs * std::numbers::pi * r2 * r2 / 4;
    section.twist_stiffness = shear * std::numbers::pi * r2 * r2 / 2;
}

}  // namespace seldinger
