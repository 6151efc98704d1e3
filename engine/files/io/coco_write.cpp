// Runs, their text, and the JSON around them.
#include "io/coco_write.h"

#include "core/check.h"
#include "io/json_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace seldinger {
namespace {

using Json = nlohmann::ordered_json;

/// Three numbers for each point; a point outside the picture counts as not labelled, as in COCO.
void add_point(const CocoPoint& point, Json& list)
{
    list.push_back(point.visible ? point.column : 0.0);
    list.push_back(point.visible ? point.row : 0.0);
    list.push_back(point.visible ? 2 : 0);
}

}  // namespace

std::vector<std::uint32_t> label_runs(std::span<const std::uint8_t> mask, int width, int height, std::uint8_t label)
{
    SEL_ASSERT(mask.size() == static_cast<std::size_t>(width) * height);
    std::vector<std::uint32_t> runs;
    std::uint32_t length = 0;
    bool inside = false;
    for (int column = 0; column < width; ++column)
        for (int row = 0; row < height; ++row) {
            if ((mask[static_cast<std::size_t>(row) * width + column] == label) != inside)
                runs.push_back(length), length = 0, inside = !inside;
            ++length;
        }
    runs.push_back(length);
    return runs;
}

std::string coco_text(std::span<const std::uint32_t> runs)
{
    std::string text;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        std::int64_t x = runs[i];
        if (i > 2) x -= runs[i - 2];
        for (bool more = true; more;) {
            auto letter = static_cast<char>(x & 0x1f);
            x >>= 5;
            more = (letter & 0x10) ? x != -1 : x != 0;
            if (more) letter = static_cast<char>(letter | 0x20);
            text += static_cast<char>(letter + 48);
        }
    }
    return text;
}

int CocoWriter::category(const std::string& name)
{
    const auto found = std::find(categories_.begin(), categories_.end(), name);
    if (found != categories_.end()) return static_cast<int>(found - categories_.begin()) + 1;
    categories_.push_back(name);
    return static_cast<int>(categories_.size());
}

int CocoWriter::add_image(const std::string& file, int width, int height)
{
    images_.push_back({file, width, height});
    return static_cast<int>(images_.size());
}

void CocoWriter::add(int category, std::span<const std::uint8_t> mask, std::uint8_t label, const CocoPoint& tip,
                     const CocoPoint& base)
{
    const Image& image = images_.back();
    const std::vector<std::uint32_t> runs = label_runs(mask, image.width, image.height, label);
    Annotation a{static_cast<int>(images_.size()), category, coco_text(runs), 0, {}, tip, base};
    int low[2] = {image.width, image.height}, high[2] = {-1, -1};
    std::uint64_t at = 0;
    for (std::size_t k = 0; k < runs.size(); at += runs[k], ++k) {
        if (k % 2 == 0 || runs[k] == 0) continue;
        const std::uint64_t last = at + runs[k] - 1, tall = static_cast<std::uint64_t>(image.height);
        a.area += runs[k];
        low[0] = std::min(low[0], static_cast<int>(at / tall)), high[0] = std::max(high[0], static_cast<int>(last / tall));
        const bool wraps = at / tall != last / tall;  // from a column into the next: every row may be in it
        low[1] = std::min(low[1], wraps ? 0 : static_cast<int>(at % tall));
        high[1] = std::max(high[1], wraps ? image.height - 1 : static_cast<int>(last % tall));
    }
    if (a.area == 0) return;
    a.box[0] = low[0], a.box[1] = low[1], a.box[2] = high[0] - low[0] + 1, a.box[3] = high[1] - low[1] + 1;
    annotations_.push_back(std::move(a));
}

std::string CocoWriter::finish() const
{
    Json out;
    out["info"] = {{"description", "seldinger"}, {"version", SELDINGER_VERSION}};
    out["licenses"] = Json::array();
    out["images"] = out["annotations"] = out["categories"] = Json::array();
    for (std::size_t k = 0; k < images_.size(); ++k)
        out["images"].push_back(
            {{"id", k + 1}, {"file_name", images_[k].file}, {"width", images_[k].width}, {"height", images_[k].height}});
    for (std::size_t k = 0; k < annotations_.size(); ++k) {
        const Annotation& a = annotations_[k];
        const Image& image = images_[static_cast<std::size_t>(a.image) - 1];
        Json one;
        one["id"] = k + 1, one["image_id"] = a.image, one["category_id"] = a.category;
        one["segmentation"] = {{"size", {image.height, image.width}}, {"counts", a.runs}};
        one["area"] = a.area, one["bbox"] = a.box, one["iscrowd"] = 0;
        one["keypoints"] = Json::array();
        add_point(a.tip, one["keypoints"]), add_point(a.base, one["keypoints"]);
        one["num_keypoints"] = a.tip.visible + a.base.visible;
        out["annotations"].push_back(std::move(one));
    }
    for (std::size_t k = 0; k < categories_.size(); ++k)
        out["categories"].push_back({{"id", k + 1},
                                     {"name", categories_[k]},
                                     {"supercategory", "instrument"},
                                     {"keypoints", {"tip", "base"}},
                                     {"skeleton", Json::array({Json::array({1, 2})})}});
    return json_text(out) + "\n";
}

}  // namespace seldinger
