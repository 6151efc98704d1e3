#pragma once
// Plain values to and from the bytes of a saved state.

#include "core/check.h"
#include "core/error.h"

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace seldinger {

/// Whether every byte of a T belongs to a member. Nobody sets the padding between members: the bytes of two equal states would
/// differ, and foreign memory would get into the file.
template <class T>
bool is_without_gaps()
{
#if defined(__has_builtin)
    #if __has_builtin(__builtin_clear_padding)  // g++
    alignas(T) unsigned char bytes[sizeof(T)];
    std::memset(bytes, 0xff, sizeof bytes);
    __builtin_clear_padding(reinterpret_cast<T*>(bytes));
    for (const unsigned char byte : bytes)
        if (byte != 0xff) return false;
    #endif
#endif
    return true;
}

template <class T>
void put_bytes(std::vector<std::uint8_t>& bytes, const T* data, std::size_t count)
{
    static_assert(std::is_trivially_copyable_v<T>);
    static const bool without_gaps = is_without_gaps<T>();
    SEL_ASSERT(without_gaps);
    const auto* first = reinterpret_cast<const std::uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + count * sizeof(T));
}

/// @throws Error BadFile when fewer bytes are left
template <class T>
void take_bytes(const std::uint8_t*& bytes, const std::uint8_t* end, T* data, std::size_t count)
{
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t size = count * sizeof(T);
    if (static_cast<std::size_t>(end - bytes) < size)
        throw Error(ErrorKind::BadFile,
                    "the saved state is shorter than this scene's; it was written by another scene or version");
    if (size > 0) std::memcpy(data, bytes, size);
    bytes += size;
}

}  // namespace seldinger
