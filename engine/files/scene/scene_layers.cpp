// Lays the files of a scene over each other: include, preset, --set. Tables are combined key by key; a key's value is replaced
// completely.
#include "scene/scene_layers.h"

#include "core/error.h"
#include "core/file_io.h"
#include "scene/instruments.h"
#include "scene/scene_keys.h"
#include "scene/toml_parse.h"
#include "scene/toml_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <optional>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t deepest_include = 8;
// Limits on all included files, each counted as often as it is named: ten files that include ten others, eight deep, would be
// read for hours.
constexpr std::size_t most_includes = 100, most_included_bytes = 16u << 20;
constexpr std::string_view material_keys[] = {"youngs_pa", "poisson"};
constexpr std::string_view instrument_kinds[] = {"wire", "catheter", "sheath"};

struct Layer {
    toml::table root;
    bool has_preset = false;  // here or in what it includes
};

using Notes = std::vector<std::pair<std::string, std::string>>;

/// Files from the scene to the one that is being read, as canonical paths.
using Chain = std::vector<fs::path>;

void erase_keys(toml::table& table, std::span<const std::string_view> keys)
{
    for (const std::string_view key : keys) table.erase(key);
}

bool has_any(const toml::table& table, std::span<const std::string_view> keys)
{
    return std::any_of(keys.begin(), keys.end(), [&](std::string_view key) { return table.contains(key); });
}

/// What `lower` says and `upper` does not. Moved, not copied: a node's source goes with it.
void lay_under(toml::table& upper, toml::table&& lower)
{
    for (auto&& [key, node] : lower)
        if (!upper.contains(key.str()))
            std::move(node).visit(
                [&, &name = key](auto&& value) { upper.insert_or_assign(name, std::forward<decltype(value)>(value)); });
}

/// The same of [wire]: stiffness is a material or three numbers, and either takes the place of the other below it.
void lay_wire_under(toml::table& upper, toml::table&& lower)
{
    if (upper.contains("youngs_pa")) erase_keys(lower, keys::stiffness);
    else if (has_any(upper, keys::stiffness)) erase_keys(lower, material_keys);
    lay_under(upper, std::move(lower));
}

void lay_under(Layer& upper, Layer&& lower)
{
    toml::table* lower_wire = lower.root["wire"].as_table();
    // an instrument replaces the whole table: no key of another one remains
    if (upper.has_preset && lower_wire) erase_keys(*lower_wire, keys::of_instruments());
    for (auto&& [key, node] : lower.root) {
        toml::table* over = upper.root[key.str()].as_table();
        if (!over || !node.is_table()) continue;
        if (key.str() == "wire") lay_wire_under(*over, std::move(*node.as_table()));
        else lay_under(*over, std::move(*node.as_table()));
    }
    lay_under(upper.root, std::move(lower.root));
    upper.has_preset |= lower.has_preset;
}

/// The names that begin like that; where none does, the three most alike.
std::vector<std::string> nearest_names(const std::string& name)
{
    const std::vector<std::string> all = instrument_names();
    std::vector<std::string> near;
    std::copy_if(all.begin(), all.end(), std::back_inserter(near), [&](const auto& other) { return other.starts_with(name); });
    if (!near.empty()) return near;
    near = all;
    const std::string begin = name.substr(0, longest_word);
    std::stable_sort(near.begin(), near.end(),
                     [&](const auto& a, const auto& b) { return edit_distance(begin, a) < edit_distance(begin, b); });
    near.resize(std::min<std::size_t>(near.size(), 3));
    return near;
}

/// [wire] of the instrument that `preset` names. @param path  of the table that names it
toml::table wire_of_preset(const toml::node& preset, const std::string& path)
{
    const std::string key = path + ".preset";
    const std::string name = preset.is_string() ? *preset.value<std::string>() : "";
    if (name.empty())
        fail_at(preset.source(), key, "expected an instrument's name in quotes; `seldinger instruments` lists them");
    const std::vector<std::string> names = instrument_names();
    if (!std::binary_search(names.begin(), names.end(), name))
        fail_at(preset.source(), key,
                fmt::format("no instrument is called \"{}\"; the nearest are {}; all are in {} (`seldinger instruments`)", name,
                            fmt::join(nearest_names(name), ", "), instrument_file("").parent_path().string()));
    toml::table file = read_instrument(instrument_file(name));
    return std::move(*file["wire"].as_table());
}

/// [wire], or each [[instrument]], with its path; not those that are more than a scene may have, which are refused when they are
/// read.
void for_each_wire(toml::table& root, const std::function<void(toml::table&, const std::string&)>& visit)
{
    if (toml::table* wire = root["wire"].as_table()) visit(*wire, "wire");
    toml::array* list = root["instrument"].as_array();
    for (std::size_t k = 0; list && k < std::min(list->size(), most_scene_instruments); ++k)
        if (toml::table* table = (*list)[k].as_table()) visit(*table, fmt::format("instrument.{}", k));
}

/// Brings the instruments that are named as `preset` in, under what the table says or, with `replace`, in place of it.
/// @return the key and the name of each
Notes bring_in_presets(toml::table& root, bool replace)
{
    Notes brought;
    for_each_wire(root, [&](toml::table& wire, const std::string& path) {
        const toml::node* preset = wire.get("preset");
        if (!preset) return;
        toml::table instrument = wire_of_preset(*preset, path);
        brought.emplace_back(path + ".preset", *preset->value<std::string>());
        wire.erase("preset");
        if (replace) erase_keys(wire, keys::of_instruments());
        lay_wire_under(wire, std::move(instrument));
    });
    return brought;
}

/// What `include` says, as places in the file: a text or a list of them.
std::vector<const toml::node*> included(const toml::node& node)
{
    std::vector<const toml::node*> items;
    if (const toml::array* list = node.as_array())
        for (const toml::node& item : *list) items.push_back(&item);
    else items.push_back(&node);
    for (const toml::node* item : items)
        if (!item->is_string() || item->value<std::string>()->empty() ||
            item->value<std::string>()->find('\0') != std::string::npos)  // the system would read the name up to there
            fail_at(item->source(), "include", "expected a file's path in quotes, or a list of them");
    return items;
}

std::string names_of(const Chain& chain)
{
    std::vector<std::string> names;
    for (const fs::path& file : chain) names.push_back(file.filename().string());
    return fmt::format("{}", fmt::join(names, " > "));
}

fs::path full_path(const fs::path& file)
{
    std::error_code ignored;
    return fs::weakly_canonical(fs::absolute(file, ignored), ignored);
}

/// Layers come from the top down: the first preset is the one that shows.
void note_preset(LayeredScene& whole, const std::pair<std::string, std::string>& brought)
{
    const bool known =
        std::any_of(whole.notes.begin(), whole.notes.end(), [&](const auto& n) { return n.first == brought.first; });
    if (!known) whole.notes.push_back(brought);
}

void note_include(LayeredScene& whole, const std::string& file)
{
    const auto known = std::find_if(whole.notes.begin(), whole.notes.end(), [](const auto& n) { return n.first == "include"; });
    if (known == whole.notes.end()) whole.notes.emplace_back("include", file);
    else known->second += ", " + file;
}

Layer read_layer(const std::string& text, const fs::path& file, Chain& chain, LayeredScene& whole);

Layer read_include(const toml::node& item, const fs::path& from, Chain& chain, LayeredScene& whole)
{
    const fs::path file = from.parent_path() / *item.value<std::string>();
    Chain longer = chain;
    longer.push_back(full_path(file));
    if (std::find(chain.begin(), chain.end(), longer.back()) != chain.end())
        fail_at(item.source(), "include", fmt::format("goes in a circle ({}); take one include out", names_of(longer)));
    if (chain.size() > deepest_include)
        fail_at(item.source(), "include",
                fmt::format("is more than {} files deep ({}); include fewer in each other", deepest_include, names_of(longer)));
    std::string text;
    try {
        text = read_scene_file(file);
    } catch (const Error& error) {
        fail_at(item.source(), "include", fmt::format("{}; paths start at the folder of the file that includes", error.what()));
    }
    whole.included_bytes += text.size();
    if (++whole.included > most_includes || whole.included_bytes > most_included_bytes)
        fail_at(item.source(), "include",
                fmt::format("is one too many: a scene includes at most {} files of {} MB in all ({}); include fewer",
                            most_includes, most_included_bytes >> 20, names_of(longer)));
    note_include(whole, *item.value<std::string>());
    return read_layer(text, file, longer, whole);
}

Layer read_layer(const std::string& text, const fs::path& file, Chain& chain, LayeredScene& whole)
{
    Layer layer{parse_toml(text, file)};
    for (const auto& brought : bring_in_presets(layer.root, false)) {
        layer.has_preset |= brought.first == "wire.preset";
        note_preset(whole, brought);
    }
    if (const toml::node* include = layer.root.get("include")) {
        const std::vector<const toml::node*> items = included(*include);
        // of several the later ones win: they are laid under first
        for (auto item = items.rbegin(); item != items.rend(); ++item) lay_under(layer, read_include(**item, file, chain, whole));
        layer.root.erase("include");
    }
    return layer;
}

bool is_preset(const std::string& text)
{
    std::string key = text.substr(0, text.find('='));
    std::erase_if(key, [](char c) { return c == ' ' || c == '\t'; });
    const bool of_wire = key == "wire.preset" || (key.starts_with("instrument.") && key.ends_with(".preset"));
    return of_wire && text.find('=') != std::string::npos;
}

/// The instrument's file that a node comes from; empty: the scene or an option says it.
fs::path instrument_of(const toml::node* node)
{
    if (!node || !node->source().path) return {};
    const fs::path file = full_path(*node->source().path);
    return file.parent_path() == full_path(instrument_file("")).parent_path() ? file : fs::path();
}

/// Where a scene changes one of an instrument's two coefficients, the other keeps its ratio to it.
void keep_friction_ratio(toml::table& wire)
{
    for (const auto& [changed, kept] : {std::pair("mu_sliding", "mu_static"), std::pair("mu_static", "mu_sliding")}) {
        const fs::path file = instrument_of(wire.get(kept));
        const std::optional<double> now = wire[changed].value<double>();
        if (file.empty() || !now || !instrument_of(wire.get(changed)).empty()) continue;
        const toml::table own = read_instrument(file);
        const std::optional<double> before = own["wire"][changed].value<double>();
        if (before && *before > 0) wire.insert_or_assign(kept, *wire[kept].value<double>() * *now / *before);
    }
}

/// A wire shorter than its instrument is the far end of it: sections that the instrument brought end where the wire does.
void fit_sections(toml::table& wire)
{
    const std::optional<double> length = wire["length_m"].value<double>();
    toml::array* sections = wire["section"].as_array();
    if (!length || !(*length > 0) || !sections || sections->empty()) return;
    if (instrument_of(sections).empty()) return;
    for (auto at = sections->begin(); at != sections->end();) {
        toml::array* ends = at->is_table() ? (*at->as_table())["from_tip_m"].as_array() : nullptr;
        const bool two = ends && ends->size() == 2 && (*ends)[0].is_floating_point() && (*ends)[1].is_floating_point();
        if (two && *(*ends)[0].value<double>() >= *length) {
            at = sections->erase(at);
            continue;
        }
        if (two && *(*ends)[1].value<double>() > *length) *(*ends)[1].as_floating_point() = *length;
        ++at;
    }
}

/// How far the sections of a wire bend it where nothing acts on it [rad].
double rest_angle(toml::array* sections)
{
    const auto pair = [](const toml::node_view<toml::node>& list) {
        const toml::array* two = list.as_array();
        const auto number = [&](std::size_t k) { return two && two->size() == 2 ? (*two)[k].value<double>().value_or(0) : 0; };
        return std::pair(number(0), number(1));
    };
    double angle = 0;
    for (std::size_t k = 0; sections && k < sections->size(); ++k) {
        toml::table* section = (*sections)[k].as_table();
        if (!section) continue;
        const auto [from, to] = pair((*section)["from_tip_m"]);
        const auto [one, other] = pair((*section)["rest_curvature_1_m"]);
        angle += std::abs(to - from) * std::hypot(one, other);
    }
    return angle;
}

/// Sections replace all of an instrument's, the ones that shape its tip, too. @param path  of the wire @param name  of its
/// instrument
void warn_of_lost_tip(LayeredScene& scene, toml::table& wire, const std::string& path, const std::string& name)
{
    toml::array* sections = wire["section"].as_array();
    if (!sections || !instrument_of(sections).empty() || rest_angle(sections) > 0) return;
    toml::table own = read_instrument(instrument_file(name));
    const double angle = rest_angle(own["wire"]["section"].as_array());
    if (angle > 0)
        scene.warnings.push_back(fmt::format(
            "{}.section: replaces all sections of \"{}\", the tip that they bend by {:.0f} degrees, too: this tip is straight. "
            "Fix: give a section with rest_curvature_1_m ({} has it), or change its sections key by key, as --set "
            "{}.section.0.bend_nm2=1e-5",
            path, name, angle * 180 / std::numbers::pi, instrument_file(name).string(), path));
}

}  // namespace

toml::table read_instrument(const fs::path& file)
{
    toml::table root = parse_toml(read_scene_file(file), file);
    const TableReader all(root, "", {"title", "kind", "wire"});
    for (const auto key : {"title", "kind", "wire"}) all.need(key, "an instrument has title, kind and [wire]");
    std::string title;
    all.text("title", title);
    (void)all.word_index("kind", instrument_kinds);
    const toml::table* wire = root["wire"].as_table();
    if (!wire) all.fail("wire", "expected one table [wire]");
    const std::vector<std::string_view>& properties = keys::of_instruments();
    for (const auto& [key, value] : *wire)
        if (std::find(properties.begin(), properties.end(), key.str()) == properties.end())
            fail_at(key.source(), fmt::format("wire.{}", key.str()),
                    fmt::format("is no property of an instrument; expected one of {}", fmt::join(properties, ", ")));
    return root;
}

LayeredScene layer_scene(const std::string& text, const fs::path& file, std::span<const std::string> overrides)
{
    LayeredScene scene;
    Chain chain = {full_path(file)};
    scene.root = read_layer(text, file, chain, scene).root;
    // presets first: what else is set is said of the instrument that is then there
    for (const std::string& entry : overrides) {
        if (!is_preset(entry)) continue;
        apply_override(scene.root, entry);
        for (const auto& brought : bring_in_presets(scene.root, true)) {
            std::erase_if(scene.notes, [&](const auto& note) { return note.first == brought.first; });
            note_preset(scene, brought);
        }
    }
    for (const std::string& entry : overrides)
        if (!is_preset(entry)) apply_override(scene.root, entry);
    for_each_wire(scene.root, [&](toml::table& wire, const std::string& path) {
        keep_friction_ratio(wire);
        fit_sections(wire);
        for (const auto& [key, name] : scene.notes)
            if (key == path + ".preset") warn_of_lost_tip(scene, wire, path, name);
    });
    return scene;
}

}  // namespace seldinger
