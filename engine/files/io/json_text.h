#pragma once
// JSON as text: for every value that a file or the screen gets.

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace seldinger {

/// Names of files and folders may be any bytes: those that are no UTF-8 become U+FFFD instead of an exception.
/// @param indent  spaces for each level; below 0: one line
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1)
{
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace seldinger
