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

void read_integrator(const toml::table& table, Scene& scene)
{
    IntegratorSpec& spec = scene.integrator;
    const TableReader t(table, "integrator", keys::integrator(spec));
    t.read(keys::integrator(spec));
    for (const auto& [key, trapezoid] : {std::pair("beta", 0.25), {"gamma", 0.5}})
        if (double value = trapezoid; t.number(key, value, any_number) && value != trapezoid)
            t.fail(key, fmt::format("got {}; expected {}, the trapezoid rule. Fix: give that, or take it out for backward Euler",
                                    value, trapezoid));
    spec.newmark = t.has("beta") || t.has("gamma");
    if (spec.conserve && spec.scheme != Scheme::Newton)
        t.fail("conserve", "energy is conserved by the converged step only; set scheme = \"newton\" or take this out");
    for (const auto key : {"beta", "gamma"})
        if (spec.conserve) t.refuse(key, "belongs to Newmark's scheme, which conserve = true replaces; take one of the two out");
}

void read_scene_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "scene", keys::scene(scene));
    const bool timed = scene.integrator.scheme != Scheme::Static;
    scene.name = scene.source.stem().string();
    t.read(keys::scene(scene));
    const double steps = scene.duration / scene.dt;
    if (timed && !(steps >= 0.5)) t.fail("duration_s", "expected at least one step; make duration_s longer or dt_s shorter");
    if (!(steps <= keys::most_steps))
        t.fail("dt_s",
               fmt::format("makes {:.3g} steps, expected at most {:.0e}; make it longer", steps, double{keys::most_steps}));
}

/// What the laws of kernels/shared/multiplier_law.h cannot be joined with.
void check_hard_law(const TableReader& t, const Scene& scene)
{
    const ContactSpec& spec = scene.contact;
    if (!is_nonpenetrating(spec.normal)) return;
    const std::string_view law = word_of(normal_words, spec.normal);
    const Scheme scheme = scene.integrator.scheme;
    if (spec.detection == Detection::Layer)
        t.fail("normal", fmt::format("\"{}\" needs material samples, which detection = \"layer\" does not have; use \"swept\", or "
                                     "normal = \"hunt-crossley\"",
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
            "\"float32\" is supported for detection = \"swept\" and \"nodes\" with normal = \"hunt-crossley\" and "
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
    const TableReader t(table, "contact", keys::contact(scene));
    SceneContact& spec = scene.contact;
    t.read(keys::contact(scene));
    if (spec.stiffness_from_wall && spec.exponent != 1.5)
        t.fail("exponent", "stiffness = \"from-wall\" fixes it at 1.5; take it out or give stiffness a number");
    order_friction(t, "contact", spec.mu_static, spec.mu_sliding, scene);
    check_hard_law(t, scene);
    check_precision(t, spec);
}

void read_wall_load(const toml::table& table, const std::string& path, Scene& scene)
{
    WallLoad& load = scene.vessel.loads.emplace_back();
    const TableReader t(table, path, keys::wall_load(load));
    if (!scene.vessel.elastic)
        t.fail(t.has("pressure_pa") ? "pressure_pa" : "force_n", "a rigid wall takes any load; set vessel.wall = \"elastic\"");
    if (!t.has("pressure_pa") && !t.has("force_n")) t.fail("force_n", "is missing; give pressure_pa, or force_n and at");
    if (t.has("force_n")) t.need("at", "the point of the wall nearest to [x, y, z] carries the force");
    else t.refuse("at", "needs force_n");
    t.read(keys::wall_load(load));
}

void read_output(const toml::table& table, Scene& scene)
{
    // a run writes about 100 frames unless told otherwise
    scene.wire_every = scene.contacts_every = static_cast<int>(std::max(1L, (scene.steps() + 99) / 100));
    TableReader(table, "output", keys::output(scene)).read(keys::output(scene));
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
        scene.notes.emplace_back("units",
                                 fmt::format("the mesh's header says {}: vessel.units = \"{}\"", remarks.units, remarks.units));
    } else {
        scene.warnings.push_back(
            fmt::format("vessel.units: got \"{}\"; the mesh's header says \"{}\". Fix: check which of the two is right",
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
                           "link", "force", "wall_load", "task", "carm", "contrast", "output"});
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
    if (!all.has("instrument")) read_wire_table(table("wire"), "wire", feed != nullptr, scene, scene);
    if (all.has("instrument")) read_instruments(root, scene);
    else if (feed) read_feed_table(*feed, "feed", {}, scene, scene);
    choose_wall_youngs(scene);
    settle_bent_starts(table("scene"), scene);
    check_contact_lengths(TableReader(table("contact"), "contact", keys::contact(scene)), scene);
    read_holds_and_loads(root, scene);
    check_several(root, scene);
    for_each_table(root, "wall_load", "wall_load",
                   [&](const toml::table& load, const std::string& path) { read_wall_load(load, path, scene); });
    if (const toml::table* task = find_table(root, "task")) read_task_table(*task, scene);
    if (scene.until == Until::Reached && scene.task.target == TaskSpec::Target::None)
        fail_at(table("scene").get("until")->source(), "scene.until",
                "got \"reached\" without a target; expected [task] target. Fix: add one, or until = \"time\"");
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
    scene.warnings.insert(scene.warnings.begin(), layers.warnings.begin(), layers.warnings.end());
    return scene;
}

Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides)
{
    return read_scene_text(read_scene_file(file), file, overrides);
}

}  // namespace seldinger
