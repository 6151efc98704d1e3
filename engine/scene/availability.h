#pragma once
// What the scene contract names and the engine does not have yet: one list, in availability.cpp.

#include <toml++/toml.h>

namespace seldinger {

/// Error BadScene "not available yet" when the scene asks for something on the list.
void refuse_what_is_not_built(const toml::table& root);

}  // namespace seldinger
