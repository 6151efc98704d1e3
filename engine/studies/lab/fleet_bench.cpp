// Times many wires at once: one world of copies of a scene.
#include "lab/fleet_bench.h"

#include "core/clock.h"
#include "core/error.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"

#include <fmt/format.h>

#include <algorithm>

namespace seldinger {
namespace {

struct Fleet {
    Fleet(const Scene& scene, int device_index, int wires)
        : scenes(static_cast<std::size_t>(wires), scene),
          key_frames(scenes),
          world(make_setup(scenes, load_vessel(scene.vessel), device_index))
    {
    }
    void take(const StepReport& report, long k) const
    {
        if (report.failed())
            throw Error(ErrorKind::Stopped,
                        fmt::format("{} with {} wires: step {} failed", scenes[0].source.string(), scenes.size(), k + 1));
    }
    void settle_first()
    {
        if (scenes[0].start_settled) take(settle(world), -1);
    }
    std::vector<Scene> scenes;
    KeyFrames key_frames;
    World world;
};

void run(Fleet& fleet, FleetTiming& timing, const std::function<bool()>& stop)
{
    for (long k = 0; k < timing.steps; ++k) {
        if (stop()) throw Error(ErrorKind::Interrupted, "interrupted; nothing was written");
        const StepReport report = step(fleet.world, fleet.key_frames.control(), fleet.scenes[0].step_length(k));
        fleet.take(report, k);
        timing.newton += report.newton_iterations;
        timing.stages += report.times;
    }
}

}  // namespace

FleetTiming time_fleet(const Scene& scene, int device_index, int wires, long steps, const std::function<bool()>& stop)
{
    FleetTiming timing;
    timing.wires = wires;
    timing.steps = steps;
    const double n = static_cast<double>(steps);
    {
        Fleet fleet(scene, device_index, wires);
        fleet.settle_first();
        const DeviceCounts before = fleet.world.device_counts();
        const auto begin = Clock::now();
        run(fleet, timing, stop);
        timing.step = seconds_since(begin) / n;
        const DeviceCounts after = fleet.world.device_counts();
        timing.launches = static_cast<double>(after.launches - before.launches) / n;
        timing.reads = static_cast<double>(after.reads - before.reads) / n;
        timing.writes = static_cast<double>(after.writes - before.writes) / n;
        timing.newton /= n;
        timing.stages /= n;
        timing.state_hash = fleet.world.state_hash();
        for (int w = 0; w < fleet.world.wire_count(); ++w)
            for (int i = 0; i < fleet.world.rod(w).n; ++i) timing.nodes.push_back(fleet.world.rod(w).pos(i));
    }
    device::begin_profile();
    try {
        Fleet fleet(scene, device_index, wires);
        fleet.settle_first();
        device::restart_profile();
        FleetTiming again;
        again.steps = steps;
        run(fleet, again, stop);
        if (fleet.world.state_hash() != timing.state_hash)
            throw Error(ErrorKind::Stopped, fmt::format("{} with {} wires: got two results from two runs; expected the same bits",
                                                       scene.source.string(), wires));
    } catch (...) {
        (void)device::end_profile();
        throw;
    }
    timing.profile = device::end_profile();
    return timing;
}

double distance_of(const FleetTiming& a, const FleetTiming& b)
{
    double most = 0;
    for (std::size_t i = 0; i < std::min(a.nodes.size(), b.nodes.size()); ++i)
        most = std::max(most, (a.nodes[i] - b.nodes[i]).norm());
    return most;
}

}  // namespace seldinger
