// Values that follow from a scene.
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
    return {on, point, direction, start.advance, start.turn, hub, behind, {}};
}

namespace {

/// Whether steps fill a duration; a dt of so many decimals ("0.016666667") may miss it by 1e-7 of the whole.
bool is_whole(double steps) { return std::abs(steps - std::round(steps)) <= std::max(1e-6, 1e-7 * steps); }

}  // namespace

long Scene::steps() const
{
    const double steps = duration / dt;
    return static_cast<long>(is_whole(steps) ? std::round(steps) : std::ceil(steps));
}

double Scene::step_length(long taken) const
{
    const long all = steps();
    return taken != all - 1 || is_whole(duration / dt) ? dt : duration - static_cast<double>(all - 1) * dt;
}

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

void choose_wall_youngs(Scene& scene)
{
    if (scene.vessel.youngs_given) return;
    constexpr double tissue = 1e6, hardest = 1e9;
    double youngs = tissue;
    for (int k = 0; !scene.vessel.elastic && k < scene.instrument_count(); ++k) {
        const WireSection& shaft = scene.instrument(k).wire.shaft;
        const double own = 4 * shaft.bend_stiffness / (std::numbers::pi * std::pow(shaft.radius, 4));
        youngs = std::max(youngs, std::pow(10, std::round(std::log10(own / 40))));
    }
    scene.vessel.youngs = std::min(youngs, hardest);
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
