// How many fluoroscopic pictures a second: frames of a run's folder as 12-bit grey levels in memory, no file written.
//
//   fluoro_speed DIR ANGLES SIZE FIRST LAST [turn]        e.g. fluoro_speed out/fluoro/demo "LAO 30" 1024 300 399
//
// Wire, body and contrast of the run's scene, noise and blur. `turn`: the arm turns by half a degree a frame, so that nothing
// stays. Prints size, frames, seconds until the first picture, of the others the median and the slowest wall time and the mean
// processor time [ms], and a hash of all grey levels.
#include "core/error.h"
#include "pictures/fluoro_scene.h"
#include "pictures/fluorography.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <numbers>

using namespace seldinger;

namespace {

double wall_clock() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double processor_clock() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

FluoroOptions options_of(const std::filesystem::path& dir, const std::string& angles, int size)
{
    FluoroOptions o = fluoro_options(read_scene(dir / "scene.toml"));
    o.arm.columns = o.arm.rows = size;
    o.turning.clear();
    set_angles(o.arm, angles);
    return o;
}

/// Half a degree for each frame of the run.
void turn_by_frames(FluoroOptions& o, const RunFolder& run)
{
    const double all = 0.5 * std::numbers::pi / 180 * static_cast<double>(run.frames.size() - 1);
    o.turning = {{run.frames.front().time, o.arm.primary - all / 2, o.arm.secondary},
                 {run.frames.back().time, o.arm.primary + all / 2, o.arm.secondary}};
}

int measure(const std::vector<std::string>& words)
{
    if (words.size() < 5) throw Error(ErrorKind::BadScene, "fluoro_speed DIR ANGLES SIZE FIRST LAST [turn]");
    const int size = std::stoi(words[2]);
    const std::size_t first = std::stoul(words[3]), last = std::stoul(words[4]);
    const double start = wall_clock();
    FluoroOptions options = options_of(words[0], words[1], size);
    Fluorography run(words[0], options, true);
    if (words.size() > 5) turn_by_frames(options, run.run());
    double ready = 0, processor = 0;
    std::vector<double> wall;
    std::uint64_t hash = 14695981039346656037ull;  // Fowler, Noll and Vo's
    for (std::size_t frame = first; frame <= last; ++frame) {
        const double began = wall_clock(), used = processor_clock();
        run.look(frame, run.run().frames.at(frame).time);
        const auto grey = grey_levels(run.picture(2 * frame), run.scope().reference(), options.logarithmic);
        if (frame == first) ready = wall_clock() - start;
        else wall.push_back(wall_clock() - began), processor += processor_clock() - used;
        for (const std::uint16_t g : grey) hash = (hash ^ g) * 1099511628211ull;
    }
    const double count = static_cast<double>(std::max<std::size_t>(wall.size(), 1));
    std::sort(wall.begin(), wall.end());
    fmt::print("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:016x}\n", size, wall.size() + 1, ready,
               wall.empty() ? 0 : 1e3 * wall[wall.size() / 2], wall.empty() ? 0 : 1e3 * wall.back(), 1e3 * processor / count,
               hash);
    return 0;
}

}  // namespace

int main(int count, char** words)
{
    try {
        return measure({words + 1, words + count});
    } catch (const std::exception& error) {
        fmt::print(stderr, "fluoro_speed: {}\n", error.what());
        return 2;
    }
}
