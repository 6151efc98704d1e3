#pragma once
// Reads one table of a scene file by the list of its keys, and turns every mistake into one line with place, expected value and
// fix. Knows TOML and messages, nothing of wires.

#include "scene/scene_key.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

namespace seldinger {

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
    TableReader(const toml::table& table, std::string path, const std::vector<Key>& known);

    [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
    [[nodiscard]] const toml::table& table() const { return table_; }
    [[nodiscard]] const toml::node* node(std::string_view key) const { return table_.get(key); }

    /// Reads all keys but those with Tables and Special. An absent key leaves its member as it is; a required one is an error.
    /// @param scene_file  where relative paths start, unless they come from an included file
    void read(const std::vector<Key>& keys, const std::filesystem::path& scene_file = {}) const;
    /// Error when a key is there that is not used; `why` names the contradiction.
    void refuse_unused(const std::vector<Key>& keys, std::string_view why) const;

    // Each leaves `value` as it is (the default) when the key is absent, and @returns whether it was there.
    bool number(std::string_view key, double& value, const Range& range) const;
    bool count(std::string_view key, int& value, int least, int most) const;
    bool flag(std::string_view key, bool& value) const;
    bool text(std::string_view key, std::string& value) const;
    /// Index in `words` of the key's value; -1 when absent.
    [[nodiscard]] int word_index(std::string_view key, std::span<const std::string_view> words) const;

    /// Error when the key is absent; `why` says when it is needed.
    void need(std::string_view key, std::string_view why = {}) const;
    /// Error when the key is there; `why` names the contradiction.
    void refuse(std::string_view key, std::string_view why) const;
    /// Error at the key's value, or at the table when the key is absent.
    [[noreturn]] void fail(std::string_view key, std::string_view message) const;

private:
    // one kind of value each, of a key that is there
    void take(std::string_view key, const keys::Number& n) const;
    void take(std::string_view key, const keys::Count& c) const;
    void take(std::string_view key, std::int64_t* value) const;
    void take(std::string_view key, bool* value) const { flag(key, *value); }
    void take(std::string_view key, std::string* value) const { text(key, *value); }
    void take(std::string_view key, const keys::Numbers& n) const;
    void take(std::string_view key, const keys::Rows& r) const;
    void take(std::string_view key, const keys::Words& w) const { w.set(word_index(key, w.list)); }
    bool take_word(std::string_view key, const keys::Words& words, std::string_view otherwise) const;
    void take_file(std::string_view key, std::filesystem::path& value, const std::filesystem::path& scene_file) const;
    [[nodiscard]] double checked(const toml::node& node, std::string_view key, const Range& range) const;
    [[nodiscard]] std::string full(std::string_view key) const;
    [[noreturn]] void wrong(const toml::node& node, std::string_view key, std::string_view expected) const;
    const toml::table& table_;
    std::string path_;
};

}  // namespace seldinger
