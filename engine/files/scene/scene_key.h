#pragma once
// A key of a scene file, declared once: name, unit, value with its range, meaning. scene_keys.h has all of them, bound to the
// members of a Scene. The reader (TableReader::read), the writer (write_scene), the page docs/scene-file.md and the tests go
// through these lists.

#include "scene/scene_names.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace seldinger {

/// Which numbers a key takes, and how a message says so.
struct Range {
    double low, high;
    bool low_open, high_open;
    const char* says;
    [[nodiscard]] bool contains(double v) const { return (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high); }
};
inline constexpr double range_end = 1.7976931348623157e308;
inline constexpr Range any_number{-range_end, range_end, false, false, "a number"};
inline constexpr Range positive{0, range_end, true, false, "a number above 0"};
inline constexpr Range not_negative{0, range_end, false, false, "a number, 0 or above"};
inline constexpr Range friction_range{0, 10, false, false, "a coefficient of friction between 0 and 10"};
inline constexpr Range poisson_range{-1, 0.5, true, true, "a Poisson's ratio above -1 and below 0.5"};

namespace keys {

struct Key;

/// A value that is one of several words.
struct Words {
    std::vector<std::string_view> list;
    std::function<int()> get;  // place in the list; -1: the value is none of them
    std::function<void(int)> set = [](int) {};
};
/// A number, or one of the words: set(-1) tells them that the key is a number.
struct Number {
    double* value;
    Range range;
    Words words = {};
    bool degrees = false;  // in the file; the value is in radians
};
struct Count {
    int* value;
    int least, most;
    Words words = {};
    const char* says = nullptr;  // in messages, where "a whole number from 1 to 9" does not say enough
    std::string* text = nullptr;  // a text in quotes is taken, too; then the value is 0
};
/// So many numbers in brackets.
struct Numbers {
    std::vector<double*> values;
    const char* form;  // in messages: "[x, y, z]"
    Range range = any_number;
    bool nonzero = false;  // not all of them 0: a direction
};
/// `least` rows or more of numbers, each as `form` says.
struct Rows {
    std::size_t least, width;
    const char* form;
    std::function<std::vector<std::vector<double>>()> get;
    std::function<void(const std::vector<std::vector<double>>&)> set;
};
/// Tables { key = value, ... } within this one, read by code of their own. Not a list: one at most.
struct Tables {
    std::vector<std::vector<Key>> tables;
    bool list;
};
/// Read by separate code. @see range  as docs/scene-file.md says it
struct Special {
    const char* range;
    std::string text = {};  // as it is written; empty: not at all
};
using Value = std::variant<Number, Count, std::int64_t*, bool*, std::string*, std::filesystem::path*, Numbers, Rows, Words,
                           Tables, Special>;

/// Quiet: left out of a written scene. Unused: that, and an error in a scene that is read (TableReader::refuse_unused).
enum class Use { Written, Quiet, Unused };
[[nodiscard]] constexpr Use quiet_if(bool quiet) { return quiet ? Use::Quiet : Use::Written; }
[[nodiscard]] constexpr Use only_if(bool used) { return used ? Use::Written : Use::Unused; }

struct Key {
    std::string_view name, unit;
    Value value;
    std::string_view meaning;      // Markdown; a message cites it up to the first ";" or "."
    // in the page's column "default", where that is not the value of the member; `needed`: an error
    std::string_view absent = {};
    Use use = Use::Written;
};
inline constexpr std::string_view needed = "*needed*", none = "*none*";

/// The value as TOML; empty: the key is not written. @param folder  from which paths are seen
[[nodiscard]] std::string text_of(const Key& key, const std::filesystem::path& folder);

[[nodiscard]] inline Value number(double& value, const Range& range) { return Number{&value, range}; }
[[nodiscard]] inline Value number(double& value, const Range& range, Words words)
{
    return Number{&value, range, std::move(words)};
}
[[nodiscard]] inline Value degrees(double& value, const Range& range) { return Number{&value, range, {}, true}; }
[[nodiscard]] inline Value count(int& value, int least, int most, Words words = {}, const char* says = nullptr)
{
    return Count{&value, least, most, std::move(words), says};
}
[[nodiscard]] inline Value pair(double& a, double& b, const char* form) { return Numbers{{&a, &b}, form}; }
[[nodiscard]] inline Value vector(Vec3& v, const Range& range = any_number)
{
    return Numbers{{&v[0], &v[1], &v[2]}, "three numbers [x, y, z]", range};
}
[[nodiscard]] inline Value direction(Vec3& v)
{
    return Numbers{{&v[0], &v[1], &v[2]}, "a direction [x, y, z] of any length but zero", any_number, true};
}

template <class Enum, std::size_t N>
[[nodiscard]] Words words(Enum& value, const Choice<Enum> (&choices)[N])
{
    Words result;
    for (const auto& choice : choices) result.list.push_back(choice.word);
    result.get = [&value, &choices] {
        for (std::size_t i = 0; i < N; ++i)
            if (choices[i].value == value) return static_cast<int>(i);
        return -1;
    };
    result.set = [&value, &choices](int i) { value = choices[i].value; };
    return result;
}
[[nodiscard]] Words words(std::string& value, std::span<const std::string_view> list);

/// Rows of `Row`: an array of numbers, or a Vec3.
template <std::size_t N, class Row>
[[nodiscard]] Value rows(std::vector<Row>& value, std::size_t least, const char* form)
{
    return Rows{least, N, form,
                [&value] {
                    std::vector<std::vector<double>> table;
                    for (const Row& row : value) table.emplace_back(row.begin(), row.end());
                    return table;
                },
                [&value](const auto& table) {
                    value.clear();
                    for (const auto& row : table)
                        for (std::size_t i = 0; i < N; ++i) (i == 0 ? value.emplace_back() : value.back())[i] = row[i];
                }};
}

/// Tables of their own, one for each row. @param of  the keys of a row
template <class Row, class Of>
[[nodiscard]] Value list_of(std::vector<Row>& rows, Of of)
{
    Tables list{{}, true};
    for (Row& row : rows) list.tables.push_back(of(row));
    return list;
}

}  // namespace keys

using keys::Key;

}  // namespace seldinger
