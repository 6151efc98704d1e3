// Picks the frames that were asked for, one camera and force scale for all, and writes their pictures.
#include "pictures/render.h"

#include "core/clock.h"
#include "core/error.h"
#include "io/film_write.h"
#include "io/png_write.h"
#include "pictures/label_files.h"
#include "pictures/label_sheet.h"
#include "scene/run_scene.h"
#include "view/frame_range.h"
#include "view/legend.h"
#include "view/run_folder.h"
#include "view/viewpoint.h"
#include "xray/mesh_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace seldinger {
namespace {

WallScale wall_scale(const RunFolder& run, const std::filesystem::path& dir, const RenderOptions& options)
{
    const double most = largest_on_wall(run, dir, *options.wall);
    // of a wall that never moved: something small, so that all of it has the colour of nothing
    const double least = *options.wall == WallQuantity::Stress ? 1.0 : 1e-6;
    const double top = options.wall_max > 0 ? options.wall_max : round_force_up(std::max(most, least));
    return {*options.wall, top, most > top};
}

Look look_of(const RenderOptions& options, const RunFolder& run, const RunReach& reach)
{
    Look look;
    look.legend = options.legend && options.labels.empty() && options.preview.empty();  // labels are of the whole picture
    look.inset = look.ruler = options.from != ViewFrom::Endoscopic;
    look.target = run.target;
    look.cube = options.from != ViewFrom::Endoscopic;
    look.head = options.patient->head, look.back = options.patient->back;
    if (options.ground != Ground::Shaded) look.background_top = look.background_bottom = 0xffffff;
    if (options.force_max > 0) look.force_scale = options.force_max;
    else if (options.load_max > 0) look.load_scale = options.load_max;
    else if (reach.load > 0) look.load_scale = round_force_up(reach.load);
    else if (reach.strongest > 0) look.force_scale = round_force_up(reach.strongest);  // of several instruments
    return look;
}

/// Red, green, blue, cover from the same picture over white and over black: what shows through is what differs.
std::vector<std::uint8_t> cut_out(const std::vector<std::uint8_t>& white, const std::vector<std::uint8_t>& black)
{
    std::vector<std::uint8_t> out(white.size() / 3 * 4);
    for (std::size_t p = 0; p < white.size() / 3; ++p) {
        int through = 0;
        for (int k = 0; k < 3; ++k) through = std::max(through, white[3 * p + k] - black[3 * p + k]);
        const int cover = 255 - std::clamp(through, 0, 255);
        out[4 * p + 3] = static_cast<std::uint8_t>(cover);
        for (int k = 0; k < 3 && cover > 0; ++k)
            out[4 * p + k] = static_cast<std::uint8_t>(std::min(255, (black[3 * p + k] * 255 + cover / 2) / cover));
    }
    return out;
}

/// A run as it is drawn, frame by frame.
class Drawing {
public:
    Drawing(const std::filesystem::path& dir, const RenderOptions& options, const RunFolder& run, RunReach reach)
        : options_(options), run_(run), renderer_(options.width, options.height, look_of(options, run, reach))
    {
        scenery_ = {&run.wall, std::move(reach.nodes), *options.patient, run.frames.front().time, run.frames.back().time};
        renderer_.set_wall(run.wall);
        if (options.wall) renderer_.set_wall_scale(wall_scale(run, dir, options));
    }

    /// 3 bytes a pixel, or 4 on a transparent ground.
    std::vector<std::uint8_t> draw(std::size_t index)
    {
        WireFrame frame = read_frame(run_, index);
        if (options_.wall) frame.wall = read_moved_wall(run_, index, *options_.wall);
        const Viewport& view = renderer_.main_view();
        const bool moves = options_.from == ViewFrom::Endoscopic || !options_.motion.keys.empty() || options_.motion.orbit != 0 ||
                           options_.motion.follow > 0;
        if (moves || !aimed_)
            renderer_.set_camera(
                frame_camera(scenery_, options_.from, options_.motion, frame, static_cast<double>(view.width) / view.height));
        aimed_ = true;
        renderer_.draw(frame);
        frame_ = frame;
        if (options_.ground != Ground::Transparent) return renderer_.pixels();
        const std::vector<std::uint8_t> white = renderer_.pixels();
        renderer_.set_background(0, 0);
        renderer_.draw(frame);
        renderer_.set_background(0xffffff, 0xffffff);
        return cut_out(white, renderer_.pixels());
    }

    /// Ground truth of the last picture.
    [[nodiscard]] PictureTruth truth() const
    {
        const std::vector<std::vector<TubeStation>> lines = renderer_.drawn_lines(frame_);
        PictureTruth truth = locate(pinhole_view(renderer_.camera(), renderer_.main_view()), frame_, lines);
        truth.fov_y = renderer_.camera().fov_y;
        add_mask(truth, lines, true);
        if (options_.label_vessel) truth.lumen = trace_mesh(truth.view, close_openings(wall())).length;
        return truth;
    }

private:
    [[nodiscard]] WallMesh wall() const
    {
        WallMesh wall = run_.wall;
        if (!frame_.wall.vertices.empty()) wall.vertices = frame_.wall.vertices;
        return wall;
    }

    const RenderOptions& options_;
    const RunFolder& run_;
    WireFrame frame_;
    Scenery scenery_;
    Renderer renderer_;
    bool aimed_ = false;
};

/// Frames spread evenly over the range.
void draw_sheet(Drawing& drawing, const RenderOptions& options, const FrameRange& range, LabelWarnings& warnings)
{
    const std::size_t count = std::min(range.count(), LabelSheet::most_pictures);
    LabelSheet sheet(count, options.width, options.height);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t index = range.first + LabelSheet::pick(i, count, range.count(), 1).frame;
        const std::vector<std::uint8_t> pixels = drawing.draw(index);
        const PictureTruth truth = drawing.truth();
        warnings.take_in(truth);
        sheet.add(pixels, truth, fmt::format("frame {}", index));
    }
    make_folder_of(options.preview);
    sheet.write(options.preview);
}

}  // namespace

PatientAxes patient_of(const std::filesystem::path& dir)
{
    const Folder run(dir);
    if (!run.has("scene.toml")) return {};
    try {
        const SceneCArm arm = read_run_scene(run).carm;
        return {arm.head.normalized(), arm.back.normalized()};
    } catch (const Error&) {  // of another version, or without its mesh: a picture needs only the run's own files
        return {};
    }
}

bool legend_fits(int width, int height) { return !lay_out_sheet(width, height, Look{}).panel_dropped; }

PictureFiles render_run(const std::filesystem::path& dir, const RenderOptions& asked, const FrameProgress& progress)
{
    const auto start = Clock::now();
    const RunFolder run = read_run_folder(dir);
    RenderOptions options = asked;
    if (!options.patient) options.patient = patient_of(dir);
    if (!options.film.empty() && options.ground == Ground::Transparent)
        throw Error(ErrorKind::BadScene, "--video: a film cannot be transparent; take --background white, or pictures");
    const FrameRange range = frames_asked(options, run.frames.size());
    const bool filmed = !options.film.empty(), pictured = !options.output.empty() || !options.labels.empty() || !filmed;

    Drawing drawing(dir, options, run, reach_of(run));
    LabelWarnings warnings;
    if (!options.preview.empty()) {
        draw_sheet(drawing, options, range, warnings);
        return {{options.preview}, warnings.lines(true)};
    }

    std::vector<std::filesystem::path> written;
    std::optional<FilmWriter> film;
    if (filmed) film.emplace(options.film, options.width, options.height, film_rate(options, run, range), FilmPixels::Rgb);
    for (std::size_t i = range.first; i <= range.last; ++i) {
        const std::filesystem::path file = pictured ? picture_path(dir, options, "picture", "frame", i) : std::filesystem::path();
        const bool there = pictured && options.resume && std::filesystem::exists(file) && labels_exist(options, file, true);
        if (!there || film) {
            const std::vector<std::uint8_t> pixels = drawing.draw(i);
            if (film) film->add(pixels);
            if (pictured && !there) {
                if (!options.labels.empty()) {
                    const PictureTruth truth = drawing.truth();
                    warnings.take_in(truth);
                    write_labels(options, file, truth);  // before the picture: where that is, they are
                }
                write_png(file, options.width, options.height, pixels);
                written.push_back(file);
            }
        }
        if (progress) progress(i - range.first + 1, range.count(), seconds_since(start));
    }
    if (film) {
        film->finish();
        written.push_back(options.film);
    }
    return {written, warnings.lines(true)};
}

}  // namespace seldinger
