// What follows from a scene as it was read.

#include "scene/scene.h"

#include "solve/feed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {

FeedKey SceneFeed::at(double t) const { return keys.empty() ? FeedKey{t, 0, 0} : HubPath(keys).at(t); }

FeedSpec SceneFeed::inlet() const
{
    const FeedKey start = at(0);
    return {on, point, direction, start.advance, start.turn};
}

long Scene::steps() const { return std::lround(duration / dt); }

double prescribed_until(const Scene& scene)
{
    double end = 0;
    const auto include = [&](const auto& rows) {
        if (!rows.empty()) end = std::max(end, rows.back()[0]);
    };
    for (int k = 0; k < scene.instrument_count(); ++k) {
        const SceneInstrument& instrument = scene.instrument(k);
        if (instrument.feed.on) end = std::max(end, instrument.feed.keys.back().t);
        for (const HoldSpec& hold : instrument.holds) include(hold.move), include(hold.turn);
        for (const LinkSpec& link : instrument.links) include(link.move);
        for (const LoadSpec& load : instrument.loads) end = std::max(end, load.ramp);
    }
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
