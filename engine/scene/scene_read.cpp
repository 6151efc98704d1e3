// Reads a scene's tables in their order and checks each against those before; instruments and [vessel] have files of their own.
#include "scene/toml_parse.h"
#include "scene/scene_read.h"

#include "io/file_remarks.h"

#include "core/error.h"
#include "core/file_io.h"
#include "scene/scene_layers.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace seldinger {
namespace {

constexpr long most_steps = 1'000'000'000;

void read_integrator(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "integrator",
                        {"scheme", "beta", "gamma", "conserve", "spins", "tolerance", "damping_mass_1_s", "damping_stiffness_s"});
    IntegratorSpec& spec = scene.integrator;
    t.choice("scheme", spec.scheme, scheme_words);
    // absent: backward Euler; one of the two alone: the other is the trapezoid's
    spec.newmark = t.number("beta", spec.beta, {0, 1, true, false, "a number above 0, at most 1"});
    // gamma below 1/2 feeds energy into every mode [Hughes87, sec. 9.1]
    spec.newmark |= t.number("gamma", spec.gamma, {0.5, 1, false, false, "a number from 0.5 to 1"});
    t.flag("conserve", spec.conserve);
    if (spec.conserve && spec.scheme != Scheme::Newton)
        t.fail("conserve", "energy is conserved by the converged step only; set scheme = \"newton\" or take this out");
    for (const auto key : {"beta", "gamma"})
        if (spec.conserve) t.refuse(key, "belongs to Newmark's scheme, which conserve = true replaces; take one of the two out");
    t.choice("spins", spec.spins, spins_words);
    t.number("tolerance", spec.tolerance, {0, 1, true, true, "a number above 0 and below 1"});
    t.number("damping_mass_1_s", spec.damping_mass, not_negative);
    t.number("damping_stiffness_s", spec.damping_stiffness, not_negative);
}

void read_scene_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "scene",
                        {"name", "gravity", "duration_s", "dt_s", "until", "record_every", "seed", "start", "planned"});
    const bool timed = scene.integrator.scheme != Scheme::Static;
    scene.name = scene.source.stem().string();
    t.text("name", scene.name);
    t.text("planned", scene.planned);
    t.vector("gravity", scene.gravity);
    if (timed) {
        t.need("duration_s", "seconds to simulate (only scheme = \"static\" does without)");
        t.need("dt_s", "seconds per step (only scheme = \"static\" does without)");
    }
    t.number("duration_s", scene.duration, timed ? positive : not_negative);
    t.number("dt_s", scene.dt, positive);
    const double steps = scene.duration / scene.dt;
    if (timed && !(steps >= 0.5)) t.fail("duration_s", "expected at least one step; make duration_s longer or dt_s shorter");
    if (!(steps <= static_cast<double>(most_steps)))
        t.fail("dt_s", fmt::format("makes {:.3g} steps, expected at most {:.0e}; make it longer", steps,
                                   static_cast<double>(most_steps)));
    t.choice("until", scene.until, until_words);
    t.count("record_every", scene.record_every, 1, static_cast<int>(most_steps));
    t.whole("seed", scene.seed);
    t.choice("start", scene.start_settled, start_words);
}

/// stiffness = "from-wall" (which fixes n = 1.5) or a number.
void read_contact_stiffness(const TableReader& t, ContactSpec& spec)
{
    const toml::node* stiffness = t.node("stiffness");
    spec.stiffness_from_wall = !stiffness || stiffness->is_string();
    if (spec.stiffness_from_wall) {
        if (stiffness && stiffness->value<std::string>() != "from-wall")
            t.fail("stiffness", "expected \"from-wall\" or a number above 0 [N/m^(n+1)]");
    } else {
        t.number("stiffness", spec.stiffness, positive);
    }
    t.number("exponent", spec.exponent, {1, 3, false, false, "a number from 1 to 3"});
    if (spec.stiffness_from_wall && spec.exponent != 1.5)
        t.fail("exponent", "stiffness = \"from-wall\" fixes it at 1.5; take it out or give stiffness a number");
}

const std::initializer_list<std::string_view> contact_keys = {
    "detection",           "normal",         "friction",        "stiffness",        "exponent",           "restitution",
    "mu_static",           "mu_sliding",     "rolling",         "rolling_alpha",    "rolling_sigma_b_pa", "rolling_sigma_s_pa",
    "rolling_hardness_pa", "layer_height_m", "pair_distance_m", "samples_per_edge", "overlap_m",          "barrier_distance_m",
    "precision",           "instruments"};

/// What the laws of kernels/shared/multiplier_law.h cannot be joined with.
void check_hard_law(const TableReader& t, const Scene& scene)
{
    const ContactSpec& spec = scene.contact;
    if (!is_nonpenetrating(spec.normal)) return;
    const std::string_view law = word_of(normal_words, spec.normal);
    const Scheme scheme = scene.integrator.scheme;
    if (spec.detection == Detection::Layer)
        t.fail("normal", fmt::format("\"{}\" needs material samples, which detection = \"layer\" does not have; use \"swept\" or "
                                     "\"capsule\", or normal = \"hunt-crossley\"",
                                     law));
    if (scheme == Scheme::Linearised || scheme == Scheme::Explicit)
        t.fail("normal",
               fmt::format("\"{}\" is solved by Newton's method to its end; use integrator.scheme = \"newton\" or \"static\", or "
                           "normal = \"hunt-crossley\"",
                           law));
}

void check_precision(const TableReader& t, const ContactSpec& spec)
{
    if (spec.precision == Precision::Float32 && (is_nonpenetrating(spec.normal) || spec.detection == Detection::Layer))
        t.fail(
            "precision",
            "\"float32\" is supported for detection = \"swept\", \"capsule\" and \"nodes\" with normal = \"hunt-crossley\" and "
            "\"lankarani-nikravesh\"; take it out");
}

/// Lengths that are measured against the wire, so after it has been read.
void check_contact_lengths(const TableReader& t, const Scene& scene)
{
    double radius = range_end;
    for (int k = 0; k < scene.instrument_count(); ++k) radius = std::min(radius, scene.instrument(k).wire.least_radius());
    const auto check = [&](std::string_view key, double value, double part, const char* words) {
        if (value > part * radius)
            t.fail(key,
                   fmt::format("{} m is more than {} of the wire's radius, {:.4g} m; make it smaller", value, words, radius));
    };
    check("overlap_m", scene.contact.overlap, 0.25, "a quarter");
    check("barrier_distance_m", scene.contact.barrier_distance, contact_reach, "a tenth");
}

void read_contact(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "contact", contact_keys);
    SceneContact& spec = scene.contact;
    t.choice("detection", spec.detection, detection_words);
    t.choice("normal", spec.normal, normal_words);
    t.choice("friction", spec.friction, friction_words);
    t.choice("precision", spec.precision, precision_words);
    read_contact_stiffness(t, spec);
    t.number("restitution", spec.restitution, {0, 1, true, false, "a number above 0, at most 1"});
    t.number("mu_static", spec.mu_static, friction_range);
    t.number("mu_sliding", spec.mu_sliding, friction_range);
    check_friction(t, spec.mu_static, spec.mu_sliding);
    t.flag("rolling", spec.rolling);
    t.number("rolling_alpha", spec.rolling_alpha, not_negative);
    t.number("rolling_sigma_b_pa", spec.rolling_sigma_b, not_negative);
    t.number("rolling_sigma_s_pa", spec.rolling_sigma_s, not_negative);
    t.number("rolling_hardness_pa", spec.rolling_hardness, positive);
    t.number("layer_height_m", spec.layer_height, positive);
    t.number("pair_distance_m", spec.pair_distance, positive);
    t.count("samples_per_edge", spec.samples_per_edge, 1, 1000);
    t.number("overlap_m", spec.overlap, positive);
    t.number("barrier_distance_m", spec.barrier_distance, positive);
    t.flag("instruments", scene.instruments_touch);
    check_hard_law(t, scene);
    check_precision(t, scene.contact);
}

void read_wall_load(const toml::table& table, const std::string& path, Scene& scene)
{
    const TableReader t(table, path, {"pressure_pa", "at", "force_n"});
    if (!scene.vessel.elastic)
        t.fail(t.has("pressure_pa") ? "pressure_pa" : "force_n", "a rigid wall takes any load; set vessel.wall = \"elastic\"");
    WallLoad load;
    if (!t.has("pressure_pa") && !t.has("force_n")) t.fail("force_n", "is missing; give pressure_pa, or force_n and at");
    t.number("pressure_pa", load.pressure, any_number);
    t.vector("force_n", load.force);
    if (t.has("force_n")) t.need("at", "the point of the wall nearest to [x, y, z] carries the force");
    else t.refuse("at", "needs force_n");
    t.vector("at", load.at);
    scene.vessel.loads.push_back(load);
}

void read_output(const toml::table& table, Scene& scene)
{
    // a run writes about 100 frames unless told otherwise
    const int spread = static_cast<int>(std::max(1L, (scene.steps() + 99) / 100));
    scene.wire_every = scene.contacts_every = spread;
    const TableReader t(table, "output", {"wire_every", "contacts_every", "force_window_m", "force_patch_m", "bands", "keep_traces", "keep_last_frame"});
    t.count("wire_every", scene.wire_every, 0, static_cast<int>(most_steps));
    t.count("contacts_every", scene.contacts_every, 0, static_cast<int>(most_steps));
    t.number("force_window_m", scene.force_window, positive);
    t.number("force_patch_m", scene.force_patch, positive);
    t.flag("bands", scene.bands);
    t.flag("keep_traces", scene.keep_traces);
    t.flag("keep_last_frame", scene.keep_last_frame);
}

/// What the mesh's own header says of its axes and its unit, where the scene says nothing.
void take_remarks_of_mesh(const toml::table& root, Scene& scene)
{
    if (scene.vessel.shape != VesselShape::Mesh) return;
    const FileRemarks remarks = remarks_of_file(scene.vessel.mesh);
    if (remarks.axes == FileAxes::Ras && !root.at_path("carm.head") && !root.at_path("carm.back")) {
        scene.carm.on = true;
        scene.carm.back = -Vec3::UnitY();
        scene.notes.emplace_back("axes", "the mesh's header says SPACE=RAS: carm.back = [0, -1, 0] (docs/axes.md)");
    }
    if (remarks.units.empty() || remarks.units == scene.vessel.units) return;
    if (!root.at_path("vessel.units")) {
        scene.vessel.units = remarks.units;
        scene.notes.emplace_back("units", fmt::format("the mesh's header says {}: vessel.units = \"{}\"", remarks.units, remarks.units));
    } else {
        scene.warnings.push_back(fmt::format("vessel.units: got \"{}\"; the mesh's header says \"{}\". Fix: check which of the two is right",
                                             scene.vessel.units, remarks.units));
    }
}

/// A wire that is laid along the vessel is bent, and would spring to the wall: it settles first, unless the scene says otherwise.
void settle_bent_starts(const toml::table& table, Scene& scene)
{
    for (int k = 0; k < scene.instrument_count(); ++k)
        if (scene.instrument(k).feed.along_centreline && !table.contains("start")) scene.start_settled = true;
}

Scene read_root(const toml::table& root, const std::filesystem::path& file)
{
    Scene scene;
    scene.source = file;
    const TableReader all(root, "",
                          {"scene", "wire", "instrument", "coaxial", "integrator", "vessel", "contact", "feed", "hold", "load",
                           "link", "wall_load", "task", "carm", "contrast", "output"});
    // an absent table reads as an empty one that stands where the file begins
    auto table = [&](std::string_view name) -> const toml::table& {
        static const toml::table none = toml::parse("");
        const toml::table* found = find_table(root, name);
        return found ? *found : none;
    };
    if (!all.has("instrument")) all.need("wire", "every scene has one [wire], or several [[instrument]]");
    for (const auto name : {"wire", "integrator", "scene"})
        (void)find_table(root, name);  // a wrong type is said before a missing table
    if (root.at_path("integrator.scheme").value<std::string>() != "static") all.need("scene", "a table with duration_s and dt_s");
    read_integrator(table("integrator"), scene);
    read_scene_table(table("scene"), scene);
    read_contact(table("contact"), scene);
    if (!all.has("instrument") && all.has("coaxial")) all.fail("coaxial", "joins several [[instrument]]; take it out");
    const toml::table* feed = find_table(root, "feed");
    if (const toml::table* vessel = find_table(root, "vessel")) read_vessel_table(*vessel, scene);
    if (!all.has("instrument")) read_wire_table(table("wire"), "wire", {}, feed != nullptr, scene, scene);
    if (all.has("instrument")) read_instruments(root, scene);
    else if (feed) read_feed_table(*feed, "feed", {}, scene, scene);
    choose_wall_youngs(scene);
    settle_bent_starts(table("scene"), scene);
    check_contact_lengths(TableReader(table("contact"), "contact", contact_keys), scene);
    read_holds_and_loads(root, scene);
    for_each_table(root, "wall_load", "wall_load",
                   [&](const toml::table& load, const std::string& path) { read_wall_load(load, path, scene); });
    if (const toml::table* task = find_table(root, "task")) read_task_table(*task, scene);
    if (scene.until == Until::Reached && scene.task.target == TaskSpec::Target::None)
        fail_at(table("scene").get("until")->source(), "scene.until", "got \"reached\" without a target; expected [task] target. Fix: add one, or until = \"time\"");
    if (const toml::table* arm = find_table(root, "carm")) read_carm_table(*arm, scene);
    if (const toml::table* contrast = find_table(root, "contrast")) read_contrast_table(*contrast, scene);
    read_output(table("output"), scene);
    take_remarks_of_mesh(root, scene);
    return scene;
}

}  // namespace

const toml::table* find_table(const toml::table& root, std::string_view name)
{
    const toml::node* node = root.get(name);
    if (node && !node->is_table()) fail_at(node->source(), name, fmt::format("expected one table [{}]", name));
    return node ? node->as_table() : nullptr;
}

void for_each_table(const toml::table& parent, const std::string& name, const std::string& path,
                    const std::function<void(const toml::table&, const std::string&)>& read)
{
    const toml::node* node = parent.get(name);
    if (!node) return;
    const toml::array* list = node->as_array();
    if (!list) fail_at(node->source(), path, fmt::format("expected tables [[{}]]; write two brackets", path));
    int index = 0;
    for (const toml::node& item : *list) {
        if (!item.is_table()) fail_at(item.source(), path, fmt::format("expected tables [[{}]]", path));
        read(*item.as_table(), fmt::format("{}.{}", path, index++));
    }
}

Scene read_scene_text(const std::string& text, const std::filesystem::path& file, std::span<const std::string> overrides)
{
    LayeredScene layers = layer_scene(text, file, overrides);
    Scene scene = read_root(layers.root, file);
    scene.notes.insert(scene.notes.begin(), layers.notes.begin(), layers.notes.end());
    return scene;
}

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides)
{
    return read_scene_text(read_scene_file(file), file, overrides);
}

}  // namespace seldinger
