#pragma once
// The seals of saved files, taken off for the corpus and put right for the readers.

#include "core/fnv1a.h"
#include "fuzz_targets.h"

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace seldinger::fuzz {

/// A scene, short, to which checkpoints and records belong.
constexpr const char* saved_scene = R"([scene]
duration_s = 0.4
dt_s = 0.001
[wire]
length_m = 0.1
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-5
twist_nm2 = 8.0e-6
stretch_n = 1.0e4
)";

template <class T>
void append(std::string& to, const T& value)
{
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A sealed file (core/sealed_file.h) of this payload.
inline std::string sealed(std::string_view magic, std::string_view payload)
{
    std::string file(magic);
    append(file, std::uint64_t{payload.size()});
    file += payload;
    append(file, fnv1a(payload.data(), payload.size()));
    return file;
}

inline std::string unsealed(const std::string& file) { return file.substr(16, file.size() - 24); }

/// A live record (session/session_record.h) without the checksums of its blocks, with them; an incomplete block stays as it is.
inline std::string with_sums(std::string_view rest)
{
    std::string file;
    const auto move = [&](std::size_t size) {
        file += rest.substr(0, size);
        rest.remove_prefix(size);
    };
    const auto length_here = [&] {
        std::uint32_t length = 0;
        std::memcpy(&length, rest.data(), sizeof length);
        return length;
    };
    if (rest.size() < 12) return std::string(rest);
    move(8);
    if (length_here() > rest.size() - 4) return file + std::string(rest);
    move(4 + length_here());
    while (rest.size() >= 4 && length_here() <= rest.size() - 4) {
        const std::uint32_t length = length_here();
        move(4);
        append(file, fnv1a(rest.data(), length));
        move(length);
    }
    return file + std::string(rest);
}

/// The other way.
inline std::string without_sums(const std::string& file)
{
    std::uint32_t length = 0;
    std::memcpy(&length, file.data() + 8, sizeof length);
    std::string bare = file.substr(0, 12 + length);
    for (std::size_t at = bare.size(); at + 12 <= file.size(); at += 12 + length) {
        std::memcpy(&length, file.data() + at, sizeof length);
        bare += file.substr(at, 4) + file.substr(at + 12, length);
    }
    return bare;
}

}  // namespace seldinger::fuzz
