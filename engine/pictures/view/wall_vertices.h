#pragma once
// The wall as the graphics card has it.

#include "math/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// Position relative to `origin`, area-weighted normal and share of the scale of every vertex, seven numbers each. @param share 
/// empty: 0
[[nodiscard]] std::vector<float> interleaved_wall(const std::vector<Vec3>& vertices,
                                                  const std::vector<std::array<std::int32_t, 3>>& triangles,
                                                  std::span<const float> share, const Vec3& origin);

}  // namespace seldinger
