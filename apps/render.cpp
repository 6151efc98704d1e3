// seldinger render DIR [--view front|...|endoscopic|fluoro] [--camera MOVE] [--background white|transparent] [--no-legend] [-o
// FILE]
//                  [--video FILE] [--size 1280x720] [--frames A:B] [--wall displacement | stress [--wall-max 1.5mm]] [--force-max
//                  50mN]

#include "command_line.h"
#include "commands.h"
#include "core/child_process.h"
#include "core/note.h"
#include "core/parallel.h"
#include "quantity.h"
#include "render_fluoro.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>

#ifdef SEL_WITH_VIEW
    #include "pictures/render.h"
    #include "view/model_export.h"
#endif

namespace seldinger::apps {
namespace {

struct RenderArguments {
    std::filesystem::path dir;
    std::string size, wall, wall_max, force_max, camera, background, gltf, usd, view = "shaded";
    bool no_legend = false;
    FrameArguments frames;
    FluoroArguments fluoro;
};

#ifdef SEL_WITH_VIEW
void set_wall(const RenderArguments& options, RenderOptions& what)
{
    if (options.wall.empty() && !options.wall_max.empty())
        throw Error(ErrorKind::BadScene,
                    "--wall-max: got no --wall; expected displacement or stress. Fix: give --wall displacement or --wall stress");
    if (options.wall.empty()) return;
    const bool stress = options.wall == "stress";
    what.wall = stress ? WallQuantity::Stress : WallQuantity::Displacement;
    if (!options.wall_max.empty())
        what.wall_max = stress ? parse_pressure("--wall-max", options.wall_max) : parse_length("--wall-max", options.wall_max);
}

void set_look(const RenderArguments& options, RenderOptions& what)
{
    static const std::map<std::string, ViewFrom> views = {
        {"shaded", ViewFrom::Auto}, {"front", ViewFrom::Front},   {"back", ViewFrom::Back},
        {"left", ViewFrom::Left},   {"side", ViewFrom::Left},     {"right", ViewFrom::Right},
        {"top", ViewFrom::Top},     {"bottom", ViewFrom::Bottom}, {"endoscopic", ViewFrom::Endoscopic}};
    what.from = views.at(options.view);
    if (!options.camera.empty() && what.from == ViewFrom::Endoscopic)
        throw Error(ErrorKind::BadScene,
                    "--camera: the endoscopic view already moves with the tip. Fix: leave one of the two out");
    const bool labelled = !what.labels.empty() || !what.preview.empty();
    if (labelled && what.from == ViewFrom::Endoscopic)
        throw Error(ErrorKind::BadScene, "--labels: the endoscopic view looks out of an instrument. Fix: take another --view");
    if (!what.preview.empty() && options.background == "transparent")
        throw Error(ErrorKind::BadScene, "--preview: a sheet is not transparent. Fix: leave out --background transparent");
    if (!options.camera.empty()) what.motion = parse_motion(options.camera);
    if (options.background == "white") what.ground = Ground::White;
    if (options.background == "transparent") what.ground = Ground::Transparent;
    what.legend = !options.no_legend;
    const auto per_length = options.force_max.find('/') != std::string::npos;
    if (per_length) what.load_max = parse_load("--force-max", options.force_max);
    else if (!options.force_max.empty()) what.force_max = parse_force("--force-max", options.force_max);
}

/// All frames unless some are asked for.
ErrorKind export_model(const RenderArguments& options, RenderOptions& what)
{
    if (!what.labels.empty() || !what.preview.empty())
        throw Error(ErrorKind::BadScene,
                    "--labels, --preview: of a picture; --gltf and --usd write none. Fix: run render once for each");
    const RunFolder run = read_run_folder(options.dir);
    if (what.first < 0) what.first = 0, what.last = static_cast<int>(run.frames.size()) - 1;
    const AnimatedModel model = animated_model(run, frames_asked(what, run.frames.size()), patient_of(options.dir));
    std::vector<std::filesystem::path> written;
    for (const auto& [file, write] : {std::pair{options.gltf, &write_gltf}, std::pair{options.usd, &write_usd}}) {
        if (file.empty()) continue;
        if (std::filesystem::is_directory(file))
            throw Error(ErrorKind::BadFile, file + ": got a folder; expected the name of a file");
        write(file, model);
        written.emplace_back(file);
    }
    if (!options.frames.quiet) print_files({written, {}});
    return ErrorKind::None;
}
#endif

ErrorKind render(const RenderArguments& options)
{
    if (options.frames.parent > 0) end_with_parent(options.frames.parent, SIGTERM);
    if (!options.frames.farm.empty()) check_farm_of(options.frames.farm, options.dir);
    set_thread_count(options.frames.threads);
    const bool fluoro = options.view == "fluoro";
    const std::string alien = options.fluoro.first_given();
    if (!fluoro && !alien.empty()) throw Error(ErrorKind::BadScene, alien + ": is an option of --view fluoro; give that too");
    if (fluoro && !options.wall.empty())
        throw Error(ErrorKind::BadScene, "--wall: an X-ray picture has no colours. Fix: leave out --view fluoro");
    if (fluoro && (!options.camera.empty() || !options.background.empty() || !options.force_max.empty() || options.no_legend))
        throw Error(ErrorKind::BadScene,
                    "--camera, --background, --force-max, --no-legend: not for an X-ray picture. Fix: leave out --view fluoro");
    const auto [width, height] = two_numbers(options.size.empty() ? fluoro ? "1024x1024" : "1280x720" : options.size, 'x',
                                             "--size", "WIDTHxHEIGHT in pixels, e.g. 1280x720,");
    if (fluoro) return render_fluoro_view(options.dir, options.fluoro, width, height, options.frames);
#ifdef SEL_WITH_VIEW
    RenderOptions what;
    what.width = width;
    what.height = height;
    static_cast<FrameChoice&>(what) = options.frames.choice();
    set_wall(options, what);
    set_look(options, what);
    if (!options.gltf.empty() || !options.usd.empty()) return export_model(options, what);
    FrameWatch watch;
    const PictureFiles files = render_run(options.dir, what, watch.progress());
    if (options.frames.quiet) return ErrorKind::None;
    print_files(files);
    if (what.legend && what.labels.empty() && what.preview.empty() && !legend_fits(width, height))
        note(fmt::format("seldinger: note: {}x{} is too small for scale and legend (from 400x288 or 288x360)\n", width, height));
    return ErrorKind::None;
#else
    (void)width, (void)height;
    throw Error(ErrorKind::BadScene, "render: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

}  // namespace

namespace {

std::shared_ptr<RenderArguments> declare_render(CommandLine& app, CommandLine*& command)
{
    auto options = std::make_shared<RenderArguments>();
    command = app.add_subcommand("render", "draw the frames of a run, without a display");
    command->add_option("DIR", options->dir, "folder of a run")->required();
    command->add_option("--size", options->size, "size of the picture in pixels (default 1280x720; fluoro 1024x1024)")
        ->type_name("WxH");
    command
        ->add_option("--camera", options->camera,
                     "moving camera: orbit [DEG], follow [60mm], or keys \"0s 0 0; 2s 90 20 1.5\" (time, "
                     "azimuth, elevation in degrees, zoom)")
        ->type_name("MOVE");
    command->add_option("--background", options->background, "background: white or transparent (default: a light shade)")
        ->check(one_of({"white", "transparent"}))
        ->type_name("GROUND");
    command->add_flag("--no-legend", options->no_legend, "leave out legend and scales");
    command->add_option("--gltf", options->gltf, "the frames as one animated model, in place of pictures: binary glTF")
        ->type_name("FILE.glb");
    command->add_option("--usd", options->usd, "the frames as one animated model, in place of pictures: USD")
        ->type_name("FILE.usda");
    options->frames.declare(*command);
    command->add_option("--wall", options->wall, "draw the deformed elastic wall in colours: displacement or stress")
        ->check(one_of({"displacement", "stress"}))
        ->type_name("WHAT");
    command
        ->add_option("--wall-max", options->wall_max,
                     "top of the wall's colour scale (default: a round number above the run's largest value)")
        ->type_name("1.5mm|80kPa");
    command
        ->add_option("--force-max", options->force_max,
                     "top of the colour scale of contact force per length, or per contact (default: a round number above the "
                     "run's largest value)")
        ->type_name("20mN/mm|50mN");
    command
        ->add_option("--view", options->view,
                     "side of the patient: front, back, left (side), right, top, bottom; endoscopic: from the tip; fluoro: an "
                     "X-ray (default: where the vessel is widest)")
        ->check(one_of({"shaded", "front", "back", "left", "side", "right", "top", "bottom", "endoscopic", "fluoro"}))
        ->type_name("VIEW");
    options->fluoro.declare(*command);
    return options;
}

}  // namespace

std::vector<std::string> files_of_frame(const std::vector<std::string>& words)
{
    CommandLine app("", "seldinger");
    CommandLine* command = nullptr;
    const std::shared_ptr<RenderArguments> options = declare_render(app, command);
    std::vector<std::string> all = {"render", "."};
    all.insert(all.end(), words.begin(), words.end());
    if (const CommandLine::Parsed parsed = app.parse(std::move(all)); !parsed.error.empty())
        throw Error(ErrorKind::BadScene, parsed.error + "; see `seldinger render --help`");
    FrameArguments& frames = options->frames;
    for (const auto& [option, given] :
         std::initializer_list<std::pair<const char*, const std::string&>>{{"--gltf", options->gltf},
                                                                           {"--usd", options->usd},
                                                                           {"--frames", frames.frames},
                                                                           {"-o", frames.output},
                                                                           {"--video", frames.video},
                                                                           {"--preview", frames.preview},
                                                                           {"--farm", frames.farm},
                                                                           {"--raw", options->fluoro.raw},
                                                                           {"--dicom", options->fluoro.dicom}})
        if (!given.empty())
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: a farm makes only numbered pictures and their labels. Fix: leave it out (a film: "
                                    "farm merge DIR --video FILE.mp4)",
                                    option));
#ifdef SEL_WITH_VIEW
    frames.farm = ".";
    (void)frames.choice();
#endif
    const std::size_t views = options->view == "fluoro" ? options->fluoro.view_count() : 1;
    const std::string labels = options->frames.labels;
    std::vector<std::string> files;
    for (std::size_t k = 1; k <= views; ++k) {
        const std::string stem = views > 1 ? fmt::format("frame_v{}_######", k) : "frame_######";
        files.push_back(stem + ".png");
        if (labels.empty()) continue;
        for (const char* ending : {".json", "_mask.png"})
            files.push_back((std::filesystem::path(labels) / (stem + ending)).string());
        if (options->frames.label_vessel) files.push_back((std::filesystem::path(labels) / (stem + "_lumen.png")).string());
        if (options->view != "fluoro") files.push_back((std::filesystem::path(labels) / (stem + "_depth.npy")).string());
    }
    return files;
}

void add_render(CommandLine& app, Command& chosen)
{
    CommandLine* command = nullptr;
    const std::shared_ptr<RenderArguments> options = declare_render(app, command);
    command->callback([options, &chosen] { chosen = [options] { return render(*options); }; });
}

}  // namespace seldinger::apps
