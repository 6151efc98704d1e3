// When a scene's prescribed motion ends, how many steps it has, and stiffnesses from a material.
#include "scene/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

long Scene::steps() const { return std::lround(duration / dt); }

double prescribed_until(const Scene& scene)
{
    double end = 0;
    const auto include = [&](const auto& rows) {
        if (!rows.empty()) end = std::max(end, rows.back()[0]);
    };
    if (scene.feed.on) end = scene.feed.keys.back().t;
    for (const HoldSpec& hold : scene.holds) include(hold.move), include(hold.turn);
    for (const LinkSpec& link : scene.links) include(link.move);
    for (const LoadSpec& load : scene.loads) end = std::max(end, load.ramp);
    return end;
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
