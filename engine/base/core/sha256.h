#pragma once
// SHA-256 [FIPS 180-4, sec. 6.2], by which a Content-Security-Policy names a script.

#include <array>
#include <cstdint>
#include <string_view>

namespace seldinger {

[[nodiscard]] std::array<std::uint8_t, 32> sha256(std::string_view text);

}  // namespace seldinger
