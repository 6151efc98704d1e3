// A Scene as TOML. Doubles are printed as the shortest text that reads back to the same bits.
#include "scene/scene_names.h"
#include "scene/toml_text.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

namespace seldinger {
namespace {

std::string toml_number(double v)
{
    std::string text = fmt::format("{}", v);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";  // 1 -> 1.0, so that it looks like what it is
    return text;
}

std::string vec(const Vec3& v) { return fmt::format("[{}, {}, {}]", toml_number(v.x()), toml_number(v.y()), toml_number(v.z())); }

/// Lines "key = value" of one table.
class TableText {
public:
    explicit TableText(std::string& out, std::string_view header) : out_(out)
    {
        out_ += fmt::format("{}{}\n", out_.empty() ? "" : "\n", header);
    }
    TableText& raw(std::string_view key, std::string_view value)
    {
        out_ += fmt::format("{} = {}\n", key, value);
        return *this;
    }
    TableText& num(std::string_view key, double v) { return raw(key, toml_number(v)); }
    TableText& whole(std::string_view key, std::int64_t v) { return raw(key, fmt::format("{}", v)); }
    TableText& flag(std::string_view key, bool v) { return raw(key, v ? "true" : "false"); }
    TableText& word(std::string_view key, std::string_view v) { return raw(key, toml_quoted(v)); }
    TableText& vector(std::string_view key, const Vec3& v) { return raw(key, vec(v)); }
    /// Where 0 means "chosen by the engine", nothing is written.
    TableText& num_unless_zero(std::string_view key, double v) { return v == 0 ? *this : num(key, v); }

private:
    std::string& out_;
};

template <std::size_t N>
std::string rows(const std::vector<std::array<double, N>>& table)
{
    std::string out = "[";
    for (std::size_t i = 0; i < table.size(); ++i) {
        out += i ? ", [" : "[";
        for (std::size_t k = 0; k < N; ++k) out += (k ? ", " : "") + toml_number(table[i][k]);
        out += "]";
    }
    return out + "]";
}

/// Degrees that read back to exactly `radians`: the quotient is right to an ulp or two, so its neighbours are tried.
double degrees(double radians)
{
    double low = radians * 180 / std::numbers::pi, high = low;
    for (int i = 0; i < 8; ++i) {
        for (const double v : {low, high})
            if (v * std::numbers::pi / 180 == radians) return v;
        low = std::nextafter(low, 0.0);
        high = std::nextafter(high, std::numeric_limits<double>::infinity());
    }
    return radians * 180 / std::numbers::pi;
}

void write_properties(TableText& t, const WireSection& s, bool inherits_material)
{
    t.num("radius_m", s.radius).num("density", s.density);
    WireSection solid = s;
    set_stiffness_from_material(solid);
    const bool by_material = s.youngs > 0 && solid.bend_stiffness == s.bend_stiffness &&
                             solid.twist_stiffness == s.twist_stiffness && solid.stretch_stiffness == s.stretch_stiffness;
    if (by_material) t.num("youngs_pa", s.youngs).num("poisson", s.poisson);
    else t.num("bend_nm2", s.bend_stiffness).num("twist_nm2", s.twist_stiffness).num("stretch_n", s.stretch_stiffness);
    if (!by_material && inherits_material) t.num("poisson", s.poisson);
    t.num("mu_static", s.mu_static).num("mu_sliding", s.mu_sliding);
}

std::string place_text(const WirePlacement& p)
{
    std::string out = fmt::format("{{ shape = {}", toml_quoted(word_of(place_words, p.shape)));
    if (p.shape != PlaceShape::Points && p.shape != PlaceShape::Centreline)
        out += fmt::format(", base = {}, direction = {}", vec(p.base), vec(p.direction));
    out += fmt::format(", normal = {}", vec(p.normal));
    if (p.shape == PlaceShape::Arc) out += fmt::format(", bend_radius_m = {}", toml_number(p.bend_radius));
    if (p.shape == PlaceShape::Ring) out += fmt::format(", twist_rad = {}", toml_number(p.twist));
    if (p.shape == PlaceShape::Centreline) out += fmt::format(", from_m = {}", toml_number(p.from));
    if (p.stretched) out += fmt::format(", stretch = {}", toml_quoted(word_of(stretch_words, p.stretched)));
    for (std::size_t i = 0; i < p.points.size(); ++i) out += (i ? ", " : ", points = [") + vec(p.points[i]);
    return out + (p.points.empty() ? " }" : "] }");
}

/// [wire], or one [[instrument]].
void write_wire(std::string& out, const SceneInstrument& instrument)
{
    const bool one = instrument.label.empty();
    const WireSpec& wire = instrument.wire;
    TableText t(out, one ? "[wire]" : "[[instrument]]");
    if (!one) t.word("name", instrument.label);
    t.num("length_m", wire.length);
    if (wire.nodes == 0) t.word("nodes", "adaptive");
    else t.whole("nodes", wire.nodes);
    t.num("min_edge_m", wire.min_edge).num("max_edge_m", wire.max_edge).num("edge_error_m", wire.edge_error);
    write_properties(t, wire.shaft, false);
    t.num("lumen_radius_m", wire.lumen_radius);
    t.word("curvature", word_of(curvature_words, wire.curvature));
    if (!instrument.feed.on) {
        t.raw("place", place_text(wire.place)).word("rest", word_of(rest_words, wire.place.rest_is_placed));
        t.vector("velocity_m_s", wire.place.velocity).num("spin_rad_s", wire.place.spin_rate);
    }
    for (const WireSectionRange& range : wire.sections) {
        TableText s(out, one ? "[[wire.section]]" : "[[instrument.section]]");
        s.raw("from_tip_m", fmt::format("[{}, {}]", toml_number(range.begin), toml_number(range.end)));
        write_properties(s, range.section, range.section.youngs > 0);
        s.raw("rest_curvature_1_m",
              fmt::format("[{}, {}]", toml_number(range.section.rest_curvature[0]), toml_number(range.section.rest_curvature[1])));
    }
}

/// A path as seen from `folder`.
std::string rebased(const std::filesystem::path& path, const std::filesystem::path& folder)
{
    std::error_code error;
    const auto from = std::filesystem::weakly_canonical(std::filesystem::absolute(folder, error), error);
    const auto to = std::filesystem::weakly_canonical(path, error);
    const auto relative = error ? std::filesystem::path() : to.lexically_relative(from);
    return (relative.empty() ? path : relative).generic_string();
}

/// A rigid wall says nothing of what only a yielding one has, unless it was given.
void write_elastic_wall(TableText& t, const VesselSpec& v)
{
    const VesselSpec plain;
    const auto of = [](const VesselSpec& s) {
        return std::tuple(s.support, s.support_damping, s.relaxation, s.pressure, s.wall_edge, s.rims_held);
    };
    if (!v.elastic && of(v) == of(plain)) return;
    t.num("support_pa_m", v.support).num("support_pa_s_m", v.support_damping).num("relaxation_s", v.relaxation);
    t.num("pressure_pa", v.pressure).num_unless_zero("wall_edge_m", v.wall_edge).word("rims", word_of(rims_words, v.rims_held));
}

void write_vessel(std::string& out, const VesselSpec& v, const std::filesystem::path& folder)
{
    if (v.shape == VesselShape::None) return;
    TableText t(out, "[vessel]");
    if (v.shape == VesselShape::Mesh) {
        t.word("mesh", rebased(v.mesh, folder)).word("units", v.units);
    } else {
        t.word("shape", word_of(vessel_words, v.shape));
        if (v.shape == VesselShape::Tube) t.num("radius_m", v.radius).num("length_m", v.length);
        if (v.shape == VesselShape::Arc)
            t.num("radius_m", v.radius)
                .num("bend_radius_m", v.bend_radius)
                .num("angle_deg", degrees(v.angle))
                .num("lead_in_m", v.lead_in)
                .num("lead_out_m", v.lead_out);
        if (v.shape == VesselShape::Plane) t.num("size_m", v.size);
        else t.vector("axis", v.axis);
        t.vector("origin", v.origin).vector("normal", v.normal).whole("triangles", v.triangles);
    }
    t.word("wall", word_of(wall_words, v.elastic))
        .num("youngs_pa", v.youngs)
        .num("poisson", v.poisson)
        .num("thickness_m", v.thickness);
    write_elastic_wall(t, v);
    if (!v.centreline.empty()) t.word("centreline", rebased(v.centreline, folder));
}

void write_contact(std::string& out, const SceneContact& c, bool instruments)
{
    TableText t(out, "[contact]");
    t.word("detection", word_of(detection_words, c.detection)).word("normal", word_of(normal_words, c.normal));
    t.word("friction", word_of(friction_words, c.friction));
    if (c.stiffness_from_wall) t.word("stiffness", "from-wall");
    else t.num("stiffness", c.stiffness);
    t.num("exponent", c.exponent).num("restitution", c.restitution).num("mu_static", c.mu_static).num("mu_sliding", c.mu_sliding);
    t.flag("rolling", c.rolling).num("rolling_alpha", c.rolling_alpha).num("rolling_sigma_b_pa", c.rolling_sigma_b);
    t.num("rolling_sigma_s_pa", c.rolling_sigma_s).num("rolling_hardness_pa", c.rolling_hardness);
    t.num_unless_zero("layer_height_m", c.layer_height).num_unless_zero("pair_distance_m", c.pair_distance);
    if (c.samples_per_edge > 0) t.whole("samples_per_edge", c.samples_per_edge);
    t.num_unless_zero("overlap_m", c.overlap).num_unless_zero("barrier_distance_m", c.barrier_distance);
    t.word("precision", word_of(precision_words, c.precision)).flag("instruments", instruments);
}

/// @param inlet  false: it enters where the instrument around it does
void write_feed(std::string& out, const SceneFeed& feed, std::string_view header, bool inlet)
{
    if (!feed.on) return;
    TableText t(out, header);
    if (inlet && feed.inlet_auto && feed.inlet_number > 0) t.whole("inlet", feed.inlet_number);
    else if (inlet && feed.inlet_auto) t.word("inlet", "auto");
    else if (inlet) t.vector("point", feed.point).vector("direction", feed.direction);
    if (inlet) t.word("start", word_of(feed_start_words, feed.along_centreline));
    t.num_unless_zero("behind_m", feed.behind);
    std::string keys = "[\n";
    for (const FeedKey& key : feed.keys)
        keys +=
            fmt::format("    {{ t_s = {}, advance_m = {}, turn_rad = {} }},\n", toml_number(key.t), toml_number(key.advance), toml_number(key.turn));
    t.raw("keys", keys + "]");
}

/// Whether instrument k is in another one.
bool is_inside(const Scene& scene, int k)
{
    if (!scene.coaxial) return false;
    const std::vector<int>& order = scene.coaxial->order;
    return std::find(order.begin() + 1, order.end(), k) != order.end();
}

void write_instruments(std::string& out, const Scene& scene)
{
    const bool one = scene.label.empty();
    for (int k = 0; k < scene.instrument_count(); ++k) {
        const SceneInstrument& instrument = scene.instrument(k);
        write_wire(out, instrument);
        write_feed(out, instrument.feed, one ? "[feed]" : "[instrument.feed]", !is_inside(scene, k));
    }
    if (!scene.coaxial) return;
    TableText t(out, "[coaxial]");
    std::string names;
    for (const int k : scene.coaxial->order)
        names += (names.empty() ? "" : ", ") + toml_quoted(std::string_view(scene.instrument(k).label));
    t.raw("order", "[" + names + "]").word("model", word_of(coaxial_words, scene.coaxial->model));
    t.num("mu_static", scene.coaxial->mu_static).num("mu_sliding", scene.coaxial->mu_sliding);
    t.num_unless_zero("stiffness", scene.coaxial->stiffness);
    t.num_unless_zero("drag_n_m", scene.coaxial->drag).num_unless_zero("viscous_pa_s", scene.coaxial->viscous);
    if (scene.coaxial->lumen_friction) t.flag("lumen_friction", true);
}

void write_at(TableText& t, const WirePoint& at)
{
    if (at.kind == WirePoint::Kind::Distance) t.num("at", at.from_tip);
    else t.word("at", at.kind == WirePoint::Kind::Base ? "base" : "tip");
}

void write_task(std::string& out, const TaskSpec& task)
{
    if (!task.on) return;
    TableText t(out, "[task]");
    if (!task.text.empty()) t.word("text", task.text);
    t.num_unless_zero("wall_force_n", task.wall_force).num_unless_zero("patch_force_n", task.patch_force);
    t.num_unless_zero("time_s", task.time);
    t.num_unless_zero("fluoroscopy_s", task.fluoroscopy);
    const std::string name = task.target_name.empty() ? "" : fmt::format("name = {}, ", toml_quoted(task.target_name));
    if (task.target == TaskSpec::Target::Point)
        t.raw("target", fmt::format("{{ {}point = {}, radius_m = {} }}", name, vec(task.point), toml_number(task.radius)));
    if (task.target == TaskSpec::Target::Branch)
        t.raw("target", fmt::format("{{ {}branch = {}, beyond_m = {} }}", name, task.branch, toml_number(task.beyond)));
}

void write_held_position(TableText& t, const HoldSpec& hold)
{
    if (hold.axes == std::array<bool, 3>{true, true, true}) {
        t.flag("position", hold.position);
        return;
    }
    std::string axes;
    for (int c = 0; c < 3; ++c)
        if (hold.axes[static_cast<std::size_t>(c)]) axes += (axes.empty() ? "" : ", ") + toml_quoted(std::string_view(axis_names[c]));
    t.raw("position", "[" + axes + "]");
}

void write_holds_and_loads(std::string& out, const SceneInstrument& instrument)
{
    const auto begin = [&](TableText& t, const WirePoint& at) -> TableText& {
        if (!instrument.label.empty()) t.word("instrument", instrument.label);
        write_at(t, at);
        return t;
    };
    for (const HoldSpec& hold : instrument.holds) {
        TableText t(out, "[[hold]]");
        begin(t, hold.at);
        write_held_position(t, hold);
        t.flag("direction", hold.direction).flag("spin", hold.spin);
        if (!hold.move.empty()) t.raw("move", rows(hold.move));
        if (!hold.turn.empty()) t.raw("turn", rows(hold.turn));
        if (hold.position) t.vector("velocity_m_s", hold.velocity);
        if (std::isfinite(hold.until)) t.num("until_s", hold.until);
    }
    for (const LoadSpec& load : instrument.loads) {
        TableText t(out, "[[load]]");
        begin(t, load.at).vector("force_n", load.force).vector("moment_nm", load.moment).num("ramp_s", load.ramp);
        if (std::isfinite(load.until)) t.num("until_s", load.until);
    }
    for (const LinkSpec& link : instrument.links) {
        TableText t(out, "[[link]]");
        begin(t, link.at).vector("anchor", link.anchor).num("stiffness_n_m", link.stiffness);
        if (!link.move.empty()) t.raw("move", rows(link.move));
    }
}

void write_wall_loads(std::string& out, const VesselSpec& vessel)
{
    for (const WallLoad& load : vessel.loads) {
        TableText t(out, "[[wall_load]]");
        t.num("pressure_pa", load.pressure);
        if (!load.force.isZero()) t.vector("at", load.at).vector("force_n", load.force);
    }
}

void write_carm(std::string& out, const SceneCArm& arm, const std::filesystem::path& folder)
{
    if (!arm.on) return;
    TableText t(out, "[carm]");
    if (!arm.isocentre_auto) t.vector("isocentre", arm.isocentre);
    t.vector("head", arm.head).vector("back", arm.back).num("sid_m", arm.sid).num("sod_m", arm.sod).num("field_m", arm.field);
    t.num("kvp", arm.kvp).num("photons", arm.photons).num("blur_m", arm.blur).word("body", word_of(body_words, arm.body));
    t.vector("body_m", arm.body_axes).word("bone_units", arm.bone_units);
    if (!arm.bone.empty()) t.word("bone", rebased(arm.bone, folder));
    std::string keys;
    for (const CArmKey& key : arm.keys)
        keys +=
            fmt::format("    {{ t_s = {}, lao_deg = {}, cra_deg = {} }},\n", toml_number(key.t), toml_number(key.lao_deg), toml_number(key.cra_deg));
    if (!keys.empty()) t.raw("keys", "[\n" + keys + "]");
}

void write_contrast(std::string& out, const SceneContrast& contrast)
{
    if (!contrast.on) return;
    TableText t(out, "[contrast]");
    if (!contrast.at_auto) t.vector("at", contrast.at);
    if (!contrast.inflow_auto) t.vector("inflow", contrast.inflow);
    t.num("speed_m_s", contrast.speed).num("spread", contrast.spread);
    std::string keys;
    for (const ContrastKey& key : contrast.keys)
        keys += fmt::format("    {{ t_s = {}, iodine_mg_ml = {} }},\n", toml_number(key.t), toml_number(key.iodine));
    t.raw("keys", "[\n" + keys + "]");
}

}  // namespace

std::string write_scene(const Scene& scene, const std::filesystem::path& folder)
{
    std::string out;
    TableText t(out, "[scene]");
    t.word("name", scene.name);
    if (!scene.planned.empty()) t.word("planned", scene.planned);
    t.vector("gravity", scene.gravity).num("duration_s", scene.duration).num("dt_s", scene.dt);
    t.word("until", word_of(until_words, scene.until)).whole("record_every", scene.record_every).whole("seed", scene.seed);
    t.word("start", word_of(start_words, scene.start_settled));
    write_instruments(out, scene);
    const IntegratorSpec& integrator = scene.integrator;
    TableText i(out, "[integrator]");
    i.word("scheme", word_of(scheme_words, integrator.scheme));
    if (integrator.newmark) i.num("beta", integrator.beta).num("gamma", integrator.gamma);
    i.flag("conserve", integrator.conserve).word("spins", word_of(spins_words, integrator.spins));
    i.num("tolerance", integrator.tolerance).num("damping_mass_1_s", integrator.damping_mass);
    i.num("damping_stiffness_s", integrator.damping_stiffness);
    write_vessel(out, scene.vessel, folder);
    write_contact(out, scene.contact, scene.instruments_touch);
    for (int k = 0; k < scene.instrument_count(); ++k) write_holds_and_loads(out, scene.instrument(k));
    write_wall_loads(out, scene.vessel);
    write_task(out, scene.task);
    write_carm(out, scene.carm, folder);
    write_contrast(out, scene.contrast);
    TableText o(out, "[output]");
    o.whole("wire_every", scene.wire_every).whole("contacts_every", scene.contacts_every);
    o.num_unless_zero("force_window_m", scene.force_window).num("force_patch_m", scene.force_patch);
    if (scene.bands) o.flag("bands", true);
    if (scene.keep_traces) o.flag("keep_traces", true);
    if (scene.keep_last_frame) o.flag("keep_last_frame", true);
    return out;
}

}  // namespace seldinger
