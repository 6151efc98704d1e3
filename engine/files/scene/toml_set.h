#pragma once
// --set table.key=value: changes a parsed scene before it is read. Values are TOML; a bare word is a string; absent tables are
// made; a number in the path counts the tables of an array from 0 ("hold.0.spin=true"), one past the end adds a table.

#include <string>

#include <toml++/toml.h>

namespace seldinger {

/// @throws Error BadScene that names the text
void apply_override(toml::table& root, const std::string& text);

}  // namespace seldinger
