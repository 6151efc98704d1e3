// Angles to radians, densities to materials.
#ifdef SEL_WITH_VIEW
#include "fluoro_scene.h"

#include <numbers>

namespace seldinger::apps {
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

}  // namespace seldinger::apps
#endif
