// Fuzz targets of scenes and sweeps.
#include "fuzz_support.h"

#include "scene/scene.h"
#include "batch/sweep.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <optional>

namespace seldinger::fuzz {
namespace {

namespace fs = std::filesystem;

/// Where the scene lies: beside a file that it may include, and one that it may take for a mesh.
const fs::path& folder()
{
    static const TemporaryFolder made;
    static const bool filled = (put_file(made.path() / "mesh.stl", "solid"), true);
    (void)filled;
    return made.path();
}

std::vector<std::string> lines_of(const std::string& text, std::size_t most)
{
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size() && lines.size() < most;) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        lines.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return lines;
}

/// A scene that was taken says itself in words that are taken, and says the same again: what a run is resumed by.
void check_words(const Scene& scene)
{
    const std::string words = write_scene(scene, folder());
    require(write_scene(read_scene_text(words, folder() / "scene.toml"), folder()) == words);
}

constexpr const char* swept_scene = R"([scene]
duration_s = 0.4
dt_s = 0.001
[wire]
preset = "lunderquist-035"
length_m = 0.1
[vessel]
shape = "tube"
radius_m = 0.005
length_m = 0.1
[feed]
inlet = "auto"
keys = [ {t_s = 0.0, advance_m = 0.004}, {t_s = 1.0, advance_m = 0.084} ]
)";

}  // namespace

/// The scene, its include "part.toml", and settings of --set a line each.
void scene(Bytes bytes)
{
    const std::vector<std::string> parts = parts_of(bytes, 3);
    put_file(folder() / "part.toml", parts[1]);
    const std::vector<std::string> settings = lines_of(parts[2], 8);
    std::optional<Scene> taken;
    answer([&] { taken = read_scene_text(parts[0], folder() / "scene.toml", settings); }, ErrorKind::BadScene);
    if (taken) check_words(*taken);
}

void sweep(Bytes bytes)
{
    answer([&] {
        const Sweep sweep = read_sweep_text(text_of(bytes), "v.toml", 1);
        const std::size_t runs = sweep.run_count();
        require(runs >= 1 && runs <= 1'000'000);
        for (const std::size_t run : {std::size_t{0}, runs - 1})
            (void)read_scene_text(swept_scene, folder() / "scene.toml", sweep.overrides(run));
    }, ErrorKind::BadScene);
}

}  // namespace seldinger::fuzz
