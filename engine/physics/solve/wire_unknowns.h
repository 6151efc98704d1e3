#pragma once
// One wire's part of the vectors that its system works with, laid out as RodDofs says.

#include "math/dof_map.h"
#include "math/vec3.h"

#include <cstdint>
#include <span>

namespace seldinger {

struct WireUnknowns {
    std::span<double> start, trial;         // q_0, q
    std::span<double> residual;             // R at trial
    std::span<double> inertia;              // mass [kg] or spin inertia [kg m^2]
    std::span<double> prescribed_value;     // where prescribed
    std::span<std::uint8_t> prescribed;     // 1: fixed at prescribed_value (and the place that no edge takes)
    std::span<double> scratch, velocities;  // of the thread
    std::span<double> split;                // the trial as separate x, y, z, theta for the rod's functions
};

[[nodiscard]] inline Vec3 node_of(std::span<const double> q, int i)
{
    const double* x = q.data() + RodDofs::position(i);
    return {x[0], x[1], x[2]};
}

inline void add_to_node(std::span<double> q, int i, const Vec3& value)
{
    for (int c = 0; c < RodDofs::coordinates; ++c) q[RodDofs::position(i, c)] += value[c];
}

}  // namespace seldinger
