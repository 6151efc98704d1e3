// Runs a scene by its name, records it as the command does, and makes a picture, an X-ray picture and a report of it.

#include <seldinger/engine.h>
#include <seldinger/pictures/render.h>
#include <seldinger/pictures/xray.h>
#include <seldinger/record/recording.h>
#include <seldinger/report/report_page.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

using namespace seldinger;

namespace {

void print_task(const TaskSpec& task, const TaskProgress& progress)
{
    std::printf("task: %s (branch %d): %s at %.2f s, at most %.1f mN on the wall until then\n", task.target_name.c_str(), task.branch,
                progress.verdict.c_str(), progress.reached_at, 1e3 * progress.wall_force_max);
}

/// @return the run's state hash
std::string run(const LoadedScene& scene, const std::filesystem::path& dir)
{
    World world(scene.setup);
    Recording recording(scene, world, dir, true);
    Control control;
    for (std::size_t hub = 0; hub < scene.keys.size(); ++hub)
        if (!scene.keys[hub].empty()) control.follow(static_cast<int>(hub), scene.keys[hub]);
    while (world.time() < scene.duration - 0.5 * scene.dt) recording.stepped(world, step(world, control, scene.dt));
    recording.finish(world);
    if (scene.task.on) print_task(scene.task, recording.task());
    return world.state_hash();
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        const std::filesystem::path dir = argc > 1 ? argv[1] : "recorded";
        const LoadedScene scene = load_scene("aortic-arch", {"task.target={name = \"the ascending aorta\", branch = 4}"});
        std::printf("state %s\n", run(scene, dir).c_str());

        RenderOptions picture;
        picture.width = 640, picture.height = 480;
        XrayOptions xray;
        xray.width = xray.height = 256;
        xray.c_arm = "LAO 30";
        for (const PictureFiles& files : {render_run(dir, picture), render_xray(dir, {xray})})
            for (const std::filesystem::path& file : files.paths) std::printf("%s\n", file.c_str());
        std::ofstream(dir / "report.html") << report_page(dir);
        std::printf("%s\n", (dir / "report.html").c_str());
        return 0;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.kind());
    }
}
