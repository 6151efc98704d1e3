#pragma once
// Converts numbers of files from one type to another without undefined values.

#include <concepts>

namespace seldinger {

/// As static_cast, but a real number that no index can be (beyond 2^53, or none at all) becomes -1, which readers refuse as one.
template <class Wanted, class Stored>
[[nodiscard]] Wanted safe_cast(Stored value)
{
    if constexpr (std::integral<Wanted> && std::floating_point<Stored>) {
        if (!(value > Stored(-9007199254740992.0) && value < Stored(9007199254740992.0))) return Wanted(-1);
    }
    return static_cast<Wanted>(value);
}

}  // namespace seldinger
