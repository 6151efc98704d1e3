#pragma once
// Triangles of solid objects: the wire as a tube, contacts as balls and force pins. Built on the host for each view,
// because the least width on paper depends on the camera.

#include "math/vec3.h"
#include "view/colour.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

struct SolidVertex {
    float position[3];  // [m] relative to the scene's centre
    float normal[3];    // unit, outwards
    float colour[3];    // linear light
    float pull;  // depth is taken this far nearer to the eye [m]: a wire drawn wider than it is must not sink into the wall
};

struct Solids {
    std::vector<SolidVertex> vertices;
    std::vector<std::uint32_t> indices;  // counter-clockwise from outside
    void clear() { vertices.clear(), indices.clear(); }
};

/// One station along a tube.
struct TubeStation {
    Vec3 position = Vec3::Zero();
    double radius = 0;  // [m]
    double pull = 0;    // [m]
};

/// Points of a smooth curve through `nodes`: cubic Hermite pieces with three-point tangents, as many as keep the turn of
/// a piece under 6 degrees. Display only; passes through every node.
[[nodiscard]] std::vector<TubeStation> smooth_line(std::span<const Vec3> nodes, std::span<const double> radius);

/// Tube with rotation-minimising frames and round ends.
void add_tube(Solids& solids, std::span<const TubeStation> line, const Rgb& colour, const Vec3& origin);
/// @param colours  one for each station
void add_tube(Solids& solids, std::span<const TubeStation> line, std::span<const Rgb> colours, const Vec3& origin);
void add_ball(Solids& solids, const TubeStation& ball, const Rgb& colour, const Vec3& origin);
/// Cone from `base` (its radius) to a point at `end`.
void add_cone(Solids& solids, const TubeStation& base, const Vec3& end, const Rgb& colour, const Vec3& origin);

// The wall as the graphics card has it.

/// Position relative to `origin`, area-weighted normal and share of the scale of every vertex, seven numbers each. @param share 
/// empty: 0
[[nodiscard]] std::vector<float> interleaved_wall(const std::vector<Vec3>& vertices,
                                                  const std::vector<std::array<std::int32_t, 3>>& triangles,
                                                  std::span<const float> share, const Vec3& origin);

}  // namespace seldinger
