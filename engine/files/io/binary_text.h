#pragma once
// Numbers in the bytes of a file, as DICOM and ZIP have them.

#include <cstdint>
#include <string>

namespace seldinger {

/// The lowest `size` bytes of a number, the lowest first (little-endian).
inline void put_number(std::string& bytes, std::uint64_t value, int size)
{
    for (int k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}

}  // namespace seldinger
