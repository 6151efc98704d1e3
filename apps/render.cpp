// seldinger render DIR [--view fluoro] [--size 1280x720] [--frames A:B] [--wall displacement | stress [--wall-max 1.5mm]]

#include "commands.h"
#include "quantity.h"
#include "render_fluoro.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <charconv>
#include <filesystem>
#include <memory>

#ifdef SEL_WITH_VIEW
    #include "view/render.h"
#endif

namespace seldinger::apps {
namespace {

/// "AxB" or "A:B". @throws Error BadScene
std::pair<int, int> two_numbers(const std::string& text, char between, const char* option, const char* form)
{
    int a = 0, b = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, a);
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == between) {
        const auto second = std::from_chars(first.ptr + 1, end, b);
        if (second.ec == std::errc() && second.ptr == end && a >= 0 && b >= 0) return {a, b};
    }
    throw Error(ExitCode::BadScene, fmt::format("{}: \"{}\" given, {} expected", option, text, form));
}

struct Options {
    std::filesystem::path dir;
    std::string size, frames, wall, wall_max, view = "shaded";
    FluoroArguments fluoro;
};

#ifdef SEL_WITH_VIEW
void set_wall(const Options& options, RenderOptions& what)
{
    if (options.wall.empty() && !options.wall_max.empty())
        throw Error(ExitCode::BadScene, "--wall-max: of what? give --wall displacement or --wall stress with it");
    if (options.wall.empty()) return;
    const bool stress = options.wall == "stress";
    what.wall = stress ? WallQuantity::Stress : WallQuantity::Displacement;
    if (!options.wall_max.empty())
        what.wall_max = stress ? parse_pressure("--wall-max", options.wall_max) : parse_length("--wall-max", options.wall_max);
}
#endif

ExitCode render(const Options& options)
{
    const bool fluoro = options.view == "fluoro";
    const std::string alien = options.fluoro.first_given();
    if (!fluoro && !alien.empty()) throw Error(ExitCode::BadScene, alien + ": is an option of --view fluoro; give that too");
    if (fluoro && !options.wall.empty())
        throw Error(ExitCode::BadScene, "--wall: an X-ray has no colours; leave out --view fluoro");
    const auto [width, height] = two_numbers(options.size.empty() ? fluoro ? "1024x1024" : "1280x720" : options.size, 'x',
                                             "--size", "WIDTHxHEIGHT in pixels, e.g. 1280x720,");
    std::pair<int, int> range{-1, -1};
    if (!options.frames.empty()) range = two_numbers(options.frames, ':', "--frames", "FIRST:LAST, e.g. 0:99,");
    if (fluoro) return render_fluoro_view(options.dir, options.fluoro, width, height, range.first, range.second);
#ifdef SEL_WITH_VIEW
    RenderOptions what;
    what.width = width;
    what.height = height;
    what.first = range.first;
    what.last = range.second;
    set_wall(options, what);
    std::string text;
    for (const auto& path : render_run(options.dir, what)) text += path.string() + "\n";
    print(text);
    return ExitCode::Done;
#else
    (void)width, (void)height;
    throw Error(ExitCode::BadScene, "render: this build has no renderer; configure with -DSELDINGER_VIEW=ON");
#endif
}

}  // namespace

void add_render(CLI::App& app, Command& chosen)
{
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("render", "draw the frames of a run, without a display");
    command->add_option("DIR", options->dir, "folder of a run")->required();
    command->add_option("--size", options->size, "picture in pixels (default 1280x720; fluoro 1024x1024)")->type_name("WxH");
    command->add_option("--frames", options->frames, "from A to B, from 0; default: the last one, as picture.png")
        ->type_name("A:B");
    command->add_option("--wall", options->wall, "colour a wall that yields, where it has moved to: displacement or stress")
        ->check(CLI::IsMember({"displacement", "stress"}))
        ->type_name("WHAT");
    command->add_option("--wall-max", options->wall_max, "top of that scale; default: round, above the run's largest")
        ->type_name("1.5mm|80kPa");
    command->add_option("--view", options->view, "shaded (default) or fluoro: what an X-ray shows")
        ->check(CLI::IsMember({"shaded", "fluoro"}))
        ->type_name("VIEW");
    options->fluoro.declare(*command);
    command->callback([options, &chosen] { chosen = [options] { return render(*options); }; });
}

}  // namespace seldinger::apps
