#pragma once
// Messages without the value that they got, for tests that try many values of a key.

#include <regex>
#include <string>

namespace seldinger::test {

/// "key: got X; expected Y" as "key: expected Y".
inline std::string without_got(const std::string& message)
{
    static const std::regex got("got .*?; expected");
    return std::regex_replace(message, got, "expected");
}

/// Whether a message says it, its value left out or not.
inline bool says(const std::string& message, const std::string& part)
{
    return message.find(part) != std::string::npos || without_got(message).find(part) != std::string::npos;
}

}  // namespace seldinger::test
