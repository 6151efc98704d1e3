// Times whole scenes: repeats, median, stages, device counts after a warm-up.
#include "lab/scene_bench.h"

#include "core/clock.h"
#include "core/error.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

struct TimedRun {
    double wall = 0;
    StageTimes stages;
};

}  // namespace

SceneTiming time_scene(const Scene& scene, int device_index, int repeats, long most_steps, const std::function<bool()>& stop)
{
    SceneTiming timing;
    timing.scene = scene.source.filename().string();
    timing.steps = most_steps > 0 ? std::min(most_steps, scene.steps()) : scene.steps();
    const auto loading = Clock::now();
    const WorldSetup setup = make_setup(scene, device_index);
    const KeyFrames key_frames(scene);
    timing.triangles = setup.mesh.triangles.size();
    std::vector<TimedRun> runs;
    for (int r = 0; r < repeats; ++r) {
        World world(setup);
        if (r == 0) timing.load = seconds_since(loading);
        TimedRun run;
        DeviceCounts warm;
        long newton = 0;
        const auto begin = Clock::now();
        const auto account = [&](const StepReport& report, long k) {
            if (report.failed())
                throw Error(ErrorKind::Stopped, fmt::format("{}: step {} failed; see `seldinger run {}`", timing.scene, k + 1,
                                                           scene.source.string()));
            newton += report.newton_iterations;
            run.stages += report.times;
            if (r == 0) timing.contacts_max = std::max(timing.contacts_max, world.readings(0).contacts);
        };
        if (scene.start_settled) account(settle(world), -1);
        for (long k = 0; k < timing.steps; ++k) {
            if (stop && stop()) throw Error(ErrorKind::Interrupted, fmt::format("interrupted in {}", timing.scene));
            if (k == 100) warm = world.device_counts();
            account(step(world, key_frames.control(), scene.step_length(k)), k);
        }
        run.wall = seconds_since(begin);
        runs.push_back(run);
        if (r + 1 < repeats) continue;
        const double steps = static_cast<double>(std::max(timing.steps, 1l));
        const DeviceCounts end = world.device_counts();
        timing.device = world.device_name();
        timing.nodes = world.readings(0).nodes;
        timing.newton = static_cast<double>(newton) / steps;
        const double counted = static_cast<double>(std::max(timing.steps - 100, 1l));
        timing.launches = static_cast<double>(end.launches - warm.launches) / counted;
        timing.reads = static_cast<double>(end.reads - warm.reads) / counted;
        timing.writes = static_cast<double>(end.writes - warm.writes) / counted;
        timing.buffers = static_cast<long>(end.buffers_created - warm.buffers_created);
        timing.programs = static_cast<long>(end.programs_built - warm.programs_built);
        timing.state_hash = world.state_hash();
    }
    std::sort(runs.begin(), runs.end(), [](const TimedRun& a, const TimedRun& b) { return a.wall < b.wall; });
    const double steps = static_cast<double>(std::max(timing.steps, 1l));
    const TimedRun& middle = runs[runs.size() / 2];
    timing.rate = steps / middle.wall;
    timing.lowest = steps / runs.back().wall;
    timing.highest = steps / runs.front().wall;
    timing.stages = middle.stages;
    timing.stages /= steps;
    timing.other = middle.wall / steps - timing.stages.in_all();
    return timing;
}

}  // namespace seldinger
