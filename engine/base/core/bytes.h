#pragma once
// Plain values to and from the bytes of a saved state.

#include "core/check.h"
#include "core/error.h"

#include <cstdint>
#include <cstring>
#include <string>
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

/// Appends what it is called with. The length of a text or a list goes before it.
struct ByteWriter {
    std::vector<std::uint8_t>& bytes;

    template <class T>
    void operator()(const T& value)
    {
        put_bytes(bytes, &value, 1);
    }
    void operator()(const std::string& text)
    {
        (*this)(std::uint64_t{text.size()});
        put_bytes(bytes, text.data(), text.size());
    }
    template <class T>
    void operator()(const std::vector<T>& list)
    {
        (*this)(std::uint64_t{list.size()});
        if constexpr (std::is_trivially_copyable_v<T>) put_bytes(bytes, list.data(), list.size());
        else
            for (const T& item : list) (*this)(item);
    }
};

/// Takes the same back from a file of unknown origin. @throws Error BadFile where it claims more than there is
struct ByteReader {
    const std::uint8_t *at, *end;

    template <class T>
    void operator()(T& value)
    {
        take_bytes(at, end, &value, 1);
    }
    void operator()(bool& flag)
    {
        std::uint8_t byte = 0;
        (*this)(byte);
        if (byte > 1) throw Error(ErrorKind::BadFile, "is corrupt: a value is out of range");
        flag = byte == 1;
    }
    void operator()(std::string& text)
    {
        text.resize(count(1));
        take_bytes(at, end, text.data(), text.size());
    }
    template <class T>
    void operator()(std::vector<T>& list)
    {
        if constexpr (std::is_trivially_copyable_v<T>) {
            list.resize(count(sizeof(T)));
            take_bytes(at, end, list.data(), list.size());
        } else {
            list.clear();
            for (std::size_t left = count(1); left > 0; --left) (*this)(list.emplace_back());
        }
    }
    /// A length: no reason to ask for memory that nothing is there for. @param least  bytes that each takes
    [[nodiscard]] std::size_t count(std::size_t least)
    {
        std::uint64_t n = 0;
        (*this)(n);
        if (n > static_cast<std::uint64_t>(end - at) / least) throw Error(ErrorKind::BadFile, "a list is longer than the file");
        return static_cast<std::size_t>(n);
    }
};

}  // namespace seldinger
