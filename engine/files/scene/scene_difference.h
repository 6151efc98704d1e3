#pragma once
// First difference of two scenes, as write_scene writes them.

#include <string>
#include <string_view>

namespace seldinger {

/// The first difference for an error line, e.g. `[contact] friction is "sign" there and "stick-slip" here`; empty: none.
[[nodiscard]] std::string first_difference(std::string_view there, std::string_view here);

}  // namespace seldinger
