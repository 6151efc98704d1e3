// Angles to radians, densities to materials; what is asked for over what the scene says.
#include "pictures/fluoro_scene.h"

#include "pictures/xray.h"
#include "scene/run_scene.h"

#include <fmt/format.h>

#include <numbers>

namespace seldinger {
namespace {

constexpr double degree = std::numbers::pi / 180;

InstrumentMatter matter_of(const SceneInstrument& instrument)
{
    const WireSpec& wire = instrument.wire;
    const bool hollow = wire.lumen_radius > 0;
    InstrumentMatter matter{instrument.label, wire.lumen_radius, instrument_material(wire.shaft.density, hollow), {}};
    for (const WireSectionRange& range : wire.sections)
        matter.stretches.push_back({range.begin, range.end, instrument_material(range.section.density, hollow)});
    return matter;
}

}  // namespace

FluoroOptions fluoro_options(const Scene& scene, bool instruments)
{
    FluoroOptions o;
    const SceneCArm& c = scene.carm;
    o.arm.sid = c.sid, o.arm.sod = c.sod, o.arm.field = c.field;
    o.arm.head = c.head.normalized(), o.arm.back = c.back.normalized();
    o.auto_isocentre = c.isocentre_auto;
    o.arm.isocentre = c.isocentre;
    for (const CArmKey& key : c.keys) o.turning.push_back({key.t, key.lao_deg * degree, key.cra_deg * degree});
    if (instruments)
        for (int k = 0; k < scene.instrument_count(); ++k) o.instruments.push_back(matter_of(scene.instrument(k)));
    if (c.body == BodyShape::Ellipsoid) o.body = c.body_axes;
    o.bone = c.bone, o.bone_units = c.bone_units;
    o.kvp = c.kvp, o.photons = c.photons, o.blur = c.blur;
    o.seed = static_cast<std::uint64_t>(scene.seed);
    if (scene.contrast.on) {
        FluoroOptions::Injection i{{scene.contrast.at, scene.contrast.inflow, scene.contrast.speed, scene.contrast.spread, {}},
                                   scene.contrast.at_auto,
                                   scene.contrast.inflow_auto};
        for (const ContrastKey& key : scene.contrast.keys) i.bolus.keys.push_back({key.t, key.iodine});
        o.contrast = i;
    }
    return o;
}

Scene scene_of_pictures(const std::filesystem::path& dir, std::vector<std::string> overrides)
{
    const Folder run(dir);
    if (!run.has("scene.toml")) return {};
    try {
        return read_run_scene(run, overrides);
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::BadFile || !run.has("vessel.vtp")) throw;
    }
    overrides.insert(overrides.end(), {"vessel.mesh=\"vessel.vtp\"", "vessel.units=\"m\""});
    return read_run_scene(run, overrides);
}

namespace {

double in_range(const char* option, double value, double low, double high, const char* what)
{
    if (!(value >= low && value <= high))
        throw Error(ErrorKind::BadScene, fmt::format("{}: got {}; expected {} from {} to {}", option, value, what, low, high));
    return value;
}

void apply(const XrayOptions& asked, FluoroOptions& o)
{
    if (asked.kvp && asked.kev)
        throw Error(ErrorKind::BadScene, "--kvp and --kev: a spectrum or one energy; give one of the two");
    static_cast<FrameChoice&>(o) = asked;
    o.arm.columns = asked.width, o.arm.rows = asked.height;
    if (asked.c_arm) o.turning.clear(), set_angles(o.arm, *asked.c_arm);
    if (asked.sid) o.arm.sid = *asked.sid;
    if (asked.sod) o.arm.sod = *asked.sod;
    if (asked.field) o.arm.field = *asked.field;
    if (asked.kvp) o.kvp = in_range("--kvp", *asked.kvp, 40, 150, "kilovolts");
    if (asked.kev) o.kev = in_range("--kev", *asked.kev, 5, 200, "kiloelectronvolts");
    if (asked.photons) o.photons = in_range("--photons", *asked.photons, 1, 1e12, "photons per pixel");
    if (asked.blur) o.blur = in_range("--blur", *asked.blur, 0, 0.01, "metres");
    if (asked.body) {
        if (*asked.body != "none" && *asked.body != "ellipsoid")
            throw Error(ErrorKind::BadScene, fmt::format("--body: got \"{}\"; expected ellipsoid or none", *asked.body));
        o.body = *asked.body == "none" ? Vec3(Vec3::Zero()) : o.body.isZero() ? SceneCArm().body_axes : o.body;
    }
    if (asked.seed) o.seed = static_cast<std::uint64_t>(*asked.seed);
    o.mask = asked.mask;
    o.raw = asked.raw, o.dicom = asked.dicom;
    o.noise = asked.noise, o.logarithmic = asked.logarithmic;
    if (!asked.contrast) o.contrast.reset();
}

}  // namespace

PictureFiles render_xray(const std::filesystem::path& dir, const std::vector<XrayOptions>& views, const FrameProgress& progress)
{
    if (views.empty()) throw Error(ErrorKind::BadScene, "render_xray: got no view; expected one or more");
    std::vector<FluoroOptions> all;
    for (const XrayOptions& view : views) {
        for (const std::string& key : view.set)
            if (!key.starts_with("carm.") && !key.starts_with("contrast."))
                throw Error(ErrorKind::BadScene,
                            fmt::format("render_xray: got \"{}\"; expected a key of [carm] or [contrast]", key));
        all.push_back(fluoro_options(scene_of_pictures(dir, view.set), std::filesystem::exists(dir / "scene.toml")));
        apply(view, all.back());
    }
    return render_fluoro(dir, all, progress);
}

}  // namespace seldinger
