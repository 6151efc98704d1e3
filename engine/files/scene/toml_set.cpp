// Applies one --set text to a parsed scene: splits the path, parses the value, makes missing tables.
#include "scene/toml_parse.h"

#include "core/error.h"
#include "core/printable.h"
#include "scene/toml_table.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

namespace seldinger {
namespace {

[[noreturn]] void fail_set(const std::string& text, const std::string& message)
{
    throw Error(ErrorKind::BadScene, one_line(fmt::format("--set {}: {}", text, message)));
}

std::vector<std::string> split_path(const std::string& path)
{
    std::vector<std::string> parts(1);
    for (const char c : path) {
        if (c == '.') parts.emplace_back();
        else parts.back() += c;
    }
    return parts;
}

std::string without_blanks(const std::string& text)
{
    const auto begin = text.find_first_not_of(" \t");
    return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::optional<std::size_t> as_index(const std::string& part)
{
    const bool digits = !part.empty() && part.size() < 7 &&
                        std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c); });
    return digits ? std::optional<std::size_t>(std::stoul(part)) : std::nullopt;
}

/// A one-key table {value = ...} whose nodes remember the --set text as their source.
toml::table parse_value(const std::string& text, const std::string& value)
{
    const std::string source = "--set " + text;
    if (value.find_first_of("\r\n") != std::string::npos) fail_set(text, "expected a value on one line");
    if (too_deep(text) != std::string_view::npos)
        fail_set(printable(text, 200), fmt::format("is nested deeper than {} levels; use fewer levels", most_toml_depth));
    try {
        return toml::parse("value = " + value, source);
    } catch (const toml::parse_error& error) {
        // what opens like a list, a table or a quoted text was meant as TOML; anything else is a bare word
        if (value.empty() || std::string("[{\"'").find(value[0]) != std::string::npos)
            fail_set(text, fmt::format("expected a TOML value after '='; {}", error.description()));
    }
    std::string quoted;
    for (const char c : value) {
        if (c == '"' || c == '\\') quoted += '\\';
        quoted += c;
    }
    try {
        return toml::parse("value = \"" + quoted + "\"", source);
    } catch (const toml::parse_error& error) {
        fail_set(text, fmt::format("expected a TOML value after '='; {}", error.description()));
    }
}

// Moving a node keeps its source, copying does not: that is how later messages can name the --set text.
void put(toml::table& table, const std::string& key, toml::table&& parsed)
{
    std::move(*parsed.get("value")).visit([&](auto&& node) { table.insert_or_assign(key, std::forward<decltype(node)>(node)); });
}

void put(toml::array& array, std::size_t index, toml::table&& parsed)
{
    const auto place = [&] { return array.begin() + static_cast<std::ptrdiff_t>(index); };
    if (index < array.size()) array.erase(place());
    std::move(*parsed.get("value")).visit([&](auto&& node) { array.insert(place(), std::forward<decltype(node)>(node)); });
}

/// The node at part `i` below `at`, made (a table, or an array of tables when a number follows) where it is absent.
toml::node& child(toml::node& at, const std::vector<std::string>& parts, std::size_t i, const std::string& text)
{
    const bool array_follows = i + 1 < parts.size() && as_index(parts[i + 1]);
    if (toml::table* table = at.as_table()) {
        if (!table->contains(parts[i])) put(*table, parts[i], parse_value(text, array_follows ? "[]" : "{}"));
        return *table->get(parts[i]);
    }
    toml::array* array = at.as_array();
    const auto index = as_index(parts[i]);
    if (!array || !index)
        fail_set(text, fmt::format("{} is not a table; check the key", fmt::join(parts.begin(), parts.begin() + i, ".")));
    if (*index > array->size())
        fail_set(text, fmt::format("there are only {} of {}; count from 0", array->size(),
                                   fmt::join(parts.begin(), parts.begin() + i, ".")));
    if (*index == array->size()) put(*array, *index, parse_value(text, "{}"));
    return (*array)[*index];
}

}  // namespace

void apply_override(toml::table& root, const std::string& text)
{
    const auto equals = text.find('=');
    if (equals == std::string::npos) fail_set(text, "expected table.key=value");
    const std::vector<std::string> parts = split_path(without_blanks(text.substr(0, equals)));
    if (parts.size() < 2 || std::any_of(parts.begin(), parts.end(), [](const std::string& p) { return p.empty(); }))
        fail_set(text, "expected table.key=value");
    // quotes mean nothing in a path, so that what too_deep() takes for a text may be one
    if (parts.size() > most_toml_depth)
        fail_set(printable(text, 200), fmt::format("is nested deeper than {} levels; use fewer levels", most_toml_depth));
    toml::table parsed = parse_value(text, without_blanks(text.substr(equals + 1)));

    toml::node* at = &root;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) at = &child(*at, parts, i, text);
    const std::string& last = parts.back();
    if (toml::table* table = at->as_table()) return put(*table, last, std::move(parsed));
    toml::array* array = at->as_array();
    const auto index = as_index(last);
    if (!array || !index || *index > array->size())
        fail_set(text, fmt::format("{} has no {}; check the key", fmt::join(parts.begin(), parts.end() - 1, "."), last));
    put(*array, *index, std::move(parsed));
}

}  // namespace seldinger
