// Several instruments: [[instrument]] with their feeds, and [coaxial], which says which instrument is inside which.
#include "rod/coaxial.h"
#include "scene/scene_layers.h"
#include "scene/scene_read.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cctype>
#include <vector>

namespace seldinger {
namespace {

constexpr std::size_t longest_name = 40;
// A run names files after its instruments, beside these.
constexpr std::string_view taken_names[] = {"trace", "contacts",   "wall",  "vessel", "summary",
                                            "scene", "checkpoint", "frame", "picture"};

const std::string trace_prefix = "trace_";  // of trace_NAME.csv, beside NAME.csv

void check_name(const TableReader& t, const std::string& name, const Scene& scene, int count)
{
    const bool plain =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
    if (name.empty() || name.size() > longest_name || !plain)
        t.fail("name", fmt::format("expected 1 to {} letters, digits, - and _: files are named after it", longest_name));
    if (std::find(std::begin(taken_names), std::end(taken_names), name) != std::end(taken_names))
        t.fail("name", fmt::format("\"{}\" is the name of a run's own file; choose another", name));
    for (int k = 0; k < count; ++k)
        if (const std::string& other = scene.instrument(k).label; other == name)
            t.fail("name", fmt::format("\"{}\" is instrument {} already; choose another", name, k));
        else if (name == trace_prefix + other || other == trace_prefix + name)
            t.fail("name",
                   fmt::format("\"{}\" beside instrument {}, \"{}\": the trace of one would be the nodes of the other, {}.csv; "
                               "choose another",
                               name, k, other, std::max(name, other, [](auto& a, auto& b) { return a.size() < b.size(); })));
}

/// The table of each instrument, named.
std::vector<const toml::table*> read_names(const toml::table& root, Scene& scene)
{
    std::vector<const toml::table*> tables;
    for_each_table(root, "instrument", "instrument", [&](const toml::table& table, const std::string& path) {
        std::vector<std::string_view> any;  // keys are looked at when the whole table is read
        for (const auto& [key, value] : table) any.push_back(key.str());
        const TableReader t(table, path, any);
        if (tables.size() == most_scene_instruments)
            t.fail("name", fmt::format("expected at most {} instruments", most_scene_instruments));
        t.need("name", "the instrument's name in messages and files");
        std::string name;
        t.text("name", name);
        check_name(t, name, scene, static_cast<int>(tables.size()));
        if (!tables.empty()) scene.others.emplace_back();
        scene.instrument(static_cast<int>(tables.size())).label = name;
        tables.push_back(&table);
    });
    if (tables.empty()) fail_at(root.get("instrument")->source(), "instrument", "expected at least one table [[instrument]]");
    return tables;
}

/// Adds the instruments that a key names, none twice.
void read_names_of(const TableReader& t, std::string_view key, std::size_t least, const Scene& scene, std::vector<int>& order)
{
    const toml::array* names = t.node(key)->as_array();
    if (!names || names->size() < least)
        t.fail(key,
               least == 2 ? "expected two names of instruments at least, outer first" : "expected one name of an instrument");
    std::vector<std::string_view> known;
    for (int k = 0; k < scene.instrument_count(); ++k) known.push_back(scene.instrument(k).label);
    const std::string path = fmt::format("coaxial.{}", key);
    for (const toml::node& node : *names) {
        const std::string name = node.value_or<std::string>("");
        const auto at = std::find(known.begin(), known.end(), name);
        if (at == known.end())
            fail_at(node.source(), path,
                    fmt::format("no instrument is called \"{}\"; expected one of \"{}\"", name, fmt::join(known, "\", \"")));
        const int k = static_cast<int>(at - known.begin());
        if (std::find(order.begin(), order.end(), k) != order.end())
            fail_at(node.source(), path, fmt::format("\"{}\" is listed twice; take one out", name));
        order.push_back(k);
    }
}

void read_coaxial(const toml::table& table, Scene& scene)
{
    CoaxialSpec spec;
    const TableReader t(table, "coaxial", keys::coaxial(spec, scene));
    t.need("order", "names of instruments, outer first, e.g. [\"catheter\", \"wire\"]");
    read_names_of(t, "order", 2, scene, spec.order);
    const std::size_t nested = spec.order.size();
    if (t.has("exchange")) read_names_of(t, "exchange", 1, scene, spec.order);
    spec.exchanged = 1 + static_cast<int>(spec.order.size() - nested);
    t.read(keys::coaxial(spec, scene));
    if (spec.model == CoaxialSpec::Model::Merged && spec.order.size() > most_coaxial)
        t.fail("order", fmt::format("got {} instruments; expected at most {} in one centreline; take model = \"separate\"",
                                    spec.order.size(), most_coaxial));
    // a written scene names the defaults, and 0 is what the model does
    const bool meant = spec.mu_sliding > 0 && spec.mu_sliding != CoaxialSpec().mu_sliding;
    if (spec.model == CoaxialSpec::Model::Merged && !spec.lumen_friction && meant)
        scene.warnings.push_back(fmt::format(
            "coaxial.mu_sliding: got {:g} for model = \"merged\", which has no effect there without lumen_friction. Fix: "
            "coaxial.lumen_friction = true, model = \"separate\", or leave it out",
            spec.mu_sliding));
    order_friction(t, "coaxial", spec.mu_static, spec.mu_sliding, scene);
    scene.coaxial = std::move(spec);
}

/// Place in the order, -1: not among those inside each other.
int place_in_order(const Scene& scene, int instrument)
{
    if (!scene.coaxial) return -1;
    const auto at = std::find(scene.coaxial->order.begin(), scene.coaxial->order.end(), instrument);
    return at == scene.coaxial->order.end() ? -1 : static_cast<int>(at - scene.coaxial->order.begin());
}

void read_instrument_table(const toml::table& table, int k, Scene& scene)
{
    const std::string path = fmt::format("instrument.{}", k);
    SceneInstrument& instrument = scene.instrument(k);
    read_wire_table(table, path, table.contains("feed"), instrument, scene);
    const int place = place_in_order(scene, k);
    const toml::node* feed = table.get("feed");
    if (!feed && place >= 0)
        fail_at(table.source(), path + ".feed",
                "is missing; instruments inside each other are fed: give [instrument.feed] with keys");
    if (!feed) return;
    if (!feed->is_table()) fail_at(feed->source(), path + ".feed", "expected one table [instrument.feed]");
    const bool merged = place >= 0 && scene.coaxial->model == CoaxialSpec::Model::Merged;
    read_feed_table(*feed->as_table(), path + ".feed", {place > 0, merged}, instrument, scene);
}

[[noreturn]] void fail_in(const toml::table& table, const char* key, int k, const std::string& message)
{
    const toml::node* at = table.get(key);
    fail_at(at ? at->source() : table.source(), fmt::format("instrument.{}.{}", k, key), message);
}

/// The inner one goes into the outer one's lumen.
void check_fit(const toml::table& table, const Scene& scene, int outer, int inner)
{
    const SceneInstrument &out = scene.instrument(outer), &in = scene.instrument(inner);
    if (out.wire.lumen_radius == 0)
        fail_in(table, "radius_m", inner,
                fmt::format("is inside \"{}\", which has no lumen; give the outer instrument lumen_radius_m", out.label));
    if (in.wire.largest_radius() >= out.wire.lumen_radius)
        fail_in(table, "radius_m", inner,
                fmt::format("{} m is not below the lumen of \"{}\", {} m; take a thinner instrument or a wider one around it",
                            in.wire.largest_radius(), out.label, out.wire.lumen_radius));
}

/// Of those that take turns one is inside at a time. Between two keys of either a way is straight, so that its middle tells.
void check_exchange(const toml::table& table, const Scene& scene, int before, int after)
{
    const SceneFeed &a = scene.instrument(before).feed, &b = scene.instrument(after).feed;
    std::vector<double> times{0};
    for (const SceneFeed* feed : {&a, &b})
        for (const FeedKey& key : feed->keys) times.push_back(key.t);
    std::sort(times.begin(), times.end());
    times.push_back(times.back() + 1);
    for (std::size_t i = 1; i < times.size(); ++i) {
        const double middle = 0.5 * (times[i - 1] + times[i]);
        if (times[i] > times[i - 1] && a.at(middle).advance > 0 && b.at(middle).advance > 0)
            fail_in(
                table, "feed", after,
                fmt::format(
                    "is inside after {} s, as \"{}\" is (advance_m above 0); those of coaxial.exchange take turns: pull one out "
                    "to advance_m = 0 before the next goes in",
                    times[i - 1], scene.instrument(before).label));
    }
}

}  // namespace

void read_instruments(const toml::table& root, Scene& scene)
{
    for (const char* key : {"wire", "feed"})
        if (const toml::node* node = root.get(key))
            fail_at(node->source(), key, fmt::format("is the one-instrument form of a key of [[instrument]]; take {} out", key));
    const std::vector<const toml::table*> tables = read_names(root, scene);
    if (const toml::table* coaxial = find_table(root, "coaxial")) read_coaxial(*coaxial, scene);
    for (int k = 0; k < scene.instrument_count(); ++k) read_instrument_table(*tables[static_cast<std::size_t>(k)], k, scene);
    if (!scene.coaxial) return;
    const std::vector<int>& order = scene.coaxial->order;
    const SceneFeed& outermost = scene.instrument(order[0]).feed;
    for (std::size_t i = 1; i < order.size(); ++i) {
        SceneFeed& feed = scene.instrument(order[i]).feed;
        feed.inlet_auto = outermost.inlet_auto;
        feed.inlet_number = outermost.inlet_number;
        feed.point = outermost.point;
        feed.direction = outermost.direction;
        const toml::table& table = *tables[static_cast<std::size_t>(order[i])];
        check_fit(table, scene, order[static_cast<std::size_t>(scene.coaxial->around(i))], order[i]);
        for (std::size_t k = order.size() - scene.coaxial->turns().size(); k < i; ++k)
            check_exchange(table, scene, order[k], order[i]);
    }
}

void check_several(const toml::table& root, const Scene& scene)
{
    int driven = -1;  // whose hub a force drives
    for (int k = 0; k < scene.instrument_count(); ++k) {
        if (!scene.instrument(k).feed.hub.driven()) continue;
        if (driven >= 0)
            fail_at(root.at_path(fmt::format("instrument[{}].feed.hub_mass_kg", k)).node()->source(),
                    fmt::format("instrument.{}.feed.hub_mass_kg", k),
                    fmt::format(
                        "a force drives the hub of \"{}\" already; give this one's way with advance_m in place of hub_mass_kg",
                        scene.instrument(driven).label));
        driven = k;
    }
    const bool merged = scene.coaxial && scene.coaxial->model == CoaxialSpec::Model::Merged;
    if (!merged && !scene.coaxial && !scene.instruments_touch) return;
    const auto refuse = [&](std::string_view table, std::string_view key, const std::string& message) {
        const std::string path = fmt::format("{}.{}", table, key);
        fail_at(root.at_path(path).node()->source(), path, message);  // it is there: no default is refused
    };
    const std::string_view who =
        merged ? "instruments of one centreline (coaxial.model = \"merged\")" : "instruments that touch each other";
    const IntegratorSpec& integrator = scene.integrator;
    if (integrator.scheme == Scheme::Linearised || integrator.scheme == Scheme::Explicit)
        refuse("integrator", "scheme", fmt::format("does not solve {}; expected \"newton\" or \"static\"", who));
    if (!merged) {
        if (scene.contact.precision == Precision::Float32)
            refuse("contact", "precision", fmt::format("\"float32\" is not for {}; take it out", who));
        return;
    }
    const auto held = [&](int k) { return !scene.instrument(k).holds.empty(); };
    if (integrator.newmark && std::any_of(scene.coaxial->order.begin(), scene.coaxial->order.end(), held))
        refuse("integrator", root.at_path("integrator.gamma") ? "gamma" : "beta",
               "is not for a hold on one of these instruments, where a velocity that the hold removes changes its sign at every "
               "step; take beta "
               "and gamma out, or put a stiff [[link]] in place of the hold");
    if (integrator.conserve)
        refuse("integrator", "conserve", fmt::format("is not for {}; take it out, or give beta and gamma", who));
    if (integrator.damping_stiffness > 0)
        refuse("integrator", "damping_stiffness_s", fmt::format("is not for {}; take it out", who));
    if (scene.instruments_touch)
        refuse("contact", "instruments", fmt::format("is not for {}; take it out, or set coaxial.model = \"separate\"", who));
    if (scene.vessel.shape != VesselShape::None && scene.contact.detection != Detection::Swept)
        refuse("contact", "detection", fmt::format("does not serve {}; expected \"swept\"", who));
}

}  // namespace seldinger
