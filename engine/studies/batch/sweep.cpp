// Parses sweep files, draws values by a hash of seed, key and index, and lists each run's settings.
#include "batch/sweep.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/fnv1a.h"
#include "scene/toml_parse.h"
#include "scene/toml_table.h"
#include "scene/toml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace seldinger {
namespace {

constexpr double most_runs = 1e6;
constexpr std::size_t most_values = 4'000'000;  // in all axes: some 300 MB
constexpr std::size_t most_axes = 1000;

std::string number_text(double value)
{
    std::string text = fmt::format("{}", value);  // the shortest that reads back to the same bits
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

/// A value as TOML on one line: the library would spread a long list or table over several.
std::string value_text(const toml::node& node)
{
    std::string text;
    const auto join = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (const toml::array* array = node.as_array()) {
        for (const toml::node& item : *array) join(value_text(item));
        return "[" + text + "]";
    }
    if (const toml::table* table = node.as_table()) {
        for (const auto& [key, item] : *table) join(toml_quoted(key.str()) + " = " + value_text(item));
        return "{" + text + "}";
    }
    if (node.is_floating_point()) return number_text(*node.value<double>());
    std::ostringstream out;
    out << toml::toml_formatter(node, toml::toml_formatter::default_flags & ~toml::format_flags::allow_multi_line_strings &
                                          ~toml::format_flags::allow_literal_strings);
    return out.str();
}

/// Even in [0, 1), from the seed, the key and k alone [Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195: SplitMix64].
double draw(std::int64_t seed, const std::string& key, std::uint64_t k)
{
    std::uint64_t z = fnv1a(key.data(), key.size(), fnv1a(&seed, sizeof seed)) + (k + 1) * 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/// @param most  values that may be drawn, of those of all axes
void draw_values(const toml::table& table, std::int64_t seed, std::size_t most, SweepAxis& axis)
{
    const TableReader t(table, axis.key, {"min", "max", "n", "log"});
    double low = 0, high = 0;
    int n = 0;
    bool log = false;
    for (const char* key : {"min", "max", "n"}) t.need(key, "a draw is {min = ..., max = ..., n = ...}");
    t.flag("log", log);
    t.number("min", low, log ? Range{0, range_end, true, false, "a number above 0, since log = true"} : any_number);
    t.number("max", high, any_number);
    t.count("n", n, 1, static_cast<int>(most_runs));
    if (!(high >= low)) t.fail("max", fmt::format("expected at least min, {}", low));
    if (static_cast<std::size_t>(n) > most)
        t.fail("n", fmt::format("makes more than {} values of all keys together; draw fewer, or vary fewer keys", most_values));
    axis.drawn = true;
    for (int k = 0; k < n; ++k) {
        const double u = draw(seed, axis.key, static_cast<std::uint64_t>(k));
        axis.values.push_back(number_text(log ? low * std::pow(high / low, u) : low + (high - low) * u));
    }
}

void read_axis(const std::string& key, const toml::node& node, std::int64_t seed, Sweep& sweep)
{
    SweepAxis axis;
    axis.key = key;
    axis.line = static_cast<int>(node.source().begin.line);
    const toml::table* table = node.as_table();
    const bool is_draw = table && (table->contains("min") || table->contains("max") || table->contains("n"));
    if (table && !is_draw) {  // wire.bend_nm2 without quotes: a table in a table
        for (const auto& [name, item] : *table) read_axis(fmt::format("{}.{}", key, name.str()), item, seed, sweep);
        return;
    }
    if (is_draw) {
        std::size_t values = 0;
        for (const SweepAxis& other : sweep.axes) values += other.values.size();
        draw_values(*table, seed, most_values - std::min(values, most_values), axis);
    } else if (const toml::array* list = node.as_array(); list && !list->empty()) {
        for (const toml::node& item : *list) axis.values.push_back(value_text(item));
    } else {
        fail_at(node.source(), "vary." + key, "expected a list of values, or {min = ..., max = ..., n = ...}");
    }
    if (key.find('.') == std::string::npos)
        fail_at(node.source(), "vary." + key, "expected a key of the scene with its table, e.g. \"wire.bend_nm2\"");
    if (sweep.axes.size() == most_axes)
        fail_at(node.source(), "vary." + key, fmt::format("is more than {} keys; vary fewer", most_axes));
    sweep.axes.push_back(std::move(axis));
}

void check_axes(const toml::table& vary, const Sweep& sweep)
{
    if (sweep.axes.empty())
        fail_at(vary.source(), "vary", "is empty; name at least one key of the scene, e.g. \"wire.bend_nm2\" = [1e-5, 1e-4]");
    double runs = 1;
    const SweepAxis* first_drawn = nullptr;
    for (const SweepAxis& axis : sweep.axes) {
        const auto here = [&](const std::string& message) {
            throw Error(ExitCode::BadScene,
                        fmt::format("{}:{}: vary.{}: {}", sweep.source.string(), axis.line, axis.key, message));
        };
        if (!axis.drawn || !first_drawn) runs *= static_cast<double>(axis.values.size());
        if (axis.drawn && !first_drawn) first_drawn = &axis;
        if (axis.drawn && axis.values.size() != first_drawn->values.size())
            here(fmt::format("n = {} here and {} for {}: draws are made together; give one n", axis.values.size(),
                             first_drawn->values.size(), first_drawn->key));
        if (runs > most_runs) here(fmt::format("makes more than {:.0f} runs in all; take fewer values", most_runs));
    }
}

}  // namespace

std::size_t Sweep::run_count() const
{
    std::size_t grid = 1, draws = 1;
    for (const SweepAxis& axis : axes) (axis.drawn ? draws : grid) = axis.drawn ? axis.values.size() : grid * axis.values.size();
    return grid * draws;
}

std::vector<std::size_t> Sweep::indices(std::size_t run) const
{
    std::vector<std::size_t> index(axes.size());
    const auto drawn = std::find_if(axes.begin(), axes.end(), [](const SweepAxis& axis) { return axis.drawn; });
    const std::size_t draws = drawn == axes.end() ? 1 : drawn->values.size();
    std::size_t grid = run / draws;
    for (std::size_t a = axes.size(); a-- > 0;) {
        if (axes[a].drawn) {
            index[a] = run % draws;
        } else {
            index[a] = grid % axes[a].values.size();
            grid /= axes[a].values.size();
        }
    }
    return index;
}

std::vector<std::string> Sweep::overrides(std::size_t run) const
{
    const std::vector<std::size_t> index = indices(run);
    std::vector<std::string> list;
    for (std::size_t a = 0; a < axes.size(); ++a) list.push_back(axes[a].key + "=" + axes[a].values[index[a]]);
    return list;
}

Sweep read_sweep_text(const std::string& text, const std::filesystem::path& file, std::int64_t seed)
{
    const toml::table root = parse_toml(text, file.string());
    const TableReader all(root, "", {"vary"});
    all.need("vary", "a sweep has one table [vary]");
    const toml::table* vary = all.node("vary")->as_table();
    if (!vary) all.fail("vary", "expected a table [vary]");
    Sweep sweep;
    sweep.source = file;
    for (const auto& [key, node] : *vary) read_axis(std::string(key.str()), node, seed, sweep);
    std::stable_sort(sweep.axes.begin(), sweep.axes.end(),
                     [](const SweepAxis& a, const SweepAxis& b) { return a.line < b.line; });
    check_axes(*vary, sweep);
    return sweep;
}

Sweep read_sweep(const std::filesystem::path& file, std::int64_t seed) { return read_sweep_text(read_scene_file(file), file, seed); }

}  // namespace seldinger
