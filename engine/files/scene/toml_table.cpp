// Typed look-ups in a TOML table with the message of every mistake, and the nearest known word to a mistyped key.
#include "scene/toml_table.h"

#include "core/error.h"
#include "core/printable.h"
#include "scene/toml_parse.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

namespace seldinger {
namespace {

/// A value as the user wrote it, short enough for one line.
std::string shown(const toml::node& node)
{
    if (node.is_table()) return "a table";
    if (node.is_array_of_tables()) return "tables";
    std::ostringstream out;
    node.visit([&](const auto& value) { out << value; });
    std::string text = one_line(out.str());
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    return text;
}

/// What people call things, and which key that is. Said where the key's words begin with it, if the table has one of the keys.
struct Synonym {
    std::string_view said;
    std::initializer_list<std::string_view> keys;
    std::string_view hint;
};
const Synonym synonyms[] = {
    {"diameter", {"radius_m"}, "half of the diameter, in metres"},
    {"thickness", {"thickness_m", "radius_m"}, "in metres"},
    {"thick", {"thickness_m", "radius_m"}, "in metres"},
    {"gauge", {"radius_m"}, "in metres"},
    {"french", {"radius_m"}, "in metres: French/6000"},
    {"outer", {"radius_m"}, "in metres"},
    {"inner", {"lumen_radius_m"}, "in metres"},
    {"bore", {"lumen_radius_m"}, "in metres"},
    {"speed", {"keys", "speed_m_s", "velocity_m_s"}, "metres over seconds, between key frames"},
    {"velocity", {"velocity_m_s", "keys"}, "metres over seconds, between key frames"},
    {"advance", {"keys"}, "advance_m of a key frame"},
    {"push", {"keys"}, "advance_m of a key frame"},
    {"insertion", {"keys"}, "advance_m of a key frame"},
    {"rotation", {"keys", "twist_rad"}, "turn_rad of a key frame"},
    {"turn", {"keys"}, "turn_rad of a key frame"},
    {"torque", {"keys", "moment_nm"}, ""},
    {"friction", {"mu_static", "friction"}, "and mu_sliding"},
    {"mu", {"mu_static"}, "or mu_sliding"},
    {"modulus", {"youngs_pa"}, "in pascals"},
    {"young", {"youngs_pa"}, "in pascals"},
    {"elasticity", {"youngs_pa"}, "in pascals"},
    {"e", {"youngs_pa"}, "in pascals"},
    {"stiffness", {"stiffness", "bend_nm2", "youngs_pa"}, ""},
    {"bending", {"bend_nm2"}, "EI in N m2"},
    {"ei", {"bend_nm2"}, "EI in N m2"},
    {"gj", {"twist_nm2"}, "GJ in N m2"},
    {"torsion", {"twist_nm2"}, "GJ in N m2"},
    {"ea", {"stretch_n"}, "EA in N"},
    {"mass", {"density"}, "kg/m3"},
    {"weight", {"density", "gravity"}, ""},
    {"rho", {"density"}, "kg/m3"},
    {"nu", {"poisson"}, ""},
    {"time", {"duration_s", "t_s"}, "in seconds"},
    {"end", {"duration_s"}, "in seconds"},
    {"duration", {"duration_s"}, "in seconds"},
    {"timestep", {"dt_s"}, "in seconds"},
    {"step", {"dt_s"}, "in seconds"},
    {"file", {"mesh"}, ""},
    {"path", {"mesh"}, ""},
    {"stl", {"mesh"}, ""},
    {"unit", {"units"}, ""},
    {"entry", {"inlet", "point"}, ""},
    {"opening", {"inlet"}, ""},
    {"position", {"point", "at", "base"}, "in metres"},
    {"segments", {"nodes"}, ""},
    {"elements", {"nodes"}, ""},
    {"tip", {"section"}, "a stretch of the wire from its tip"},
    {"model", {"preset"}, ""},
    {"name", {"preset"}, "an instrument of the catalogue"},
};

/// "Diameter_in" begins with "diameter", "step_ms" with "step", "wire_diameter" has it after a line.
bool has_word(std::string_view key, std::string_view word)
{
    for (std::size_t at = key.find(word); at != std::string_view::npos; at = key.find(word, at + 1)) {
        const bool begins = at == 0 || key[at - 1] == '_' || key[at - 1] == '-';
        const std::size_t end = at + word.size();
        if (begins && (end == key.size() || key[end] == '_' || key[end] == '-' || (word.size() > 3 && key[end] == 's')))
            return true;
    }
    return false;
}

/// Which key was meant: a mistyped one, else one of that meaning, else whatever looks most like it.
std::string meant_key(std::string_view given, std::span<const std::string_view> known, std::string& hint)
{
    std::string key(given.substr(0, longest_word));
    std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
    std::string alike = nearest_word(key, known);
    // one or two slips, or another unit behind the same word
    const bool mistyped = edit_distance(key, alike) <= (key.size() > 5 ? 2 : 1);
    const std::string stem = key.substr(0, key.rfind('_'));
    if (mistyped) return alike;
    for (const std::string_view candidate : known)
        if (candidate.substr(0, candidate.rfind('_')) == stem) return std::string(candidate);
    for (const Synonym& synonym : synonyms) {
        if (!has_word(key, synonym.said)) continue;
        for (const std::string_view meant : synonym.keys)
            if (std::find(known.begin(), known.end(), meant) != known.end()) {
                if (!synonym.hint.empty()) hint = fmt::format(" ({})", synonym.hint);
                return std::string(meant);
            }
    }
    return alike;
}

std::vector<std::string_view> names_of(const std::vector<Key>& keys)
{
    std::vector<std::string_view> names;
    for (const Key& key : keys) names.push_back(key.name);
    return names;
}

}  // namespace

keys::Words keys::words(std::string& value, std::span<const std::string_view> list)
{
    return {{list.begin(), list.end()},
            [&value, list] {
                const auto at = std::find(list.begin(), list.end(), value);
                return at == list.end() ? -1 : static_cast<int>(at - list.begin());
            },
            [&value, list](int i) { value = list[static_cast<std::size_t>(i)]; }};
}

double largest(std::string_view key)
{
    const auto is_in = [&](std::string_view unit) { return key.ends_with(unit); };
    if (is_in("_m_s")) return range_end;  // a step finds that itself
    for (const std::string_view compound : {"_1_m", "_n_m", "_pa_m", "_1_s", "_rad_s"})
        if (is_in(compound)) return 1e18;
    if (is_in("_m")) return 1e4;
    if (is_in("_s")) return 1e9;
    if (is_in("_rad") || is_in("_deg")) return 1e9;
    if (key == "gravity") return 1e6;
    for (const std::string_view place : {"point", "at", "anchor", "isocentre", "inflow", "base", "tip"})
        if (key == place) return 1e4;
    return 1e18;
}

int edit_distance(std::string_view a, std::string_view b)
{
    // optimal string alignment [Damerau64], two rows back for swaps
    const std::size_t n = b.size();
    std::vector<int> before(n + 1), last(n + 1), row(n + 1);
    for (std::size_t j = 0; j <= n; ++j) last[j] = static_cast<int>(j);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = static_cast<int>(i);
        for (std::size_t j = 1; j <= n; ++j) {
            const int replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({replace, last[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[n];
}

std::string nearest_word(std::string_view word, std::span<const std::string_view> known)
{
    word = word.substr(0, longest_word);
    std::string_view best;
    int best_distance = std::numeric_limits<int>::max();
    for (const std::string_view candidate : known) {
        const int distance = edit_distance(word, candidate);
        if (distance < best_distance) best = candidate, best_distance = distance;
    }
    return std::string(best);
}

void fail_at(const toml::source_region& where, std::string_view key, std::string_view message)
{
    const std::string path = where.path ? *where.path : std::string("scene");
    const bool from_command_line = path.starts_with("--set ");
    const std::string place =
        from_command_line ? path
                          : fmt::format("{}:{}:{}", path, std::max(1u, where.begin.line), std::max(1u, where.begin.column));
    throw Error(ErrorKind::BadScene,
                one_line(key.empty() ? fmt::format("{}: {}", place, message) : fmt::format("{}: {}: {}", place, key, message)));
}

TableReader::TableReader(const toml::table& table, std::string path, std::span<const std::string_view> words)
    : table_(table), path_(std::move(path))
{
    for (const auto& [key, value] : table_) {
        if (std::find(words.begin(), words.end(), key.str()) != words.end()) continue;
        // the key's own place, unless --set made it
        const bool set = value.source().path && value.source().path->starts_with("--set ");
        std::string hint;
        const std::string meant = meant_key(key.str(), words, hint);
        fail_at(set ? value.source() : key.source(), full(key.str()),
                fmt::format("unknown key; the nearest known one is {}{}", full(meant), hint));
    }
}

TableReader::TableReader(const toml::table& table, std::string path, const std::vector<Key>& known)
    : TableReader(table, std::move(path), names_of(known))
{
}

std::string TableReader::full(std::string_view key) const
{
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

void TableReader::fail(std::string_view key, std::string_view message) const
{
    const toml::node* at = node(key);
    fail_at(at ? at->source() : table_.source(), full(key), message);
}

void TableReader::wrong(const toml::node& at, std::string_view key, std::string_view expected) const
{
    fail_at(at.source(), full(key), fmt::format("got {}; expected {}", shown(at), expected));
}

double TableReader::checked(const toml::node& at, std::string_view key, const Range& range) const
{
    if (!at.is_number()) wrong(at, key, range.says);
    const double value = at.value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
    if (!std::isfinite(value) || !range.contains(value)) wrong(at, key, range.says);
    if (range.low == 0 && range.low_open && value < smallest && !key.ends_with("_s"))
        wrong(at, key, fmt::format("{}, at least {:g}", range.says, smallest));
    if (const double most = largest(key); std::abs(value) > most)
        wrong(at, key, fmt::format("{}, at most {:g}", range.says, most));
    return value;
}

bool TableReader::number(std::string_view key, double& value, const Range& range) const
{
    const toml::node* at = node(key);
    if (at) value = checked(*at, key, range);
    return at != nullptr;
}

bool TableReader::count(std::string_view key, int& value, int least, int most) const
{
    const toml::node* at = node(key);
    if (!at) return false;
    const auto given = at->is_integer() ? at->value<std::int64_t>() : std::nullopt;
    if (!given || *given < least || *given > most) wrong(*at, key, fmt::format("a whole number from {} to {}", least, most));
    value = static_cast<int>(*given);
    return true;
}

bool TableReader::flag(std::string_view key, bool& value) const
{
    const toml::node* at = node(key);
    if (!at) return false;
    if (!at->is_boolean()) wrong(*at, key, "true or false");
    value = *at->value<bool>();
    return true;
}

bool TableReader::text(std::string_view key, std::string& value) const
{
    const toml::node* at = node(key);
    if (!at) return false;
    if (!at->is_string() || at->value<std::string>()->empty()) wrong(*at, key, "a text in quotes");
    value = *at->value<std::string>();
    // as a file's name it would end there
    if (value.find('\0') != std::string::npos) wrong(*at, key, "a text without \\u0000");
    return true;
}

void TableReader::take(std::string_view key, const keys::Number& n) const
{
    if (take_word(key, n.words, n.range.says)) return;
    number(key, *n.value, n.range);
    if (n.degrees) *n.value = *n.value * std::numbers::pi / 180;
}

void TableReader::take(std::string_view key, const keys::Count& c) const
{
    const std::string says = c.says ? c.says : fmt::format("a whole number from {} to {}", c.least, c.most);
    const toml::node& at = *node(key);
    if (c.text && at.is_string()) {
        *c.value = 0;
        text(key, *c.text);
        return;
    }
    if (c.text && !at.is_integer()) wrong(at, key, says);
    if (!take_word(key, c.words, says)) count(key, *c.value, c.least, c.most);
}

/// @return false: it is a number
bool TableReader::take_word(std::string_view key, const keys::Words& words, std::string_view otherwise) const
{
    const toml::node& at = *node(key);
    if (words.list.empty()) return false;
    const auto found = std::find(words.list.begin(), words.list.end(), at.value<std::string>().value_or(""));
    if (found == words.list.end() && !at.is_number())
        wrong(at, key, fmt::format("\"{}\" or {}", fmt::join(words.list, "\", \""), otherwise));
    words.set(found == words.list.end() ? -1 : static_cast<int>(found - words.list.begin()));
    return found != words.list.end();
}

void TableReader::take(std::string_view key, std::int64_t* value) const
{
    const toml::node& at = *node(key);
    if (!at.is_integer() || *at.value<std::int64_t>() < 0) wrong(at, key, "a whole number, 0 or above");
    *value = *at.value<std::int64_t>();
}

void TableReader::take(std::string_view key, const keys::Numbers& n) const
{
    const toml::node& at = *node(key);
    const toml::array* array = at.as_array();
    if (!array || array->size() != n.values.size()) wrong(at, key, n.form);
    double squares = 0;
    for (std::size_t i = 0; i < n.values.size(); ++i) {
        *n.values[i] = checked((*array)[i], key, n.range);
        squares += *n.values[i] * *n.values[i];
    }
    if (n.nonzero && (!(squares > 1e-24) || !std::isfinite(squares))) wrong(at, key, n.form);
}

void TableReader::take(std::string_view key, const keys::Rows& r) const
{
    const toml::node& at = *node(key);
    const toml::array* array = at.as_array();
    if (!array || array->size() < r.least) wrong(at, key, fmt::format("{} or more rows {}", r.least, r.form));
    std::vector<std::vector<double>> table;
    for (const toml::node& item : *array) {
        const toml::array* row = item.as_array();
        if (!row || row->size() != r.width) wrong(item, key, fmt::format("a row {}", r.form));
        for (std::vector<double>& numbers = table.emplace_back(); const toml::node& entry : *row)
            numbers.push_back(checked(entry, key, any_number));
    }
    r.set(table);
}

/// As an absolute path. @throws Error BadFile when missing
void TableReader::take_file(std::string_view key, std::filesystem::path& value, const std::filesystem::path& scene_file) const
{
    std::string written;
    text(key, written);
    std::error_code ignored;
    const auto& source = node(key)->source().path;
    const std::filesystem::path file = source && !source->starts_with("--set ") ? std::filesystem::path(*source) : scene_file;
    const std::filesystem::path joined = std::filesystem::absolute(file, ignored).parent_path() / written;
    value = std::filesystem::weakly_canonical(joined, ignored);
    if (value.empty()) value = joined;  // too long for a name, or links that go round in a circle
    if (std::filesystem::is_regular_file(value, ignored)) return;
    try {
        const bool escaped = written.find_first_of("\b\t\n\f\r\x1b") != std::string::npos;
        const char* advice =
            escaped || written.find('\\') != std::string::npos ? backslash_advice : "check the path (relative to the scene file)";
        fail(key, fmt::format("no file at {}; {}", printable(value.string()), advice));
    } catch (const Error& error) {
        throw Error(ErrorKind::BadFile, error.what());
    }
}

void TableReader::read(const std::vector<Key>& keys, const std::filesystem::path& scene_file) const
{
    for (const Key& key : keys) {
        // the first clause of its meaning
        if (key.absent == keys::needed && key.use != keys::Use::Unused)
            need(key.name, key.meaning.substr(0, key.meaning.find_first_of(";.")));
        if (!has(key.name)) continue;
        std::visit(
            [&](const auto& value) {
                using Kind = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<Kind, std::filesystem::path*>) take_file(key.name, *value, scene_file);
                else if constexpr (!std::is_same_v<Kind, keys::Tables> && !std::is_same_v<Kind, keys::Special>)
                    take(key.name, value);
            },
            key.value);
    }
}

void TableReader::refuse_unused(const std::vector<Key>& keys, std::string_view why) const
{
    for (const Key& key : keys)
        if (key.use == keys::Use::Unused) refuse(key.name, why);
}

int TableReader::word_index(std::string_view key, std::span<const std::string_view> words) const
{
    const toml::node* at = node(key);
    if (!at) return -1;
    const std::string word = at->value<std::string>().value_or("");
    const auto found = std::find(words.begin(), words.end(), word);
    if (at->is_string() && found != words.end()) return static_cast<int>(found - words.begin());
    wrong(*at, key, fmt::format("one of \"{}\"", fmt::join(words, "\", \"")));
}

void TableReader::need(std::string_view key, std::string_view why) const
{
    if (!has(key)) fail(key, fmt::format("is missing{}{}; add it", why.empty() ? "" : ": ", why));
}

void TableReader::refuse(std::string_view key, std::string_view why) const
{
    if (has(key)) fail(key, why);
}

}  // namespace seldinger
