#pragma once
// A run of a scene to its end, with the estimate of its step beside it.

#include "bands/step_twin.h"
#include "scene/scene.h"
#include "setup/joint_readings.h"
#include "setup/scene_setup.h"

#include <doctest/doctest.h>

#include <algorithm>

namespace seldinger::test {

/// @param spend  share of the run's steps that the estimate may take
inline ErrorEstimate run_with_twin(const Scene& scene, double spend = StepTwin::unlimited)
{
    World world(make_setup(scene));
    const KeyFrames key_frames(scene);
    StepTwin twin(scene, world, 0, spend);
    LargestReadings largest;
    WireOutput loads;
    for (long k = 0; k < scene.steps(); ++k) {
        REQUIRE_FALSE(step(world, key_frames.control(), scene.step_length(k)).failed());
        world.read_loads(0, loads);
        largest.patch = std::max(largest.patch, loads.on_wall.patch_force);
        twin.stepped(world, joint_readings(world, 0), k + 1, largest);
    }
    return twin.finish(StepTwin::Finer::Never);
}

}  // namespace seldinger::test
