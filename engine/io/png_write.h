#pragma once
// Pictures to PNG files.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace seldinger {

/// 8-bit RGB, rows from the top. The file appears under its name only when it is complete.
/// @throws Error BadFile
void write_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels);

}  // namespace seldinger
