// The published method's choices as printed, and its best settings by benchmark as bench/published_at_best.py found them.
#include "lab/published.h"

#include <algorithm>
#include <iterator>

namespace seldinger {
namespace {

constexpr double millisecond = 1e-3, display = 1.0 / 60;  // [s]

/// One winner of the search (bench/results/chart/published_best.csv). 0: as the scene has it.
struct Best {
    std::string_view benchmark;
    bool frame;
    double dt;
    int nodes;
    FrictionLaw friction;
    double restitution;
    double linear_stiffness = 0, stretch_stiffness = 0, damping_mass = 0, radius = 0;
};

using enum FrictionLaw;

// The first two are for scenes that were not searched: without damping of contact, whose factor is infinite where contact
// persists, and in long steps on a soft wall.
constexpr Best winners[] = {
    {"", false, 1 * millisecond, 101, Sign, 1},
    {"", true, display, 101, Smooth, 1, 1e4, 500},
    {"capstan", false, 0.5 * millisecond, 101, StickSlip, 1, 1e5, 0, 10},
    {"capstan", true, display, 201, Sign, 0.9, 1e4},
    {"experiment1", false, 0.5 * millisecond, 201, StickSlip, 0.9, 1e4, 500},
    {"experiment1", true, display, 201, Smooth, 1, 1e4, 500},
    {"whip", false, 0.5 * millisecond, 201, StickSlip, 0.5, 1e5, 69.66, 100, 2.67e-4},
    {"whip", true, display, 201, StickSlip, 1, 1e4, 69.66, 100, 2.67e-4},
    {"siphon", false, 0.5 * millisecond, 101, Smooth, 1, 1e6, 69.66, 10, 2.67e-4},
    {"siphon", true, display, 101, StickSlip, 0.5},
    {"coronary", false, 0.5 * millisecond, 101, StickSlip, 1, 1e5, 0, 100, 2.67e-4},
    {"coronary", true, display, 101, Smooth, 0.5, 1e4, 0, 0, 2.67e-4},
};

}  // namespace

Model published_method(Detection detection)
{
    Model model;
    model.name = "published";
    model.scheme = Scheme::Linearised;
    model.detection = detection;
    model.normal = NormalLaw::LankaraniNikravesh;
    model.friction = FrictionLaw::Sign;
    return model;
}

Model published_at_best(std::string_view benchmark, bool frame)
{
    const auto of = [&](std::string_view name) {
        return std::find_if(std::begin(winners), std::end(winners),
                            [&](const Best& best) { return best.benchmark == name && best.frame == frame; });
    };
    const Best& best = of(benchmark) != std::end(winners) ? *of(benchmark) : *of("");
    Model model = published_method();
    model.name = "published at its best";
    model.dt = best.dt;
    model.nodes = best.nodes;
    model.restitution = best.restitution;
    model.friction = best.friction;
    if (best.linear_stiffness > 0) model.linear_stiffness = best.linear_stiffness;
    if (best.stretch_stiffness > 0) model.stretch_stiffness = best.stretch_stiffness;
    if (best.damping_mass > 0) model.damping_mass = best.damping_mass;
    if (best.radius > 0) model.radius = best.radius;
    return model;
}

}  // namespace seldinger
