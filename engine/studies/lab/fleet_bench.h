#pragma once
// Many wires at once on one device, as a graphics card would run them: launches, bytes over the bus, the time of each kernel by
// the device's own events. For `seldinger bench --gpu`.

#include "device/profile.h"
#include "scene/scene.h"

#include <functional>
#include <string>
#include <vector>

namespace seldinger {

struct FleetTiming {
    int wires = 0;
    long steps = 0;
    double step = 0;                             // wall time of a step [s]
    StageTimes stages;                           // of a step [s]
    double newton = 0;                           // iterations per step, the most of any wire
    double launches = 0, reads = 0, writes = 0;  // per step
    device::Profile profile;                     // of all steps of a second run
    std::string state_hash;
    std::vector<Vec3> nodes;  // of all wires at the end [m]
};

/// `wires` copies of the scene in one world, settled if it says so, then `steps` steps. Runs it twice: for the wall time, and for
/// the profile.
/// @throws Error as make_setup; Stopped when a step fails; Interrupted when stop() says so
[[nodiscard]] FleetTiming time_fleet(const Scene& scene, int device_index, int wires, long steps,
                                     const std::function<bool()>& stop);

/// Largest distance between two states of the same wires [m].
[[nodiscard]] double distance_of(const FleetTiming& a, const FleetTiming& b);

}  // namespace seldinger
