// Holds, loads, links and forces of the instruments: [[hold]], [[load]], [[link]], [[force]].
#include "scene/scene_read.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>

namespace seldinger {
namespace {

/// The one that `instrument` names; where there is but one it need not be named.
SceneInstrument& instrument_of(const TableReader& t, const std::string& name, Scene& scene)
{
    if (name.empty()) {
        if (scene.others.empty()) return scene;
        t.fail("instrument", "is missing; the scene has several: give the name of one");
    }
    std::vector<std::string_view> known;
    for (int k = 0; k < scene.instrument_count(); ++k) {
        known.push_back(scene.instrument(k).label);
        if (!known.back().empty() && known.back() == name) return scene.instrument(k);
    }
    if (scene.label.empty()) t.fail("instrument", "is for scenes of several [[instrument]]; take it out");
    t.fail("instrument", fmt::format("no instrument is called \"{}\"; the nearest is \"{}\"", name, nearest_word(name, known)));
}

void check_point(const TableReader& t, const WireSpec& wire, const WirePoint& at)
{
    if (at.kind == WirePoint::Kind::Distance && at.from_tip > wire.length)
        t.fail("at", fmt::format("expected at most the wire's length, {} m", wire.length));
}

/// Error when times of rows [t, ...] are negative or do not increase.
template <std::size_t N>
void check_times(const TableReader& t, std::string_view key, const std::vector<std::array<double, N>>& rows)
{
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i][0] < 0 || (i > 0 && rows[i][0] <= rows[i - 1][0]))
            t.fail(key, "expected times from 0 on that increase; sort the rows");
}

/// `position`: true, false, or a list of the coordinates that are held.
void read_held_position(const TableReader& t, HoldSpec& hold)
{
    const toml::node* node = t.node("position");
    if (!node || !node->is_array()) {
        t.flag("position", hold.position);
        return;
    }
    hold.position = true;
    hold.axes = {false, false, false};
    for (const toml::node& entry : *node->as_array()) {
        const auto name = entry.value<std::string>();
        const auto axis = std::find(axis_names.begin(), axis_names.end(), name.value_or(""));
        if (axis == axis_names.end()) t.fail("position", "expected true, false or some of [\"x\", \"y\", \"z\"]");
        bool& held = hold.axes[static_cast<std::size_t>(axis - axis_names.begin())];
        if (held) t.fail("position", fmt::format("names \"{}\" twice; take one out", *name));
        held = true;
    }
    if (node->as_array()->empty()) t.fail("position", "holds no coordinate; name x, y or z, or set it to false");
}

/// A prescribed move along a free coordinate would have no effect.
void refuse_free_moves(const TableReader& t, const HoldSpec& hold)
{
    for (std::size_t c = 0; c < 3; ++c) {
        if (hold.holds(static_cast<int>(c))) continue;
        const auto moves = [&](const std::array<double, 4>& row) { return row[c + 1] != 0; };
        const std::string free = fmt::format("moves {}, which position leaves free; give 0 there, or hold it", axis_names[c]);
        if (std::any_of(hold.move.begin(), hold.move.end(), moves)) t.fail("move", free);
        if (hold.velocity[static_cast<int>(c)] != 0) t.fail("velocity_m_s", free);
    }
}

/// An equilibrium has no times.
void refuse_until(const TableReader& t, const Scene& scene)
{
    if (scene.integrator.scheme == Scheme::Static)
        t.refuse("until_s", "needs a run in time; scheme = \"static\" looks for the state at the end");
}

void read_hold(const toml::table& table, const std::string& path, Scene& scene)
{
    HoldSpec hold;
    std::string name;
    const TableReader t(table, path, keys::hold(hold, name));
    t.read(keys::hold(hold, name));
    SceneInstrument& instrument = instrument_of(t, name, scene);
    check_point(t, instrument.wire, hold.at);
    if (instrument.feed.on && hold.at.kind == WirePoint::Kind::Base)
        t.fail("at", "the base is held by [feed] already; hold another point or take [feed] out");
    read_held_position(t, hold);
    if (!hold.position && !hold.direction && !hold.spin)
        t.fail("position", "fixes nothing; set position, direction or spin to true");
    check_times(t, "move", hold.move);
    check_times(t, "turn", hold.turn);
    if (!hold.position) {
        t.refuse("move", "needs position = true");
        t.refuse("velocity_m_s", "needs position = true");
    }
    if (!hold.spin) t.refuse("turn", "needs spin = true");
    if (hold.position) refuse_free_moves(t, hold);
    refuse_until(t, scene);
    if (scene.integrator.scheme == Scheme::Static && !hold.velocity.isZero())
        t.fail("velocity_m_s",
               "has no end, and scheme = \"static\" looks for the state at the end; give move = [[t_s, dx, dy, dz], ...]");
    instrument.holds.push_back(std::move(hold));
}

void read_load(const toml::table& table, const std::string& path, Scene& scene)
{
    LoadSpec load;
    std::string name;
    const TableReader t(table, path, keys::load(load, name));
    t.read(keys::load(load, name));
    SceneInstrument& instrument = instrument_of(t, name, scene);
    check_point(t, instrument.wire, load.at);
    if (!t.has("force_n") && !t.has("moment_nm")) t.fail("force_n", "is missing; give force_n or moment_nm");
    refuse_until(t, scene);
    instrument.loads.push_back(load);
}

void read_link(const toml::table& table, const std::string& path, Scene& scene)
{
    LinkSpec link;
    std::string name;
    const TableReader t(table, path, keys::link(link, name));
    t.read(keys::link(link, name));
    SceneInstrument& instrument = instrument_of(t, name, scene);
    check_point(t, instrument.wire, link.at);
    check_times(t, "move", link.move);
    instrument.links.push_back(std::move(link));
}

void read_force(const toml::table& table, const std::string& path, Scene& scene)
{
    SceneForce force;
    std::string instrument;
    for (const auto& [key, value] : table) {  // what is not the engine's is the plugin's
        const std::string name(key.str());
        if (name == "plugin" || name == "instrument" || name == "name") continue;
        const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
        if (name.empty() || name.size() > longest_word || !std::ranges::all_of(name, fits))
            fail_at(key.source(), path, "expected keys of letters, digits and _, at most 64");
        if (value.is_string()) force.keys.texts[name];
        else force.keys.lists[name].resize(value.is_array() ? value.as_array()->size() : 1);
    }
    const TableReader t(table, path, keys::force(force, instrument));
    t.read(keys::force(force, instrument), scene.source);
    instrument_of(t, instrument, scene).forces.push_back(std::move(force));
}

}  // namespace

void read_holds_and_loads(const toml::table& root, Scene& scene)
{
    const std::pair<const char*, void (*)(const toml::table&, const std::string&, Scene&)> lists[] = {
        {"hold", read_hold}, {"load", read_load}, {"link", read_link}, {"force", read_force}};
    for (const auto& [name, read] : lists)
        for_each_table(root, name, name,
                       [&, read = read](const toml::table& table, const std::string& path) { read(table, path, scene); });
}

}  // namespace seldinger
