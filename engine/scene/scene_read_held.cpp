// Holds, loads and links of the instruments: [[hold]], [[load]], [[link]].
#include "scene/scene_read.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>

namespace seldinger {
namespace {

/// The one that `instrument` names; where there is but one it need not be named.
SceneInstrument& instrument_of(const TableReader& t, Scene& scene)
{
    std::string name;
    if (!t.text("instrument", name)) {
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

/// The spelled form of `at`: "base", "tip" or metres from the tip, at most the wire's length.
void read_point(const TableReader& t, const WireSpec& wire, WirePoint& point)
{
    const toml::node* at = t.node("at");
    if (!at) return;
    const auto word = at->is_string() ? at->value<std::string>() : std::nullopt;
    if (word == "base") point.kind = WirePoint::Kind::Base;
    else if (word == "tip") point.kind = WirePoint::Kind::Tip;
    else if (!at->is_number()) t.fail("at", "expected \"base\", \"tip\" or metres from the tip");
    else {
        point.kind = WirePoint::Kind::Distance;
        t.number("at", point.from_tip, not_negative);
        if (point.from_tip > wire.length) t.fail("at", fmt::format("expected at most the wire's length, {} m", wire.length));
    }
}

/// Error when times of rows [t, ...] are negative or do not increase.
void check_times(const TableReader& t, std::string_view key, const std::vector<std::vector<double>>& rows)
{
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i][0] < 0 || (i > 0 && rows[i][0] <= rows[i - 1][0]))
            t.fail(key, "expected times from 0 on that increase; sort the rows");
}

template <std::size_t N>
std::vector<std::array<double, N>> timed_rows(const TableReader& t, std::string_view key, std::string_view form)
{
    std::vector<std::vector<double>> rows;
    std::vector<std::array<double, N>> result;
    if (!t.rows(key, rows, N, 1, form)) return result;
    check_times(t, key, rows);
    for (const auto& row : rows) std::copy(row.begin(), row.end(), result.emplace_back().begin());
    return result;
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

/// What is prescribed along a coordinate that is free would have no effect.
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

/// The time at which a hold or a load ends. An equilibrium has no times.
void read_until(const TableReader& t, const Scene& scene, double& until)
{
    t.number("until_s", until, positive);
    if (scene.integrator.scheme == Scheme::Static) t.refuse("until_s", "needs a run in time; scheme = \"static\" looks for the state at the end");
}

void read_hold(const toml::table& table, const std::string& path, Scene& scene)
{
    const TableReader t(table, path, {"instrument", "at", "position", "direction", "spin", "move", "turn", "velocity_m_s", "until_s"});
    SceneInstrument& instrument = instrument_of(t, scene);
    HoldSpec hold;
    read_point(t, instrument.wire, hold.at);
    if (instrument.feed.on && hold.at.kind == WirePoint::Kind::Base)
        t.fail("at", "the base is held by [feed] already; hold another point or take [feed] out");
    read_held_position(t, hold);
    t.flag("direction", hold.direction);
    t.flag("spin", hold.spin);
    if (!hold.position && !hold.direction && !hold.spin)
        t.fail("position", "fixes nothing; set position, direction or spin to true");
    hold.move = timed_rows<4>(t, "move", "[t_s, dx, dy, dz]");
    hold.turn = timed_rows<2>(t, "turn", "[t_s, rad]");
    t.vector("velocity_m_s", hold.velocity);
    if (!hold.position) {
        t.refuse("move", "needs position = true");
        t.refuse("velocity_m_s", "needs position = true");
    }
    if (!hold.spin) t.refuse("turn", "needs spin = true");
    if (hold.position) refuse_free_moves(t, hold);
    read_until(t, scene, hold.until);
    if (scene.integrator.scheme == Scheme::Static && !hold.velocity.isZero())
        t.fail("velocity_m_s",
               "has no end, and scheme = \"static\" looks for the state at the end; give move = [[t_s, dx, dy, dz], ...]");
    instrument.holds.push_back(std::move(hold));
}

void read_load(const toml::table& table, const std::string& path, Scene& scene)
{
    const TableReader t(table, path, {"instrument", "at", "force_n", "moment_nm", "ramp_s", "until_s"});
    SceneInstrument& instrument = instrument_of(t, scene);
    LoadSpec load;
    t.need("at", "\"base\", \"tip\" or metres from the tip");
    read_point(t, instrument.wire, load.at);
    if (!t.has("force_n") && !t.has("moment_nm")) t.fail("force_n", "is missing; give force_n or moment_nm");
    t.vector("force_n", load.force);
    t.vector("moment_nm", load.moment);
    t.number("ramp_s", load.ramp, not_negative);
    read_until(t, scene, load.until);
    instrument.loads.push_back(load);
}

void read_link(const toml::table& table, const std::string& path, Scene& scene)
{
    const TableReader t(table, path, {"instrument", "at", "anchor", "stiffness_n_m", "move"});
    SceneInstrument& instrument = instrument_of(t, scene);
    LinkSpec link;
    t.need("at", "\"base\", \"tip\" or metres from the tip");
    read_point(t, instrument.wire, link.at);
    t.need("anchor");
    t.vector("anchor", link.anchor);
    t.need("stiffness_n_m");
    t.number("stiffness_n_m", link.stiffness, positive);
    link.move = timed_rows<4>(t, "move", "[t_s, dx, dy, dz]");
    instrument.links.push_back(std::move(link));
}

}  // namespace

void read_holds_and_loads(const toml::table& root, Scene& scene)
{
    const std::pair<const char*, void (*)(const toml::table&, const std::string&, Scene&)> lists[] = {
        {"hold", read_hold}, {"load", read_load}, {"link", read_link}};
    for (const auto& [name, read] : lists)
        for_each_table(root, name, name,
                       [&, read = read](const toml::table& table, const std::string& path) { read(table, path, scene); });
}

}  // namespace seldinger
