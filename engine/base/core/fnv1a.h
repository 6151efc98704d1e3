#pragma once
// 64-bit FNV-1a: the checksum of checkpoints. Not a cryptographic hash; it finds torn and damaged files.
// [Fowler-Noll-Vo, IETF draft-eastlake-fnv]

#include <cstddef>
#include <cstdint>

namespace seldinger {

constexpr std::uint64_t fnv1a_start = 14695981039346656037ull;

/// Continues `hash` over `size` bytes.
[[nodiscard]] inline std::uint64_t fnv1a(const void* bytes, std::size_t size, std::uint64_t hash = fnv1a_start)
{
    const auto* p = static_cast<const unsigned char*>(bytes);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ p[i]) * 1099511628211ull;
    return hash;
}

}  // namespace seldinger
