// seldinger labels DIR --coco FILE.json: a folder that `render --labels` wrote, as one file of another format.

#include "command_line.h"
#include "commands.h"
#include "core/file_io.h"
#include "core/note.h"
#include "dataset.h"
#include "io/coco_write.h"
#include "io/png_write.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

struct LabelsArguments {
    fs::path dir, coco;
    bool quiet = false;
};

fs::path mask_of(const fs::path& json) { return json.parent_path() / (json.stem().string() + "_mask.png"); }

/// NAME.json with its mask, by name.
std::vector<fs::path> label_files_in(const fs::path& dir)
{
    if (!fs::is_directory(dir))
        throw Error(ErrorKind::BadFile,
                    dir.string() + ": got no such folder; expected the one that `seldinger render --labels` wrote");
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(dir))
        if (entry.path().extension() == ".json" && fs::exists(mask_of(entry.path()))) files.push_back(entry.path());
    if (files.empty())
        throw Error(ErrorKind::BadFile,
                    dir.string() + ": no labels in it (NAME.json beside NAME_mask.png). Fix: seldinger render RUN --labels DIR");
    std::sort(files.begin(), files.end());
    return files;
}

CocoPoint point_of(const nlohmann::json& instrument, std::size_t index)
{
    const nlohmann::json& px = instrument.at("centreline_px").at(index);
    return {px.at(0).get<double>(), px.at(1).get<double>(), instrument.at("in_field").at(index).get<bool>()};
}

void add_picture(const fs::path& file, CocoWriter& coco, FieldCuts& cuts)
{
    const LabelImage mask = read_label_png(mask_of(file));
    try {
        const nlohmann::json labels = nlohmann::json::parse(read_file(file));
        const nlohmann::json& image = labels.at("image");
        if (image.at("width") != mask.width || image.at("height") != mask.height)
            throw Error(
                ErrorKind::BadFile,
                fmt::format(
                    "{}: got a mask of {} x {} pixels beside it; expected image.width x image.height. Fix: render it again",
                    file.string(), mask.width, mask.height));
        coco.add_image(image.at("file").get<std::string>(), mask.width, mask.height);
        std::uint8_t label = 0;
        for (const nlohmann::json& instrument : labels.at("instruments")) {
            const std::size_t stations = instrument.at("centreline_px").size();
            const int category = coco.category(instrument.at("name").get<std::string>());
            if (++label == 0)
                throw Error(ErrorKind::BadFile,
                            file.string() + ": got more than 255 instruments; expected 255 at most. Fix: render it again");
            if (stations == 0) continue;
            coco.add(category, mask.labels, label, point_of(instrument, 0), point_of(instrument, stations - 1));
        }
        cuts.take_in(labels.at("instruments"));
    } catch (const nlohmann::json::exception& error) {
        throw Error(
            ErrorKind::BadFile,
            fmt::format("{}: got damaged labels ({}); expected what `seldinger render --labels` writes. Fix: render it again",
                        file.string(), error.what()));
    }
}

ErrorKind labels(const LabelsArguments& options)
{
    if (fs::is_directory(options.coco))
        throw Error(ErrorKind::BadFile, options.coco.string() + ": got a folder; expected the name of a file, e.g. coco.json");
    make_folder_of(options.coco);
    write_coco(label_files_in(options.dir), options.coco, options.quiet);
    return ErrorKind::None;
}

}  // namespace

void FieldCuts::take_in(const nlohmann::json& instruments)
{
    const auto outside = [](const nlohmann::json& inside) { return !inside.get<bool>(); };
    for (const nlohmann::json& instrument : instruments) {
        const auto name = instrument.at("name").get<std::string>();
        auto of = std::find_if(cuts_.begin(), cuts_.end(), [&](const Cut& cut) { return cut.name == name; });
        if (of == cuts_.end()) of = cuts_.insert(of, Cut{name});
        const nlohmann::json& in_field = instrument.at("in_field");
        if (in_field.empty()) continue;
        ++of->pictures;
        of->cut += std::any_of(in_field.begin(), in_field.end(), outside);
        of->tip_outside += outside(in_field.at(0));
    }
}

void FieldCuts::warn() const
{
    for (const Cut& one : cuts_)
        if (one.cut > 0)
            note(fmt::format(
                "seldinger: warning: the field cuts off {}: in {} of {} pictures; its tip is outside in {}. Fix: render with a "
                "larger --field or other views\n",
                one.name, one.cut, one.pictures, one.tip_outside));
}

void write_coco(const std::vector<fs::path>& files, const FilePlace& to, bool quiet)
{
    CocoWriter coco;
    FieldCuts cuts;
    for (const fs::path& file : files) add_picture(file, coco, cuts);
    write_file(to, coco.finish());
    if (quiet) return;
    print(fmt::format("{}: {} pictures, {} annotations\n", to.path().string(), files.size(), coco.annotation_count()));
    cuts.warn();
}

void add_labels(CommandLine& app, Command& chosen)
{
    auto options = std::make_shared<LabelsArguments>();
    CommandLine* command = app.add_subcommand("labels", "convert a folder of labels (render --labels) to another format");
    command->add_option("DIR", options->dir, "folder that `render --labels` wrote")->required();
    command->add_option("--coco", options->coco, "write COCO annotations: masks as run lengths, tip and base as keypoints")
        ->required()
        ->type_name("FILE.json");
    command->add_flag("--quiet", options->quiet, "no line at the end");
    command->callback([options, &chosen] { chosen = [options] { return labels(*options); }; });
}

}  // namespace seldinger::apps
