#pragma once
// A binary file that shows whether it is complete: magic, payload size (UInt64), payload, FNV-1a of the payload (UInt64);
// little-endian, as in memory.

#include "core/folder.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace seldinger {

/// Complete or not at all, and there after a power cut. @throws Error BadFile
void write_sealed(const FilePlace& place, std::string_view magic, const std::vector<std::uint8_t>& payload);

/// @throws Error BadFile: missing, damaged, or with another magic
[[nodiscard]] std::vector<std::uint8_t> read_sealed(const FilePlace& place, std::string_view magic);

}  // namespace seldinger
