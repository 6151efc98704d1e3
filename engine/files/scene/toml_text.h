#pragma once
// Writes text as a TOML file has it: in quotes, with escapes.

#include <string>
#include <string_view>

namespace seldinger {

/// A basic string of TOML with its quotes; what a basic string may not hold (quotes, backslashes, control characters) is escaped.
[[nodiscard]] std::string toml_quoted(std::string_view text);

}  // namespace seldinger
