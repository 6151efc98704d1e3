// Feeds: where an instrument enters, and its key frames.
#include "scene/scene_read.h"

#include <fmt/format.h>

namespace seldinger {
namespace {

FeedKey read_feed_key(const toml::node& node, const std::string& path, const FeedKey& before, bool first)
{
    const toml::table* table = node.as_table();
    if (!table) fail_at(node.source(), path, "expected {t_s = ..., advance_m = ..., turn_rad = ...}");
    const TableReader t(*table, path, {"t_s", "advance_m", "turn_rad"});
    FeedKey key;
    key.turn = before.turn;
    t.need("t_s");
    t.need("advance_m");
    t.number("t_s", key.t, not_negative);
    t.number("advance_m", key.advance, not_negative);
    t.number("turn_rad", key.turn, any_number);
    if (!first && key.t <= before.t) t.fail("t_s", "expected times that increase; sort the keys");
    return key;
}

void read_inlet(const TableReader& t, const Scene& scene, SceneFeed& feed)
{
    const toml::node* inlet = t.node("inlet");
    feed.inlet_auto = inlet != nullptr;
    if (inlet && inlet->is_number()) t.count("inlet", feed.inlet_number, 1, 1000);
    else if (inlet && inlet->value<std::string>() != "auto")
        t.fail("inlet", "expected \"auto\" or the number of a way in, as `seldinger vessel` lists them from 1");
    if (feed.inlet_auto) {
        t.refuse("point", "contradicts inlet; give one or the other");
        t.refuse("direction", "contradicts inlet; give one or the other");
        if (scene.vessel.shape == VesselShape::None) t.fail("inlet", "needs a [vessel]; give point and direction instead");
        return;
    }
    t.need("point", "where the wire enters (or inlet = \"auto\")");
    t.need("direction", "the direction in which the wire enters (or inlet = \"auto\")");
    t.vector("point", feed.point);
    t.direction("direction", feed.direction);
}

/// The length between hand and inlet at the start; with the keys, which say how much is inside then.
void read_behind(const TableReader& t, FeedPlace place, SceneInstrument& into)
{
    SceneFeed& feed = into.feed;
    t.number("behind_m", feed.behind, not_negative);
    if (feed.behind == 0) return;
    if (!place.merged)
        t.fail("behind_m",
               "is of instruments in one centreline only ([coaxial] with model = \"merged\"): elsewhere the hand is at the inlet; "
               "take it out");
    const double inside = feed.at(0).advance;
    if (feed.behind + inside > into.wire.length)
        t.fail("behind_m", fmt::format("{} m behind the inlet and {} m inside at the start are more than the whole instrument, {} m; "
                                       "make length_m longer or take less",
                                       feed.behind, inside, into.wire.length));
}

}  // namespace

void read_feed_table(const toml::table& table, const std::string& path, FeedPlace place, SceneInstrument& into, const Scene& scene)
{
    const TableReader t(table, path, {"point", "direction", "inlet", "start", "behind_m", "keys"});
    SceneFeed& feed = into.feed;
    feed.on = true;
    if (!place.inside) read_inlet(t, scene, feed);
    else
        for (const auto key : {"inlet", "point", "direction"})
            t.refuse(key, "is that of the outer instrument: those inside each other enter at one place; take it out");
    t.need("keys", "key frames of the feed");
    const toml::array* keys = t.node("keys")->as_array();
    if (!keys || keys->empty()) t.fail("keys", "expected [ {t_s = 0.0, advance_m = 0.0, turn_rad = 0.0}, ... ]");
    for (const toml::node& node : *keys) {
        const bool first = feed.keys.empty();
        feed.keys.push_back(read_feed_key(node, path + ".keys", first ? FeedKey{} : feed.keys.back(), first));
        if (feed.keys.back().advance > into.wire.length)
            fail_at(node.as_table()->get("advance_m")->source(), path + ".keys.advance_m",
                    fmt::format("{} m is more than the whole wire, {} m; make {}length_m longer", feed.keys.back().advance,
                                into.wire.length, into.label.empty() ? "wire." : ""));
    }
    read_behind(t, place, into);
    if (place.inside) t.refuse("start", "is that of the outer instrument: those inside each other enter at one place; take it out");
    t.choice("start", feed.along_centreline, feed_start_words);
    if (!feed.along_centreline) return;
    if (scene.vessel.shape == VesselShape::None || scene.vessel.shape == VesselShape::Plane)
        t.fail("start", "got \"centreline\" without a lumen; expected a [vessel] that has one. Fix: take it out");
}

}  // namespace seldinger
