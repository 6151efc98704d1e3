// A Scene as TOML. Doubles are printed as the shortest text that reads back to the same bits.
#include "scene/scene_keys.h"
#include "scene/toml_parse.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace seldinger {
namespace {

std::string toml_numbers(const std::vector<double>& row)
{
    std::vector<std::string> numbers;
    for (const double v : row) numbers.push_back(toml_number(v));
    return fmt::format("[{}]", fmt::join(numbers, ", "));
}

/// Degrees that read back to exactly `radians`: the quotient is right to an ulp or two, so its neighbours are tried.
double to_degrees(double radians)
{
    double low = radians * 180 / std::numbers::pi, high = low;
    for (int i = 0; i < 8; ++i) {
        for (const double v : {low, high})
            if (v * std::numbers::pi / 180 == radians) return v;
        low = std::nextafter(low, 0.0);
        high = std::nextafter(high, std::numeric_limits<double>::infinity());
    }
    return radians * 180 / std::numbers::pi;
}

/// A path as seen from `folder`.
std::string rebased(const std::filesystem::path& path, const std::filesystem::path& folder)
{
    std::error_code error;
    const auto from = std::filesystem::weakly_canonical(std::filesystem::absolute(folder, error), error);
    const auto to = std::filesystem::weakly_canonical(path, error);
    const auto relative = error ? std::filesystem::path() : to.lexically_relative(from);
    return (relative.empty() ? path : relative).generic_string();
}

std::string inline_table(const std::vector<Key>& keys, const std::filesystem::path& folder)
{
    std::vector<std::string> entries;
    for (const Key& key : keys)
        if (const std::string text = keys::text_of(key, folder); !text.empty())
            entries.push_back(fmt::format("{} = {}", key.name, text));
    return fmt::format("{{ {} }}", fmt::join(entries, ", "));
}

/// Each kind of value as text.
struct ValueText {
    const std::filesystem::path& folder;

    std::string operator()(const keys::Words& w) const
    {
        const int i = w.get ? w.get() : -1;
        return i < 0 ? "" : toml_quoted(w.list[static_cast<std::size_t>(i)]);
    }
    std::string operator()(const keys::Number& n) const
    {
        const std::string word = (*this)(n.words);
        return word.empty() ? toml_number(n.degrees ? to_degrees(*n.value) : *n.value) : word;
    }
    std::string operator()(const keys::Count& c) const
    {
        const std::string word = c.text && *c.value == 0 ? (*this)(c.text) : (*this)(c.words);
        return word.empty() ? fmt::format("{}", *c.value) : word;
    }
    std::string operator()(const std::int64_t* v) const { return fmt::format("{}", *v); }
    std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
    std::string operator()(const std::string* v) const { return v->empty() ? "" : toml_quoted(*v); }
    std::string operator()(const std::filesystem::path* v) const { return v->empty() ? "" : toml_quoted(rebased(*v, folder)); }
    std::string operator()(const keys::Numbers& n) const
    {
        std::vector<double> row;
        for (const double* v : n.values) row.push_back(*v);
        return toml_numbers(row);
    }
    std::string operator()(const keys::Rows& r) const
    {
        std::vector<std::string> rows;
        for (const auto& row : r.get()) rows.push_back(toml_numbers(row));
        return rows.empty() ? "" : fmt::format("[{}]", fmt::join(rows, ", "));
    }
    std::string operator()(const keys::Tables& t) const
    {
        if (!t.list) return inline_table(t.tables.front(), folder);
        std::string lines;
        for (const auto& table : t.tables) lines += fmt::format("    {},\n", inline_table(table, folder));
        return lines.empty() ? "" : fmt::format("[\n{}]", lines);
    }
    std::string operator()(const keys::Special& s) const { return s.text; }
};

}  // namespace

std::string keys::text_of(const Key& key, const std::filesystem::path& folder)
{
    return key.use == Use::Written ? std::visit(ValueText{folder}, key.value) : "";
}

std::string write_scene(const Scene& scene, const std::filesystem::path& folder)
{
    Scene own = scene;  // keys are bound to members that a reader can fill
    std::string out;
    for (const keys::Table& table : keys::tables(own)) {
        out += fmt::format("{}{}\n", out.empty() ? "" : "\n", table.header);
        for (const Key& key : table.keys)
            if (const std::string text = keys::text_of(key, folder); !text.empty())
                out += fmt::format("{} = {}\n", key.name, text);
    }
    return out;
}

}  // namespace seldinger
