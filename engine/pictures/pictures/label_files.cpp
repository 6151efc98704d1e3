// Writes the ground truth of a picture as JSON, PNG and NPY.
#include "pictures/label_files.h"

#include "core/file_io.h"
#include "io/json_text.h"
#include "io/npz_write.h"
#include "io/png_write.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace seldinger {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
Json to_json(const PixelPoint& p) { return {p.column, p.row}; }
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json camera_json(const PictureTruth& truth)
{
    const CArmView& view = truth.view;
    Json camera;
    camera["projection"] = projection_of(view);
    camera["source_m"] = to_json(view.source);
    camera["right"] = to_json(view.right);
    camera["up"] = to_json(view.up);
    camera["towards_detector"] = to_json(view.direction);
    if (!truth.arm) {
        camera["fov_y_deg"] = truth.fov_y * 180 / std::numbers::pi;
        return camera;
    }
    camera["sid_m"] = view.sid, camera["sod_m"] = view.sod;
    camera["primary_deg"] = truth.arm->primary * 180 / std::numbers::pi;
    camera["secondary_deg"] = truth.arm->secondary * 180 / std::numbers::pi;
    return camera;
}

Json instrument_json(const InstrumentTruth& of, bool contacts_known)
{
    Json out;
    out["name"] = of.name;
    out["radius_m"] = of.radius;
    const bool there = !of.centreline.empty();
    out["tip_m"] = there ? to_json(of.centreline.front()) : Json(nullptr);
    out["tip_px"] = there ? to_json(of.pixels.front()) : Json(nullptr);
    Json centreline = Json::array(), pixels = Json::array(), in_field = Json::array(), contacts = Json::array();
    for (const Vec3& p : of.centreline) centreline.push_back(to_json(p));
    for (const PixelPoint& p : of.pixels) pixels.push_back(to_json(p)), in_field.push_back(p.in_field);
    for (const ContactTruth& c : of.contacts) {
        Json one;
        one["position_m"] = to_json(c.position), one["position_px"] = to_json(c.pixel), one["force_n"] = to_json(c.force);
        contacts.push_back(std::move(one));
    }
    out["centreline_m"] = std::move(centreline);
    out["centreline_px"] = std::move(pixels);
    out["in_field"] = std::move(in_field);
    out["hand_force_n"] = number(of.hand_force);
    out["hand_torque_nm"] = number(of.hand_torque);
    out["contacts"] = contacts_known ? std::move(contacts) : Json(nullptr);
    return out;
}

/// Micrometres, 16 bits.
std::vector<std::uint16_t> micrometres(const std::vector<float>& metres)
{
    std::vector<std::uint16_t> out(metres.size());
    for (std::size_t k = 0; k < out.size(); ++k)
        out[k] = static_cast<std::uint16_t>(std::lround(std::clamp(1e6 * static_cast<double>(metres[k]), 0.0, 65535.0)));
    return out;
}

std::string name_of(const fs::path& picture, const char* ending) { return picture.stem().string() + ending; }

bool is_there(const FrameChoice& choice, const std::string& name)
{
    if (choice.labels_in.empty()) return fs::exists(choice.labels / name);
    return Folder(choice.labels_in).has_below(choice.labels / name);
}

/// Made where there is none.
Folder open_labels(const FrameChoice& choice)
{
    if (choice.labels_in.empty()) {
        make_folder(choice.labels);
        return choice.labels;
    }
    Folder at(choice.labels_in);
    for (const fs::path& part : choice.labels) at = at.make(part.string());
    return at;
}

}  // namespace

std::string label_json(const PictureTruth& truth, const std::string& picture)
{
    Json out;
    out["time_s"] = number(truth.time);
    out["step"] = truth.step < 0 ? Json(nullptr) : Json(truth.step);
    out["image"] = {{"file", picture}, {"width", truth.view.columns}, {"height", truth.view.rows}};
    if (truth.arm) out["image"]["pixel_m"] = truth.view.pixel;
    out["camera"] = camera_json(truth);
    out["instruments"] = Json::array();
    for (const InstrumentTruth& of : truth.instruments) out["instruments"].push_back(instrument_json(of, truth.contacts_known));
    return json_text(out) + "\n";
}

bool labels_exist(const FrameChoice& choice, const fs::path& picture, bool depth)
{
    return choice.labels.empty() ||
           (is_there(choice, name_of(picture, ".json")) && is_there(choice, name_of(picture, "_mask.png")) &&
            (!depth || is_there(choice, name_of(picture, "_depth.npy"))) &&
            (!choice.label_vessel || is_there(choice, name_of(picture, "_lumen.png"))));
}

void write_labels(const FrameChoice& choice, const fs::path& picture, const PictureTruth& truth)
{
    const Folder folder = open_labels(choice);
    const int columns = truth.view.columns, rows = truth.view.rows;
    write_label_png(folder / name_of(picture, "_mask.png"), columns, rows, truth.mask);
    if (!truth.lumen.empty()) write_label_png(folder / name_of(picture, "_lumen.png"), columns, rows, micrometres(truth.lumen));
    if (!truth.depth.empty())
        write_npy(folder / name_of(picture, "_depth.npy"), truth.depth,
                  {static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)});
    write_file(folder / name_of(picture, ".json"), label_json(truth, picture.filename().string()));
}

}  // namespace seldinger
