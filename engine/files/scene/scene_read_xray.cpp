// [carm] and [contrast]: settings of X-ray pictures.
#include "scene/scene_read.h"

#include <cmath>

namespace seldinger {
namespace {

/// Tables of a list `keys` in their order: a key that is absent is as in the one before.
template <class Row>
void read_keys(const TableReader& t, const std::string& path, std::vector<Key> (*keys_of)(Row&), const char* form,
               std::vector<Row>& rows)
{
    if (!t.has("keys")) return;
    const toml::array* list = t.node("keys")->as_array();
    if (!list || list->empty()) t.fail("keys", std::string("expected [ ") + form + ", ... ]");
    for (const toml::node& node : *list) {
        if (!node.is_table()) fail_at(node.source(), path + ".keys", std::string("expected ") + form);
        Row row = rows.empty() ? Row{} : rows.back();
        const TableReader k(*node.as_table(), path + ".keys", keys_of(row));
        k.read(keys_of(row));
        if (!rows.empty() && row.t <= rows.back().t) k.fail("t_s", "expected times that increase; sort the keys");
        rows.push_back(row);
    }
}

void check_patient_axes(const TableReader& t, const SceneCArm& arm)
{
    if (std::abs(arm.head.normalized().dot(arm.back.normalized())) > 1e-3)
        t.fail(t.has("back") ? "back" : "head", "expected head and back at right angles; give both");
}

}  // namespace

void read_carm_table(const toml::table& table, Scene& scene)
{
    SceneCArm& arm = scene.carm;
    arm.on = true;
    const TableReader t(table, "carm", keys::carm(arm));
    t.read(keys::carm(arm), scene.source);
    arm.isocentre_auto = !t.has("isocentre");
    check_patient_axes(t, arm);
    if (arm.sod >= arm.sid)
        t.fail(t.has("sod_m") ? "sod_m" : "sid_m", "the isocentre lies between source and detector: expected sod_m below sid_m");
    read_keys(t, "carm", keys::carm_key, "{t_s = ..., lao_deg = ..., cra_deg = ...}", arm.keys);
}

void read_contrast_table(const toml::table& table, Scene& scene)
{
    SceneContrast& contrast = scene.contrast;
    contrast.on = true;
    const TableReader t(table, "contrast", keys::contrast(contrast));
    t.need("keys", "key frames of the injection");
    t.read(keys::contrast(contrast));
    contrast.at_auto = !t.has("at");
    contrast.inflow_auto = !t.has("inflow");
    read_keys(t, "contrast", keys::contrast_key, "{t_s = ..., iodine_mg_ml = ...}", contrast.keys);
    if (scene.vessel.shape == VesselShape::None) t.fail("keys", "contrast needs a [vessel] to flow in");
}

}  // namespace seldinger
