// seldinger render DIR --view fluoro: the C-arm of the command line over that of the run's scene.

#include "render_fluoro.h"

#include "command_line.h"
#include "commands.h"

#include <fmt/format.h>

#include <cmath>

#ifdef SEL_WITH_VIEW
    #include "fluoro_scene.h"
    #include "scene/run_scene.h"
#endif
#include "core/note.h"
#include "batch/sweep.h"

namespace seldinger::apps {

void FluoroArguments::declare(CommandLine& command)
{
    command.add_option("--c-arm", c_arm, "fluoro: position of the detector, e.g. \"LAO 30, CRA 15\"; repeat it for several views of each frame")
        ->type_name("ANGLES")
        ->allow_extra_args(false);
    command.add_option("--views", views, "fluoro: a view for each run of this sweep of carm.lao_deg, carm.cra_deg and other [carm] and [contrast] keys")
        ->type_name("VIEWS.toml");
    command.add_option("--sid", sid, "fluoro: source to detector [m] (default 1.2)")->type_name("M");
    command.add_option("--sod", sod, "fluoro: source to isocentre [m] (default 0.8)")->type_name("M");
    command.add_option("--field", field, "fluoro: width of the detector [m] (default 0.3)")->type_name("M");
    command.add_option("--kvp", kvp, "fluoro: tube voltage [kV], 40 to 150 (default 75)")->type_name("KV");
    command.add_option("--kev", kev, "fluoro: one energy [keV] in place of a spectrum, 5 to 200")->type_name("KEV");
    command.add_option("--photons", photons, "fluoro: photons per pixel of the unattenuated beam (default 1e5)")->type_name("N");
    command.add_option("--blur", blur, "fluoro: blur on the detector, standard deviation [m] (default 2e-4)")->type_name("M");
    command.add_option("--body", body, "fluoro: body around the vessel: ellipsoid or none")
        ->check(one_of({"ellipsoid", "none"}))
        ->type_name("SHAPE");
    command.add_option("--seed", seed, "fluoro: seed of the noise (default: the scene's)")->type_name("N");
    command.add_option("--mask", mask, "fluoro: subtract the picture of this run without contrast (may be the same run)")
        ->type_name("DIR");
    command.add_option("--raw", raw, "fluoro: write -ln(I/I0) as float32 [rows, columns], without noise and blur")
        ->type_name("FILE.npy");
    command.add_option("--dicom", dicom, "fluoro: write a DICOM X-ray angiographic image")->type_name("FILE.dcm");
    command.add_flag("--no-noise", no_noise, "fluoro: without quantum noise");
    command.add_flag("--no-contrast", no_contrast, "fluoro: without the scene's [contrast]");
    command.add_flag("--log", logarithmic, "fluoro: grey levels by the logarithm of the signal");
}

std::string FluoroArguments::first_given() const
{
    const std::pair<const char*, bool> all[] = {{"--c-arm", !c_arm.empty()},
                                                {"--views", !views.empty()},
                                                {"--sid", sid.has_value()},
                                                {"--sod", sod.has_value()},
                                                {"--field", field.has_value()},
                                                {"--kvp", kvp.has_value()},
                                                {"--kev", kev.has_value()},
                                                {"--photons", photons.has_value()},
                                                {"--blur", blur.has_value()},
                                                {"--body", body.has_value()},
                                                {"--seed", seed.has_value()},
                                                {"--mask", mask.has_value()},
                                                {"--raw", !raw.empty()},
                                                {"--dicom", !dicom.empty()},
                                                {"--no-noise", no_noise},
                                                {"--no-contrast", no_contrast},
                                                {"--log", logarithmic}};
    for (const auto& [name, given] : all)
        if (given) return name;
    return {};
}

std::size_t FluoroArguments::view_count() const
{
    // the number of values does not depend on the seed that they are drawn with
    return views.empty() ? std::max<std::size_t>(c_arm.size(), 1) : read_sweep(views, 0).run_count();
}

#ifdef SEL_WITH_VIEW
namespace {

namespace fs = std::filesystem;

/// The run's scene; if its mesh has gone, the wall that the run wrote replaces it.
Scene scene_of(const fs::path& dir, std::vector<std::string> overrides = {})
{
    const Folder run(dir);
    if (!run.has("scene.toml")) return {};
    try {
        return read_run_scene(run, overrides);
    } catch (const Error& error) {
        if (error.code() != ExitCode::BadFile || !run.has("vessel.vtp")) throw;
    }
    overrides.insert(overrides.end(), {"vessel.mesh=\"vessel.vtp\"", "vessel.units=\"m\""});
    return read_run_scene(run, overrides);
}

double in_range(const char* option, double value, double low, double high, const char* what)
{
    if (!(value >= low && value <= high))
        throw Error(ExitCode::BadScene, fmt::format("{}: got {}; expected {} from {} to {}", option, value, what, low, high));
    return value;
}

void apply(const FluoroArguments& a, FluoroOptions& o)
{
    if (a.kvp && a.kev) throw Error(ExitCode::BadScene, "--kvp and --kev: a spectrum or one energy; give one of the two");
    if (a.c_arm.size() == 1) o.turning.clear(), set_angles(o.arm, a.c_arm.front());
    if (a.sid) o.arm.sid = *a.sid;
    if (a.sod) o.arm.sod = *a.sod;
    if (a.field) o.arm.field = *a.field;
    if (a.kvp) o.kvp = in_range("--kvp", *a.kvp, 40, 150, "kilovolts");
    if (a.kev) o.kev = in_range("--kev", *a.kev, 5, 200, "kiloelectronvolts");
    if (a.photons) o.photons = in_range("--photons", *a.photons, 1, 1e12, "photons per pixel");
    if (a.blur) o.blur = in_range("--blur", *a.blur, 0, 0.01, "metres");
    if (a.body) o.body = *a.body == "none" ? Vec3(Vec3::Zero()) : o.body.isZero() ? SceneCArm().body_axes : o.body;
    if (a.seed) o.seed = static_cast<std::uint64_t>(*a.seed);
    if (a.mask) o.mask = *a.mask;
    o.raw = a.raw, o.dicom = a.dicom;
    o.noise = !a.no_noise, o.logarithmic = a.logarithmic;
    if (a.no_contrast) o.contrast.reset();
}

/// What a run of a sweep of views says: the angles, which a scene has as keys over time, and other keys of the scene.
FluoroOptions swept_view(const fs::path& dir, const fs::path& sweep, const std::vector<std::string>& settings)
{
    std::vector<std::string> overrides;
    std::optional<double> lao, cra;
    for (const std::string& setting : settings) {
        const std::string key = setting.substr(0, setting.find('='));
        if (key == "carm.lao_deg") lao = std::strtod(setting.c_str() + key.size() + 1, nullptr);
        else if (key == "carm.cra_deg") cra = std::strtod(setting.c_str() + key.size() + 1, nullptr);
        else if (key.starts_with("carm.") || key.starts_with("contrast.")) overrides.push_back(setting);
        else
            throw Error(ExitCode::BadScene, fmt::format("{}: \"{}\" is not of the picture; expected carm.lao_deg, carm.cra_deg or another "
                                                        "key of [carm] or [contrast]. Fix: vary other keys in a sweep of runs",
                                                        sweep.string(), key));
    }
    FluoroOptions options = fluoro_options(scene_of(dir, overrides), fs::exists(dir / "scene.toml"));
    if (lao || cra) options.turning.clear(), set_angles(options.arm, fmt::format("{}, {}", lao.value_or(0), cra.value_or(0)));
    return options;
}

std::vector<FluoroOptions> views_of(const fs::path& dir, const FluoroArguments& arguments)
{
    const Scene scene = scene_of(dir);
    const FluoroOptions plain = fluoro_options(scene, fs::exists(dir / "scene.toml"));
    std::vector<FluoroOptions> views(std::max<std::size_t>(arguments.c_arm.size(), 1), plain);
    if (!arguments.views.empty()) {
        const Sweep sweep = read_sweep(arguments.views, scene.seed);
        views.clear();
        for (std::size_t run = 0; run < sweep.run_count(); ++run)
            views.push_back(swept_view(dir, arguments.views, sweep.overrides(run)));
    }
    for (std::size_t k = 0; k < views.size(); ++k) {
        apply(arguments, views[k]);
        if (arguments.c_arm.size() > 1) views[k].turning.clear(), set_angles(views[k].arm, arguments.c_arm[k]);
    }
    return views;
}

}  // namespace
#endif

ExitCode render_fluoro_view(const std::filesystem::path& dir, const FluoroArguments& arguments, int width, int height,
                            const FrameArguments& frames)
{
#ifdef SEL_WITH_VIEW
    if (!arguments.c_arm.empty() && !arguments.views.empty())
        throw Error(ExitCode::BadScene, "--c-arm and --views: both say where the detector is; give one of the two");
    std::vector<FluoroOptions> views = views_of(dir, arguments);
    for (FluoroOptions& view : views) {
        view.arm.columns = width, view.arm.rows = height;
        static_cast<FrameChoice&>(view) = frames.choice();
    }
    FrameWatch watch;
    const PictureFiles files = render_fluoro(dir, views, watch.progress());
    if (!frames.quiet) print_files(files);
    return ExitCode::Done;
#else
    (void)dir, (void)arguments, (void)width, (void)height, (void)frames;
    throw Error(ExitCode::BadScene, "render: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

}  // namespace seldinger::apps
