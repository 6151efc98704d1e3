// From a run's folder to pictures, films and DICOM files.
#include "pictures/fluoro_run.h"

#include "core/clock.h"
#include "core/error.h"
#include "io/dicom_write.h"
#include "io/film_write.h"
#include "io/mesh_file.h"
#include "io/npz_write.h"
#include "io/png_write.h"
#include "pictures/fluorography.h"
#include "pictures/label_files.h"
#include "pictures/label_sheet.h"
#include "repair/repair.h"
#include "view/solids.h"
#include "xray/detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

namespace seldinger {
namespace {

namespace fs = std::filesystem;

/// Everything that frames are gathered in.
struct Gathered {
    std::vector<float> raw;
    AngiographicImage dicom;
    std::unique_ptr<FilmWriter> film;
};

class Session {
public:
    Session(const fs::path& dir, const FluoroOptions& options)
        : dir_(dir), options_(options), main_(dir, options, true), range_(frames_asked(options, main_.run().frames.size()))
    {
        if (options.mask) mask_ = std::make_unique<Fluorography>(*options.mask, options, false);
        for (const fs::path& file : {options.raw, options.dicom})
            if (fs::is_directory(file))
                throw Error(ErrorKind::BadFile, file.string() + ": got a folder; expected the name of a file");
        if (!options.film.empty())
            gathered_.film = std::make_unique<FilmWriter>(options.film, options.arm.columns, options.arm.rows,
                                                          film_rate(options, main_.run(), range_));
    }

    /// @param drawn  called after each frame
    void draw(LabelWarnings& warnings, PictureFiles& files, const std::function<void(std::size_t)>& drawn)
    {
        for (std::size_t i = range_.first; i <= range_.last; ++i) {
            frame(i, warnings);
            drawn(range_.count());
        }
        finish();
        files.paths.insert(files.paths.end(), written_.begin(), written_.end());
    }

    [[nodiscard]] const FrameRange& range() const { return range_; }

    void draw_on(LabelSheet& sheet, std::size_t index, const std::string& view, LabelWarnings& warnings)
    {
        const double time = main_.run().frames[index].time;
        main_.look(index, time);
        const std::vector<std::uint16_t> grey = levels(index, time);
        std::vector<std::uint8_t> rgb;
        for (const std::uint16_t g : grey) rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(g >> 4));
        const PictureTruth truth = main_.truth(false);
        warnings.take_in(truth);
        sheet.add(rgb, truth, fmt::format("{}frame {}, {}", view, index, angle_words(main_.arm())));
    }

private:
    void frame(std::size_t index, LabelWarnings& warnings)
    {
        const bool gathers = !options_.raw.empty() || !options_.dicom.empty() || gathered_.film;
        // a film or DICOM file alone needs no pictures beside it
        const bool pictures = !options_.output.empty() || !options_.labels.empty() || !gathers;
        const fs::path file = pictures ? picture_path(dir_, options_, "fluoro", "fluoro", index) : fs::path();
        const bool there = pictures && options_.resume && fs::exists(file) && labels_exist(options_, file, false);
        if (there && !gathers) return;
        const double time = main_.run().frames[index].time;
        main_.look(index, time);
        const bool labelled = pictures && !there && !options_.labels.empty();
        const PictureTruth truth = labelled ? main_.truth(options_.label_vessel) : main_.located();
        warnings.take_in(truth);
        if (labelled) write_labels(options_, file, truth);  // before its picture: where that is, they are
        if (!options_.raw.empty()) {
            const std::vector<float> raw = main_.scope().line_integrals();
            gathered_.raw.insert(gathered_.raw.end(), raw.begin(), raw.end());
        }
        if (!pictures && options_.dicom.empty() && !gathered_.film) return;
        const std::vector<std::uint16_t> grey = levels(index, time);
        if (pictures && !there) {
            write_grey_png(file, options_.arm.columns, options_.arm.rows, grey);
            written_.push_back(file);
        }
        if (gathered_.film) gathered_.film->add(grey);
        if (!options_.dicom.empty()) {
            gathered_.dicom.grey.insert(gathered_.dicom.grey.end(), grey.begin(), grey.end());
            gathered_.dicom.primary.push_back(main_.arm().primary * 180 / std::numbers::pi);
            gathered_.dicom.secondary.push_back(main_.arm().secondary * 180 / std::numbers::pi);
        }
    }

    std::vector<std::uint16_t> levels(std::size_t index, double time)
    {
        const std::vector<float>& signal = main_.picture(options_.noise_stream + 2 * index);
        if (!mask_) return grey_levels(signal, main_.scope().reference(), options_.logarithmic);
        mask_->look(std::min(index, mask_->run().frames.size() - 1), time);
        return subtracted_levels(signal, mask_->picture(options_.noise_stream + 2 * index + 1));
    }

    void finish()
    {
        const auto columns = static_cast<std::size_t>(options_.arm.columns), rows = static_cast<std::size_t>(options_.arm.rows);
        const std::size_t frames = range_.count();
        if (!options_.raw.empty()) {
            using Shape = std::vector<std::size_t>;
            make_folder_of(options_.raw);
            write_npy(options_.raw, gathered_.raw, frames == 1 ? Shape{rows, columns} : Shape{frames, rows, columns});
            written_.push_back(options_.raw);
        }
        if (!options_.dicom.empty()) {
            finish_dicom(frames);
            written_.push_back(options_.dicom);
        }
        if (gathered_.film) {
            gathered_.film->finish();
            written_.push_back(options_.film);
        }
    }

    void finish_dicom(std::size_t frames)
    {
        AngiographicImage& d = gathered_.dicom;
        d.columns = options_.arm.columns, d.rows = options_.arm.rows;
        d.sid = options_.arm.sid, d.sod = options_.arm.sod, d.pixel = options_.arm.pixel();
        d.kvp = options_.kev > 0 ? 0 : options_.kvp;
        const auto& all = main_.run().frames;
        d.frame_time = frames > 1 ? (all[range_.last].time - all[range_.first].time) / static_cast<double>(frames - 1) : 0;
        d.logarithmic = options_.logarithmic || mask_;
        d.contrast = options_.contrast.has_value();
        d.description = fmt::format("fluoroscopy of {}", fs::absolute(dir_).filename().string());
        d.identity = fmt::format("{} {} {}:{} {} {} {}", d.description, angle_words(main_.arm()), range_.first, range_.last,
                                 options_.seed, d.columns, d.rows);
        write_dicom(options_.dicom, d);
    }

    const fs::path& dir_;
    const FluoroOptions& options_;
    Fluorography main_;
    std::unique_ptr<Fluorography> mask_;
    FrameRange range_;
    Gathered gathered_;
    std::vector<fs::path> written_;
};

}  // namespace

std::vector<Material> materials_of(const std::vector<InstrumentMatter>& instruments)
{
    std::vector<Material> all;
    for (const InstrumentMatter& i : instruments) {
        all.push_back(i.shaft);
        for (const auto& s : i.stretches) all.push_back(s.material);
    }
    if (all.empty()) all.push_back(materials::stainless_steel());
    return all;
}

Device device_of(const WireLine& wire, const std::vector<InstrumentMatter>& instruments)
{
    const InstrumentMatter* what = nullptr;
    int first = 0, at = 0;  // of its materials
    for (const InstrumentMatter& i : instruments) {
        if (i.name == wire.name) what = &i, first = at;
        at += 1 + static_cast<int>(i.stretches.size());
    }
    Device device;
    double from_tip = 0;
    for (const TubeStation& s : smooth_line(wire.nodes, wire.radius)) {
        if (!device.empty()) from_tip += (s.position - device.back().place).norm();
        int material = first;
        for (std::size_t k = 0; what && k < what->stretches.size(); ++k)
            if (from_tip >= what->stretches[k].from && from_tip < what->stretches[k].to)
                material = first + 1 + static_cast<int>(k);
        device.push_back({s.position, s.radius, what ? std::min(what->lumen, s.radius) : 0.0, material, 0});
    }
    return device;
}

void turn_arm(CArm& arm, const std::vector<AngleKey>& keys, double time)
{
    if (keys.empty()) return;
    const auto next = std::find_if(keys.begin(), keys.end(), [&](const AngleKey& k) { return k.t > time; });
    const AngleKey &a = next == keys.begin() ? *next : next[-1], &b = next == keys.end() ? keys.back() : *next;
    const double s = b.t > a.t ? std::clamp((time - a.t) / (b.t - a.t), 0.0, 1.0) : 0.0;
    arm.primary = a.primary + s * (b.primary - a.primary);
    arm.secondary = a.secondary + s * (b.secondary - a.secondary);
}

Bolus make_bolus(const Centreline& centreline, const FluoroOptions::Injection& injection)
{
    BolusSpec spec = injection.bolus;
    const auto root = std::find(centreline.parent.begin(), centreline.parent.end(), -1);
    if (injection.at_auto && root != centreline.parent.end()) spec.at = centreline.points[root - centreline.parent.begin()];
    if (injection.inflow_auto) spec.inflow = spec.at;
    return Bolus(centreline, spec);
}

WallMesh load_bone(const FluoroOptions& options)
{
    WallMesh bone = read_mesh(options.bone, options.bone_units);
    (void)repair(bone);
    return bone;
}

namespace {

/// Files of view k of several.
FluoroOptions own_files(const fs::path& dir, FluoroOptions view, const FrameChoice& all, std::size_t k)
{
    static_cast<FrameChoice&>(view) = all;
    view.noise_stream = static_cast<std::uint64_t>(k) << 40;  // twice the number of a frame never gets there
    view.numbered |= all.output.empty() && all.first >= 0;
    if (view.output.empty()) view.output = dir / "fluoro.png";
    for (fs::path* file : {&view.output, &view.raw, &view.dicom, &view.film})
        if (!file->empty())
            *file = file->parent_path() / fmt::format("{}_v{}{}", file->stem().string(), k + 1, file->extension().string());
    return view;
}

/// Pictures spread evenly over all views of all frames.
void draw_sheet(const fs::path& dir, const std::vector<FluoroOptions>& views, LabelWarnings& warnings,
                const std::function<void(std::size_t)>& drawn)
{
    std::map<std::size_t, Session> sessions;  // only of views that are on the sheet
    const auto session = [&](std::size_t view) -> Session& { return sessions.try_emplace(view, dir, views[view]).first->second; };
    const FrameRange range = session(0).range();
    const std::size_t all = range.count() * views.size(), count = std::min(all, LabelSheet::most_pictures);
    LabelSheet sheet(count, views.front().arm.columns, views.front().arm.rows);
    for (std::size_t i = 0; i < count; ++i) {
        const auto [frame, view] = LabelSheet::pick(i, count, range.count(), views.size());
        session(view).draw_on(sheet, range.first + frame, views.size() > 1 ? fmt::format("v{}, ", view + 1) : "", warnings);
        drawn(count);
    }
    make_folder_of(views.front().preview);
    sheet.write(views.front().preview);
}

}  // namespace

PictureFiles render_fluoro(const fs::path& dir, const std::vector<FluoroOptions>& views, const FrameProgress& progress)
{
    for (const FluoroOptions& view : views) check(view.arm);
    const auto start = Clock::now();
    std::size_t done = 0;
    const auto drawn = [&](std::size_t all) {
        if (progress) progress(++done, all, seconds_since(start));
    };
    std::vector<FluoroOptions> own;  // outlives the sessions
    for (std::size_t k = 0; k < views.size(); ++k)
        own.push_back(views.size() > 1 ? own_files(dir, views[k], views.front(), k) : views[k]);
    PictureFiles files;
    LabelWarnings warnings;
    if (const FluoroOptions& first = views.front(); !first.preview.empty()) {
        draw_sheet(dir, own, warnings, drawn);
        files.paths.push_back(first.preview);
    } else {
        for (const FluoroOptions& view : own)
            Session(dir, view).draw(warnings, files, [&](std::size_t each) { drawn(each * views.size()); });
    }
    files.warnings = warnings.lines(!views.front().labels.empty() || !views.front().preview.empty());
    return files;
}

}  // namespace seldinger
