#pragma once
// What the fuzz targets share.

#include "core/error.h"
#include "fuzz_targets.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace seldinger::fuzz {

inline void require(bool holds)
{
    if (!holds) std::abort();
}

inline std::string text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// @param also  a code that an Error may have beside BadFile
template <class Work>
void answer(const Work& work, ErrorKind also = ErrorKind::BadFile)
{
    try {
        work();
    } catch (const Error& error) {
        require(error.kind() == ErrorKind::BadFile || error.kind() == also);
        for (const char* c = error.what(); *c; ++c) require(*c == '\n' || static_cast<unsigned char>(*c) >= ' ');
    }
}

/// Parts of an input, between bytes 0x1e (ASCII's record separator); `count` of them, empty where there are fewer, the last one
/// whatever is left.
inline std::vector<std::string> parts_of(Bytes bytes, std::size_t count)
{
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<std::string> parts(count);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t end = k + 1 == count ? rest.size() : std::min(rest.find('\x1e'), rest.size());
        parts[k] = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return parts;
}

/// Written without the care of core/file_io.h, which would wait for the disk.
inline void put_file(const std::filesystem::path& path, std::string_view content)
{
    std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace seldinger::fuzz
