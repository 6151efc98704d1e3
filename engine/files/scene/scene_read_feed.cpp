// Feeds: where an instrument enters, and its key frames.
#include "scene/scene_read.h"
#include "scene/scene_tables.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

FeedKey read_feed_key(const toml::node& node, const std::string& path, const FeedKey& before, bool first, bool driven)
{
    const toml::table* table = node.as_table();
    if (!table)
        fail_at(node.source(), path,
                fmt::format("expected {{t_s = ..., {} = ..., turn_rad = ...}}", driven ? "force_n" : "advance_m"));
    FeedKey key;
    key.turn = before.turn;
    if (driven) key.advance = before.advance;
    const TableReader t(*table, path, keys::feed_key(key, driven));
    t.refuse_unused(keys::feed_key(key, driven),
                    "is of a hub that a force drives; give hub_mass_kg in the feed's table, or take it out");
    t.read(keys::feed_key(key, driven));
    if (driven && !first && key.advance != before.advance)
        t.fail("advance_m",
               fmt::format("got {} m after {} m, of a hub that a force drives (hub_mass_kg); expected one start for all keys. "
                           "Fix: force_n instead",
                           key.advance, before.advance));
    if (!first && key.t <= before.t) t.fail("t_s", "expected times that increase; sort the keys");
    return key;
}

void check_inlet(const TableReader& t, const Scene& scene)
{
    for (const auto key : {"point", "direction"})
        if (t.has("inlet")) t.refuse(key, "contradicts inlet; give one or the other");
        else t.need(key, "where the wire enters, and in which direction (or inlet = \"auto\")");
    if (t.has("inlet") && scene.vessel.shape == VesselShape::None)
        t.fail("inlet", "needs a [vessel]; give point and direction instead");
}

/// The length between hand and inlet at the start; after the keys, which say how much is inside then.
void check_behind(const TableReader& t, FeedPlace place, const SceneInstrument& into)
{
    const SceneFeed& feed = into.feed;
    if (feed.behind == 0) return;
    if (!place.merged)
        t.fail(
            "behind_m",
            "is of instruments in one centreline only ([coaxial] with model = \"merged\"): elsewhere the hand is at the inlet; "
            "take it out");
    const double inside = feed.at(0).advance;
    if (feed.behind + inside > into.wire.length)
        t.fail("behind_m",
               fmt::format("{} m behind the inlet and {} m inside at the start are more than the whole instrument, {} m; "
                           "make length_m longer or take less",
                           feed.behind, inside, into.wire.length));
}

void read_keys(const TableReader& t, const std::string& path, SceneInstrument& into)
{
    SceneFeed& feed = into.feed;
    t.need("keys", "key frames of the feed");
    const toml::array* keys = t.node("keys")->as_array();
    if (!keys || keys->empty()) t.fail("keys", "expected [ {t_s = 0.0, advance_m = 0.0, turn_rad = 0.0}, ... ]");
    for (const toml::node& node : *keys) {
        const bool first = feed.keys.empty();
        feed.keys.push_back(read_feed_key(node, path + ".keys", first ? FeedKey{} : feed.keys.back(), first, feed.hub.driven()));
        if (feed.keys.back().advance > into.wire.length)
            fail_at(node.as_table()->get("advance_m")->source(), path + ".keys.advance_m",
                    fmt::format("{} m is more than the whole wire, {} m; make {}length_m longer", feed.keys.back().advance,
                                into.wire.length, into.label.empty() ? "wire." : ""));
    }
}

/// The log of a robot in place of key frames, which --set log=... may find in a scene.
void read_log(const TableReader& t, const std::string& path, SceneInstrument& into, Scene& scene)
{
    if (into.feed.hub.driven())
        t.fail("log", "has the way of the hub, and hub_mass_kg a force that drives it; take one of them out");
    std::filesystem::path file;
    t.read({Key{"log", "", &file, ""}}, scene.source);
    std::string said;
    into.feed.keys = read_feed_log(file, into.wire.length, said);
    if (t.has("keys")) said += "; it replaces keys";
    scene.notes.emplace_back(path + ".log", said);
    scene.warnings.push_back(path + ".log: " + said);
}

}  // namespace

void read_feed_table(const toml::table& table, const std::string& path, FeedPlace place, SceneInstrument& into, Scene& scene)
{
    SceneFeed& feed = into.feed;
    feed.on = true;
    const TableReader t(table, path, keys::feed(feed, place.inside));
    t.refuse_unused(keys::feed(feed, place.inside),
                    "is that of the outer instrument: those inside each other enter at one place; take it out");
    if (!place.inside) check_inlet(t, scene);
    t.read(keys::feed(feed, place.inside));
    if (t.has("log")) read_log(t, path, into, scene);
    else read_keys(t, path, into);
    const IntegratorSpec& integrator = scene.integrator;
    if (feed.hub.driven() && (integrator.scheme != Scheme::Newton || integrator.newmark || integrator.conserve))
        t.fail("hub_mass_kg",
               "a hub that a force drives is solved with integrator.scheme = \"newton\" and backward Euler; take beta, gamma "
               "and conserve out, or give the hub's way with advance_m in place of hub_mass_kg");
    for (const char* key : {"hub_damping_n_s_m", "hub_friction_n"})
        if (!feed.hub.driven()) t.refuse(key, "is of a hub that a force drives; give hub_mass_kg, or take it out");
    check_behind(t, place, into);
    if (!feed.along_centreline) return;
    if (scene.vessel.shape == VesselShape::None || scene.vessel.shape == VesselShape::Plane)
        t.fail("start", "got \"centreline\" without a lumen; expected a [vessel] that has one. Fix: take it out");
}

}  // namespace seldinger
