// Header and values of a float32 array.
#include "io/npy_write.h"

#include "core/check.h"
#include "core/file_io.h"

#include <fmt/format.h>

#include <bit>

namespace seldinger {

void write_npy(const FilePlace& place, std::span<const float> values, const std::vector<std::size_t>& shape)
{
    static_assert(std::endian::native == std::endian::little);
    std::size_t count = 1;
    std::string sizes;
    for (const std::size_t n : shape) count *= n, sizes += fmt::format("{}, ", n);
    SEL_ASSERT(count == values.size());
    std::string header = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}), }}", sizes);
    header.append(63 - (10 + header.size()) % 64, ' ');  // data begin at a multiple of 64 bytes, after a line end
    header += '\n';
    std::string file("\x93NUMPY\x01\x00", 8);
    file += static_cast<char>(header.size() & 0xff);
    file += static_cast<char>(header.size() >> 8);
    file += header;
    file.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    write_file(place, file);
}

}  // namespace seldinger
