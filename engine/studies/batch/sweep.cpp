// Parses sweep files, draws values by a hash of seed, key and index, and lists each run's settings.
#include "batch/sweep.h"

#include "core/error.h"
#include "core/file_io.h"
#include "core/fnv1a.h"
#include "scene/toml_parse.h"
#include "scene/toml_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace seldinger {
namespace {

constexpr double most_runs = 1e6;
constexpr std::size_t most_values = 4'000'000;  // in all axes: some 300 MB
constexpr std::size_t most_axes = 1000;

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
    if (node.is_floating_point()) return toml_number(*node.value<double>());
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
        axis.values.push_back(toml_number(log ? low * std::pow(high / low, u) : low + (high - low) * u));
    }
}

/// The leaves of a design's tables as texts of --set. A list of tables at the top is set table by table, any other one as a
/// whole.
void flatten(const toml::table& table, const std::string& path, std::vector<std::string>& settings)
{
    for (const auto& [name, node] : table) {
        const std::string key = path.empty() ? std::string(name.str()) : path + "." + std::string(name.str());
        const toml::array* list = node.as_array();
        if (const toml::table* inner = node.as_table()) {
            flatten(*inner, key, settings);
        } else if (list && list->is_array_of_tables() && key.find('.') == std::string::npos) {
            for (std::size_t k = 0; k < list->size(); ++k)
                flatten(*(*list)[k].as_table(), fmt::format("{}.{}", key, k), settings);
        } else {
            if (key.find('.') == std::string::npos)
                fail_at(node.source(), key, "expected keys of the scene in their tables, e.g. [wire] bend_nm2 = 1e-5");
            settings.push_back(key + "=" + value_text(node));
        }
    }
}

using DesignFiles = std::vector<std::pair<std::string, std::string>>;  // name as the sweep gives it, text

/// [vary.design]: names with the files that they stand for. @param texts  of files, where the sweep carries them
SweepAxis read_designs(const toml::node& node, const std::filesystem::path& sweep, const toml::table* texts, DesignFiles* files)
{
    SweepAxis axis;
    axis.key = "design";
    axis.line = static_cast<int>(node.source().begin.line);
    const toml::table* designs = node.as_table();
    if (!designs || designs->empty())
        fail_at(node.source(), "vary.design", "expected names with files, e.g. soft = \"soft.toml\"");
    std::vector<std::pair<toml::source_position, std::string>> order;  // the file's, which the table does not keep
    for (const auto& [name, file] : *designs) order.emplace_back(file.source().begin, name.str());
    std::sort(order.begin(), order.end(),
              [](const auto& a, const auto& b) { return a.first < b.first || (a.first == b.first && a.second < b.second); });
    for (const auto& [place, name] : order) {
        const toml::node& given = *designs->get(name);
        const std::string key = "vary.design." + name;
        if (!given.is_string()) fail_at(given.source(), key, "expected a file with keys of the scene, in quotes");
        const std::string file = *given.value<std::string>();
        const toml::node* kept = texts ? texts->get(file) : nullptr;
        std::string text;
        try {
            text = kept && kept->is_string() ? *kept->value<std::string>() : read_scene_file(sweep.parent_path() / file);
        } catch (const Error& error) {
            fail_at(given.source(), key, fmt::format("{}; paths start at the sweep file's folder", error.what()));
        }
        const toml::table table = parse_toml(text, file);
        if (const toml::node* include = table.get("include"))
            fail_at(include->source(), "include",
                    "a design sets keys of the scene and includes no file; put the include into the scene");
        axis.values.push_back(toml_quoted(name));
        flatten(table, "", axis.designs.emplace_back());
        if (axis.designs.back().empty())
            fail_at(given.source(), key, fmt::format("{} sets no key; expected some of the scene", file));
        if (files) files->emplace_back(file, std::move(text));
    }
    return axis;
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
            throw Error(ErrorKind::BadScene,
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

std::vector<std::string> Sweep::overrides(const SweepAxis& axis, std::size_t value) const
{
    return axis.designs.empty() ? std::vector{axis.key + "=" + axis.values[value]} : axis.designs[value];
}

std::vector<std::string> Sweep::overrides(std::size_t run) const
{
    const std::vector<std::size_t> index = indices(run);
    std::vector<std::string> list;
    for (std::size_t a = 0; a < axes.size(); ++a)
        for (std::string& setting : overrides(axes[a], index[a])) list.push_back(std::move(setting));
    return list;
}

Sweep read_sweep_text(const std::string& text, const std::filesystem::path& file, std::int64_t seed)
{
    const toml::table root = parse_toml(text, file.string());
    const TableReader all(root, "", {"vary", "files"});
    all.need("vary", "a sweep has one table [vary]");
    const toml::table* vary = all.node("vary")->as_table();
    if (!vary) all.fail("vary", "expected a table [vary]");
    Sweep sweep;
    sweep.source = file;
    for (const auto& [key, node] : *vary) {
        if (key.str() == "design") sweep.axes.push_back(read_designs(node, file, root["files"].as_table(), nullptr));
        else read_axis(std::string(key.str()), node, seed, sweep);
    }
    std::stable_sort(sweep.axes.begin(), sweep.axes.end(),
                     [](const SweepAxis& a, const SweepAxis& b) { return a.line < b.line; });
    check_axes(*vary, sweep);
    return sweep;
}

std::string with_designs(const std::string& text, const std::filesystem::path& file)
{
    const toml::table root = parse_toml(text, file.string());
    const toml::node* designs = root["vary"].as_table() ? root["vary"].as_table()->get("design") : nullptr;
    if (!designs || root.contains("files")) return text;
    DesignFiles files;
    (void)read_designs(*designs, file, nullptr, &files);
    std::string whole = text + (text.empty() || text.back() == '\n' ? "" : "\n") + "\n[files]\n";
    std::vector<std::string> there;
    for (const auto& [name, content] : files) {
        if (std::find(there.begin(), there.end(), name) != there.end()) continue;
        there.push_back(name);
        whole += toml_quoted(name) + " = " + toml_quoted(content) + "\n";
    }
    return whole;
}

Sweep read_sweep(const std::filesystem::path& file, std::int64_t seed)
{
    return read_sweep_text(read_scene_file(file), file, seed);
}

}  // namespace seldinger
