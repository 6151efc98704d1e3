#pragma once
// Writes pictures to PNG files.

#include "core/folder.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace seldinger {

/// 8-bit RGB, or RGBA (straight) where there are 4 bytes a pixel; rows from the top. The file appears under its name only when it
/// is complete.
/// @throws Error BadFile
void write_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint8_t>& pixels);

/// 12-bit grey, rows from the top, as a 16-bit file that viewers show right: 4095 becomes 65535 (each value times 16, its upper
/// bits repeated below), and sBIT says that 12 bits count. The file appears under its name only when it is complete.
/// @throws Error BadFile
void write_grey_png(const std::filesystem::path& path, int width, int height, const std::vector<std::uint16_t>& grey);

/// Numbers, not shades: 8 or 16 bits a pixel as they are, rows from the top. The file appears under its name only when it is
/// complete.
/// @throws Error BadFile
void write_label_png(const FilePlace& place, int width, int height, std::span<const std::uint8_t> labels);
void write_label_png(const FilePlace& place, int width, int height, std::span<const std::uint16_t> values);

// Reads back the masks that write_label_png() wrote.

struct LabelImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> labels;  // rows from the top
};

/// 8-bit grey of at most 8192 x 8192. @throws Error BadFile: missing, damaged, or another kind of picture
[[nodiscard]] LabelImage read_label_png(const std::filesystem::path& path);

}  // namespace seldinger
