// Compares two resolved scenes line by line and names the key that differs.
#include "scene/scene_difference.h"

#include "core/printable.h"
#include "io/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <utility>
#include <vector>

namespace seldinger {
namespace {

struct Entry {
    std::string_view table, key, value;
};

std::vector<Entry> entries(std::string_view text)
{
    std::vector<Entry> list;
    std::string_view table;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.empty()) continue;
        const std::size_t equals = line.find('=');
        if (line.front() == '[' && equals == std::string_view::npos && line.back() == ']') table = line;
        if (equals == std::string_view::npos || line.front() == '{') list.push_back({table, {}, line});
        else list.push_back({table, trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1))});
    }
    return list;
}

std::string named(const Entry& entry) { return fmt::format("{}{}{}", entry.table, entry.key.empty() ? "" : " ", entry.key); }

}  // namespace

std::string first_difference(std::string_view there, std::string_view here)
{
    if (there == here) return "";
    const std::vector<Entry> a = entries(there), b = entries(here);
    const auto same = [](const Entry& x, const Entry& y) { return x.table == y.table && x.key == y.key && x.value == y.value; };
    const auto [at, bt] = std::mismatch(a.begin(), a.end(), b.begin(), b.end(), same);
    if (at != a.end() && bt != b.end() && at->table == bt->table && at->key == bt->key)
        return fmt::format("{} is {} there and {} here", printable(named(*at)), printable(at->value), printable(bt->value));
    if (bt != b.end()) return fmt::format("{} is not there", printable(named(*bt)));
    if (at != a.end()) return fmt::format("{} is not here", printable(named(*at)));
    return "blanks";
}

}  // namespace seldinger
