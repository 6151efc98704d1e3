#pragma once
// Whole scenes, timed: steps per second, the time of each stage, calls of the device.

#include "scene/scene.h"

#include <functional>
#include <string>
#include <vector>

namespace seldinger {

struct SceneTiming {
    std::string scene;  // file name
    std::string device;
    std::size_t triangles = 0;
    long steps = 0;  // of each run
    int nodes = 0, contacts_max = 0;
    double load = 0;                             // mesh, tree, kernels: of the first run [s]
    double rate = 0, lowest = 0, highest = 0;    // steps per second over the runs: median and range; nothing is written meanwhile
    StageTimes stages;                           // mean per step, of the median run [s]
    double other = 0;                            // of a step, outside the stages [s]
    double newton = 0;                           // iterations per step
    double launches = 0, reads = 0, writes = 0;  // per step, of the last run
    long buffers = 0, programs = 0;              // made after the first hundred steps: candidate lists that grew
    std::string state_hash;
};

/// Runs the scene `repeats` times from its start. @param most_steps  0: the whole scene
/// @throws Error as make_setup; Stopped when a step fails; Interrupted when stop() says so
[[nodiscard]] SceneTiming time_scene(const Scene& scene, int device_index, int repeats, long most_steps,
                                     const std::function<bool()>& stop = {});

}  // namespace seldinger
