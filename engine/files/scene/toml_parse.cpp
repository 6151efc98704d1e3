// Scans for depth, outside of texts and comments, then parses.
#include "scene/toml_parse.h"

#include "core/error.h"
#include "core/file_io.h"
#include "scene/toml_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

constexpr std::uint64_t most_scene_bytes = 16u << 20;

/// Behind the text that opens at `at`; the end of a line, or of all, ends one that is not closed.
std::size_t behind_text(std::string_view text, std::size_t at)
{
    const char quote = text[at];
    const std::string three(3, quote);
    const bool many = text.substr(at, 3) == three;
    for (std::size_t k = at + (many ? 3 : 1); k < text.size(); ++k) {
        if (quote == '"' && text[k] == '\\') ++k;
        else if (many && text.substr(k, 3) == three) return k + 3;
        else if (!many && (text[k] == quote || text[k] == '\n')) return k + 1;
    }
    return text.size();
}

/// Editors of Windows write it under the name "Unicode".
void refuse_utf16(std::string_view text, const std::string& name)
{
    const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
    const bool ascii_in_pairs = text.size() > 1 && ((text[0] == '\0') != (text[1] == '\0'));
    if (marked || ascii_in_pairs)
        throw Error(ErrorKind::BadScene,
                    name + ": got text in UTF-16; expected UTF-8. Fix: save the file again with the encoding UTF-8");
}

}  // namespace

std::size_t too_deep(std::string_view text)
{
    int brackets = 0, dots = 0;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (c == '"' || c == '\'') at = behind_text(text, at) - 1;
        else if (c == '#') at = std::min(text.find('\n', at), text.size()) - 1;
        else if (c == '.') ++dots;
        else if (c == '[' || c == '{') ++brackets, dots = 0;
        else if (c == ']' || c == '}') brackets = std::max(0, brackets - 1), dots = 0;
        else if (c == '\n' || c == ',' || c == '=') dots = 0;
        if (brackets > most_toml_depth || dots > most_toml_depth) return at;
    }
    return std::string_view::npos;
}

toml::table parse_toml(const std::string& text, const std::filesystem::path& file)
{
    const std::string name = file.string();
    refuse_utf16(text, name);
    if (const std::size_t deep = too_deep(text); deep != std::string_view::npos) {
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(deep), '\n');
        toml::source_region where;
        where.path = std::make_shared<const std::string>(name);
        where.begin = {static_cast<toml::source_index>(line), 1};
        fail_at(where, "", fmt::format("is nested deeper than {} levels; use fewer levels", most_toml_depth));
    }
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        const bool is_escape = error.description().find("escape") != std::string_view::npos;
        fail_at(error.source(), "",
                fmt::format("is not TOML: {}; {}", error.description(), is_escape ? backslash_advice : "fix the syntax"));
    }
}

std::string read_scene_file(const FilePlace& file) { return read_file(file, most_scene_bytes); }

std::string toml_number(double value)
{
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";  // 1 -> 1.0, so that it looks like what it is
    return text;
}

std::string toml_quoted(std::string_view text)
{
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\', out += c;
        else if (static_cast<unsigned char>(c) < 32 || c == 127) out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
        else out += c;
    }
    return out + '"';
}

}  // namespace seldinger
