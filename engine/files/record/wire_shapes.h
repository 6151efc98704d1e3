#pragma once
// Shapes of instruments as arrays: points at even arc lengths, of one shape or of all frames of a run.

#include "math/vec3.h"
#include "record/checkpoint.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace seldinger {

/// Points of a shape in wire.npz and in the tables of a batch.
inline constexpr std::size_t shape_stations = 64;

/// Appends x, y, z of `count` points at even arc lengths along a polyline, first point first. @param line  one point at least
void put_stations(std::span<const Vec3> line, std::size_t count, std::vector<double>& to);

/// wire.npz: time_s [frames], step [frames], and position_m [frames, shape_stations, 3] of [wire] or NAME.position_m of each
/// instrument.
/// @param series  stems of the frames' files  @param names  of the instruments, one empty one of [wire]
/// @throws Error BadFile: a frame is missing or damaged
[[nodiscard]] std::string wire_npz(const std::filesystem::path& dir, const std::vector<FrameMark>& frames,
                                   const std::vector<std::string>& series, const std::vector<std::string>& names);

}  // namespace seldinger
