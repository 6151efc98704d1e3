// seldinger render DIR --view fluoro: options of the command line, views of a sweep.

#include "render_fluoro.h"

#include "command_line.h"
#include "commands.h"

#include <fmt/format.h>

#include <cstdlib>

#ifdef SEL_WITH_VIEW
    #include "pictures/fluoro_scene.h"
#endif
#include "core/note.h"
#include "batch/sweep.h"

namespace seldinger::apps {

void FluoroArguments::declare(CommandLine& command)
{
    command
        .add_option("--c-arm", arms,
                    "fluoro: position of the detector, e.g. \"LAO 30, CRA 15\"; repeat it for several views of each frame")
        ->type_name("ANGLES")
        ->allow_extra_args(false);
    command
        .add_option(
            "--views", views,
            "fluoro: a view for each run of this sweep of carm.lao_deg, carm.cra_deg and other [carm] and [contrast] keys")
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
    const std::pair<const char*, bool> all[] = {{"--c-arm", !arms.empty()},
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
    return views.empty() ? std::max<std::size_t>(arms.size(), 1) : read_sweep(views, 0).run_count();
}

#ifdef SEL_WITH_VIEW
namespace {

namespace fs = std::filesystem;

/// What a run of a sweep of views says: the angles, which a scene has as keys over time, and other keys of the scene.
XrayOptions swept_view(XrayOptions view, const fs::path& sweep, const std::vector<std::string>& settings)
{
    std::optional<double> lao, cra;
    for (const std::string& setting : settings) {
        const std::string key = setting.substr(0, setting.find('='));
        if (key == "carm.lao_deg") lao = std::strtod(setting.c_str() + key.size() + 1, nullptr);
        else if (key == "carm.cra_deg") cra = std::strtod(setting.c_str() + key.size() + 1, nullptr);
        else if (key.starts_with("carm.") || key.starts_with("contrast.")) view.set.push_back(setting);
        else
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: \"{}\" is not of the picture; expected carm.lao_deg, carm.cra_deg or another "
                                    "key of [carm] or [contrast]. Fix: vary other keys in a sweep of runs",
                                    sweep.string(), key));
    }
    if (lao || cra) view.c_arm = fmt::format("{}, {}", lao.value_or(0), cra.value_or(0));
    return view;
}

std::vector<XrayOptions> views_of(const fs::path& dir, const FluoroArguments& arguments, const XrayOptions& plain)
{
    std::vector<XrayOptions> views;
    for (const std::string& angles : arguments.arms) {
        views.push_back(plain);
        views.back().c_arm = angles;
    }
    if (!arguments.views.empty()) {
        const Sweep sweep = read_sweep(arguments.views, scene_of_pictures(dir).seed);
        for (std::size_t k = 0; k < sweep.run_count(); ++k)
            views.push_back(swept_view(plain, arguments.views, sweep.overrides(k)));
    }
    if (views.empty()) views.push_back(plain);
    return views;
}

}  // namespace
#endif

ErrorKind render_fluoro_view(const std::filesystem::path& dir, const FluoroArguments& arguments, int width, int height,
                            const FrameArguments& frames)
{
#ifdef SEL_WITH_VIEW
    if (!arguments.arms.empty() && !arguments.views.empty())
        throw Error(ErrorKind::BadScene, "--c-arm and --views: both say where the detector is; give one of the two");
    XrayOptions plain = arguments;
    static_cast<FrameChoice&>(plain) = frames.choice();
    plain.width = width, plain.height = height;
    plain.noise = !arguments.no_noise, plain.contrast = !arguments.no_contrast;
    FrameWatch watch;
    const PictureFiles files = render_xray(dir, views_of(dir, arguments, plain), watch.progress());
    if (!frames.quiet) print_files(files);
    return ErrorKind::None;
#else
    (void)dir, (void)arguments, (void)width, (void)height, (void)frames;
    throw Error(ErrorKind::BadScene, "render: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

}  // namespace seldinger::apps
