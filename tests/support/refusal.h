#pragma once
// What a call is refused with, and whether a message says it.

#include "core/error.h"

#include <doctest/doctest.h>

#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace seldinger::test {

/// The one line of the Error that the call throws; "" where it throws none.
/// @param kind  that the error then has
template <class Call>
std::string refusal(const Call& call, std::optional<ErrorKind> kind = {})
{
    try {
        (void)call();
    } catch (const Error& error) {
        const std::string text = error.what();
        CAPTURE(text);
        if (kind) CHECK(error.kind() == *kind);
        CHECK(text.find('\n') == std::string::npos);
        return text;
    }
    return "";
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// "key: got X; expected Y" as "key: expected Y".
inline std::string without_got(const std::string& message)
{
    static const std::regex got("got .*?; expected");
    return std::regex_replace(message, got, "expected");
}

/// Whether a message says it, its value left out or not.
inline bool says(const std::string& message, const std::string& part)
{
    return has(message, part) || has(without_got(message), part);
}

/// Checks that the call is refused in one line that says all of this.
template <class Call>
void check_refused(const Call& call, const std::vector<std::string>& parts, std::optional<ErrorKind> kind = {})
{
    const std::string message = refusal(call, kind);
    CHECK_FALSE(message.empty());
    for (const std::string& part : parts) CHECK_MESSAGE(says(message, part), message << "\n  has not: " << part);
}

}  // namespace seldinger::test
