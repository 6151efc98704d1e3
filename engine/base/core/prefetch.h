#pragma once
// Asks for memory that will be needed soon. In a world of many wires each wire's arrays have left the caches before its next
// turn. A wire has too many short arrays for the processor to guess the next one.

#include <cstddef>
#include <vector>

namespace seldinger {

inline void prefetch(const void* memory, std::size_t bytes)
{
    constexpr std::size_t line = 64;
    for (std::size_t at = 0; at < bytes; at += line) __builtin_prefetch(static_cast<const char*>(memory) + at, 0, 2);
}

/// The first `count` numbers.
inline void prefetch(const std::vector<double>& values, int count) { prefetch(values.data(), count * sizeof(double)); }

}  // namespace seldinger
