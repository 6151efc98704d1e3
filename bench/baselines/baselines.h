#pragma once
// What the field uses beside elastic rods, written plainly, so that charts test "mass-spring is fast, finite elements are
// accurate" instead of repeating it. They are no part of the engine: free wires clamped at their base, no contact.

#include "models/simulation.h"

#include <string>
#include <vector>

namespace seldinger::baselines {

/// "mass-spring", "soft mass-spring", "beam", "beam · lin".
[[nodiscard]] std::vector<Baseline> all();

/// A wire that all baselines can compute: uniform, naturally straight, placed straight, clamped at its base, dead forces at its
/// tip.
/// @return why the scene is another; empty when it is not
[[nodiscard]] std::string why_not_cantilever(const Scene& scene);

/// The scene in the baselines' terms. Node 0 is the tip.
struct Cantilever {
    int nodes = 0;
    double edge = 0;                          // rest length of every edge [m]
    double mass = 0;                          // of one edge; the tip's and the base's nodes have half [kg]
    double bend = 0, twist = 0, stretch = 0;  // B, C [N m^2], EA [N]
    double spin_inertia = 0;                  // of one edge about its axis [kg m^2]
    double damping = 0;                       // mass proportional [1/s]
    Vec3 base, direction;                     // direction: unit, from base to tip
    Vec3 gravity;
    std::vector<LoadSpec> loads;

    [[nodiscard]] double node_mass(int i) const { return i == 0 || i == nodes - 1 ? mass / 2 : mass; }
    [[nodiscard]] Vec3 tip_force(double t) const;
};
[[nodiscard]] Cantilever read_cantilever(const Scene& scene);

}  // namespace seldinger::baselines
