#pragma once
// Numbers in the bytes of a file.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace seldinger {

/// The lowest `size` bytes of a number, the lowest first (little-endian), as DICOM and ZIP have them.
inline void put_number(std::string& bytes, std::uint64_t value, int size)
{
    for (int k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}

/// Bytes as base64, as pages and VTK's XML have them.
[[nodiscard]] inline std::string base64(std::string_view bytes)
{
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        unsigned word = 0;
        const std::size_t there = std::min<std::size_t>(3, bytes.size() - at);
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < there ? static_cast<unsigned char>(bytes[at + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= there ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

/// The number whose bytes begin at `from`.
template <class T>
[[nodiscard]] T number_at(const char* from, bool big_endian)
{
    char raw[sizeof(T)];
    std::memcpy(raw, from, sizeof(T));
    if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof(T));
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
}

/// How numbers are stored.
struct Scalar {
    char kind = 'f';  // 'i', 'u', 'f': signed, unsigned, real
    std::size_t bytes = 8;
};

/// take(T()) with the type of numbers that are stored so.
template <class Take>
decltype(auto) with_type(Scalar stored, Take take)
{
    switch (stored.kind * 16 + static_cast<int>(stored.bytes)) {
        case 'i' * 16 + 1: return take(std::int8_t());
        case 'i' * 16 + 2: return take(std::int16_t());
        case 'i' * 16 + 4: return take(std::int32_t());
        case 'i' * 16 + 8: return take(std::int64_t());
        case 'u' * 16 + 1: return take(std::uint8_t());
        case 'u' * 16 + 2: return take(std::uint16_t());
        case 'u' * 16 + 4: return take(std::uint32_t());
        case 'u' * 16 + 8: return take(std::uint64_t());
        case 'f' * 16 + 4: return take(float());
        default: return take(double());
    }
}

}  // namespace seldinger
