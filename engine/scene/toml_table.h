#pragma once
// Reads one table of a scene file, key by key, and turns every mistake into one line with place, expected value and fix. Knows TOML
// and messages, nothing of wires.

#include "rod/wire_spec.h"
#include "scene/scene_names.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

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

/// The largest size of a number under a key, by the unit in its name: lengths and places 1e4 m, times 1e9 s, angles 1e9, gravity
/// 1e6 m/s^2. Speeds have no limit, any other number 1e18 in its unit. Beyond that nothing can be computed, and an index would
/// overflow.
[[nodiscard]] double largest(std::string_view key);

/// The smallest size of a number that has to be above 0, times apart: powers of smaller ones are 0 in a double.
inline constexpr double smallest = 1e-30;

/// Number of edits (insert, delete, replace, swap of neighbours) between two words.
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);
/// A longer key is compared by its beginning: no known key is as long, and the edit distance takes a time of the product of both
/// lengths.
inline constexpr std::size_t longest_word = 64;
/// The word of `known` with the fewest edits from `word`.
[[nodiscard]] std::string nearest_word(std::string_view word, std::span<const std::string_view> known);

/// "file:line:column: key: message" as an Error(BadScene); for a node that came from --set, "--set text: key: message".
[[noreturn]] void fail_at(const toml::source_region& where, std::string_view key, std::string_view message);

class TableReader {
public:
    /// @param known  every key that the table may have; any other is an error here and now
    TableReader(const toml::table& table, std::string path, std::span<const std::string_view> known);
    TableReader(const toml::table& table, std::string path, std::initializer_list<std::string_view> known)
        : TableReader(table, std::move(path), std::span(known.begin(), known.size()))
    {
    }

    [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
    [[nodiscard]] const toml::table& table() const { return table_; }
    [[nodiscard]] const toml::node* node(std::string_view key) const { return table_.get(key); }

    // Each leaves `value` as it is (the default) when the key is absent, and @returns whether it was there.
    bool number(std::string_view key, double& value, const Range& range) const;
    bool count(std::string_view key, int& value, int least, int most) const;
    bool whole(std::string_view key, std::int64_t& value) const;
    bool flag(std::string_view key, bool& value) const;
    bool text(std::string_view key, std::string& value) const;
    bool vector(std::string_view key, Vec3& value) const;
    bool direction(std::string_view key, Vec3& value) const;  // any length but zero
    /// Rows of `width` numbers, e.g. [[t, dx, dy, dz], ...]; at least `least` of them.
    bool rows(std::string_view key, std::vector<std::vector<double>>& value, std::size_t width, std::size_t least,
              std::string_view form) const;

    template <class Enum, std::size_t N>
    bool choice(std::string_view key, Enum& value, const Choice<Enum> (&words)[N]) const
    {
        std::string_view list[N];
        for (std::size_t i = 0; i < N; ++i) list[i] = words[i].word;
        const int index = word_index(key, list);
        if (index >= 0) value = words[index].value;
        return index >= 0;
    }
    /// Index in `words` of the key's value; -1 when absent.
    [[nodiscard]] int word_index(std::string_view key, std::span<const std::string_view> words) const;

    /// Error when the key is absent; `why` says when it is needed.
    void need(std::string_view key, std::string_view why = {}) const;
    /// Error when the key is there; `why` names the contradiction.
    void refuse(std::string_view key, std::string_view why) const;
    /// Error at the key's value, or at the table when the key is absent.
    [[noreturn]] void fail(std::string_view key, std::string_view message) const;

private:
    [[nodiscard]] double checked(const toml::node& node, std::string_view key, const Range& range) const;
    [[nodiscard]] std::string full(std::string_view key) const;
    [[noreturn]] void wrong(const toml::node& node, std::string_view key, std::string_view expected) const;
    const toml::table& table_;
    std::string path_;
};

}  // namespace seldinger
