// [carm] and [contrast]: settings of X-ray pictures.
#include "scene/scene_read.h"

#include <Eigen/Geometry>

#include <cmath>

namespace seldinger {
namespace {

constexpr Range kilovolts{40, 150, false, false, "a tube voltage from 40 to 150 kV"};

/// Tables of a list `keys` in their order. @param read  fills one key from its table
template <class Key, class Read>
void read_keys(const TableReader& t, const std::string& path, std::initializer_list<std::string_view> known, const char* form,
               std::vector<Key>& keys, const Read& read)
{
    if (!t.has("keys")) return;
    const toml::array* list = t.node("keys")->as_array();
    if (!list || list->empty()) t.fail("keys", std::string("expected [ ") + form + ", ... ]");
    for (const toml::node& node : *list) {
        if (!node.is_table()) fail_at(node.source(), path + ".keys", std::string("expected ") + form);
        const TableReader k(*node.as_table(), path + ".keys", known);
        Key key = keys.empty() ? Key{} : keys.back();
        k.need("t_s");
        k.number("t_s", key.t, not_negative);
        if (!keys.empty() && key.t <= keys.back().t) k.fail("t_s", "expected times that increase; sort the keys");
        read(k, key);
        keys.push_back(key);
    }
}

void read_patient_axes(const TableReader& t, SceneCArm& arm)
{
    t.direction("head", arm.head);
    t.direction("back", arm.back);
    if (std::abs(arm.head.normalized().dot(arm.back.normalized())) > 1e-3)
        t.fail(t.has("back") ? "back" : "head", "expected head and back at right angles; give both");
}

}  // namespace

void read_carm_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "carm",
                        {"isocentre", "head", "back", "sid_m", "sod_m", "field_m", "kvp", "photons", "blur_m", "body", "body_m",
                         "bone", "bone_units", "keys"});
    SceneCArm& arm = scene.carm;
    arm.on = true;
    arm.isocentre_auto = !t.vector("isocentre", arm.isocentre);
    read_patient_axes(t, arm);
    t.number("sid_m", arm.sid, {0, 10, true, false, "a distance above 0, at most 10 m"});
    t.number("sod_m", arm.sod, {0, 10, true, false, "a distance above 0, at most 10 m"});
    if (arm.sod >= arm.sid)
        t.fail(t.has("sod_m") ? "sod_m" : "sid_m", "the isocentre lies between source and detector: expected sod_m below sid_m");
    t.number("field_m", arm.field, {0, 2, true, false, "a detector's width above 0, at most 2 m"});
    t.number("kvp", arm.kvp, kilovolts);
    t.number("photons", arm.photons, {1, 1e12, false, false, "photons per pixel from 1 to 1e12"});
    t.number("blur_m", arm.blur, {0, 0.01, false, false, "a length from 0 to 0.01 m"});
    t.choice("body", arm.body, body_words);
    t.vector("body_m", arm.body_axes);
    if (!(arm.body_axes.minCoeff() > 0)) t.fail("body_m", "expected three half axes above 0 [m]");
    if (t.has("bone")) arm.bone = existing_file(t, "bone", scene);
    const int unit = t.word_index("bone_units", unit_words);
    if (unit >= 0) arm.bone_units = unit_words[unit];
    read_keys(t, "carm", {"t_s", "lao_deg", "cra_deg"}, "{t_s = ..., lao_deg = ..., cra_deg = ...}", arm.keys,
              [](const TableReader& k, CArmKey& key) {
                  k.number("lao_deg", key.lao_deg, {-180, 180, false, false, "degrees from -180 (RAO) to 180 (LAO)"});
                  k.number("cra_deg", key.cra_deg, {-90, 90, false, false, "degrees from -90 (CAU) to 90 (CRA)"});
              });
}

void read_contrast_table(const toml::table& table, Scene& scene)
{
    const TableReader t(table, "contrast", {"at", "inflow", "speed_m_s", "spread", "keys"});
    SceneContrast& contrast = scene.contrast;
    contrast.on = true;
    contrast.at_auto = !t.vector("at", contrast.at);
    contrast.inflow_auto = !t.vector("inflow", contrast.inflow);
    t.number("speed_m_s", contrast.speed, {0, 10, true, false, "a speed above 0, at most 10 m/s"});
    t.number("spread", contrast.spread, {0, 1, false, false, "a number from 0 to 1"});
    t.need("keys", "key frames of the injection");
    read_keys(
        t, "contrast", {"t_s", "iodine_mg_ml"}, "{t_s = ..., iodine_mg_ml = ...}", contrast.keys,
        [](const TableReader& k, ContrastKey& key) {
            k.number("iodine_mg_ml", key.iodine, {0, 500, false, false, "milligrams of iodine per millilitre from 0 to 500"});
        });
    if (scene.vessel.shape == VesselShape::None) t.fail("keys", "contrast needs a [vessel] to flow in");
}

}  // namespace seldinger
