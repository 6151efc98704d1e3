#pragma once
// TOML of files and of --set may be hostile. Size and depth are checked before the parser (toml++ 3.3), which has no limits of
// its own.

#include "core/folder.h"

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace seldinger {

/// How deep brackets may stand in brackets, and how many parts a dotted key may have. A scene has five and two.
inline constexpr int most_toml_depth = 32;

/// The fix for paths that were written as on Windows.
inline constexpr const char* backslash_advice =
    "in double quotes a backslash begins an escape: write paths with /, or in single quotes";

/// Where `text` is nested deeper, as a byte; npos where it is not.
[[nodiscard]] std::size_t too_deep(std::string_view text);

/// @throws Error BadScene where it is not TOML, or nested too deep
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::filesystem::path& file);

/// The text of a scene or a sweep. @throws Error BadFile: unreadable, no plain file, or above 16 MB
[[nodiscard]] std::string read_scene_file(const FilePlace& file);

/// A basic string of TOML with its quotes; what a basic string may not hold (quotes, backslashes, control characters) is escaped.
[[nodiscard]] std::string toml_quoted(std::string_view text);
/// The shortest text that reads back to the same bits.
[[nodiscard]] std::string toml_number(double value);

/// --set table.key=value: changes a parsed scene before it is read. Values are TOML; a bare word is a string; absent tables are
/// made; a number in the path counts the tables of an array from 0 ("hold.0.spin=true"), one past the end adds a table.
/// @throws Error BadScene that names the text
void apply_override(toml::table& root, const std::string& text);

}  // namespace seldinger
