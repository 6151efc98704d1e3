#pragma once
// Reads back the masks that write_label_png() wrote.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace seldinger {

struct LabelImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> labels;  // rows from the top
};

/// 8-bit grey of at most 8192 x 8192. @throws Error BadFile: missing, damaged, or another kind of picture
[[nodiscard]] LabelImage read_label_png(const std::filesystem::path& path);

}  // namespace seldinger
