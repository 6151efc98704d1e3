// What a scene is refused for once its vessel is there.
#include "run/ready.h"

#include "core/error.h"
#include "run/score.h"
#include "world/setup_check.h"

#include <fmt/format.h>

namespace seldinger {

WorldSetup ready_setup(const Scene& scene, int device_index, RepairReport* report)
{
    LoadedVessel vessel = load_vessel(scene.vessel);
    if (report) *report = vessel.report;
    return ready_setup(std::span(&scene, 1), std::move(vessel), device_index);
}

WorldSetup ready_setup(std::span<const Scene> scenes, LoadedVessel vessel, int device_index)
{
    WorldSetup setup = make_setup(scenes, std::move(vessel), device_index);
    try {
        check_start(setup);
    } catch (const Error& error) {
        throw Error(error.kind(), fmt::format("{}: {}", scenes.front().source.string(), error.what()));
    }
    const Scene& scene = scenes.front();
    if (scene.task.on) (void)TaskTarget(scene.task, WorldBranches(setup).of(0), scene.source.string());
    return setup;
}

}  // namespace seldinger
