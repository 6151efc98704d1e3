#pragma once
// The exact test after the broad phase of a library that has none (wide/segment_triangle.h).

#include "peers.h"

#include "wide/segment_triangle.h"

namespace peers {

inline seldinger::vec3 vec(const std::array<double, 3>& p) { return {p[0], p[1], p[2]}; }

inline seldinger::Triangle triangle(const Problem& problem, std::uint32_t t)
{
    return seldinger::load_triangle(problem.tree->vertices.data(), t, {0, 0, 0});
}

inline bool within(const Problem& problem, const Capsule& c, std::uint32_t t)
{
    return seldinger::segment_within(vec(c.a), vec(c.b) - vec(c.a), triangle(problem, t), c.radius * c.radius);
}

/// Nearest point of triangle t and its squared distance.
inline double nearest_point(const Problem& problem, const std::array<double, 3>& p, std::uint32_t t, seldinger::vec3* point)
{
    int feature;
    *point = seldinger::closest_on_triangle(vec(p), triangle(problem, t), &feature);
    const seldinger::vec3 v = vec(p) - *point;
    return seldinger::dot3(v, v);
}

}  // namespace peers
