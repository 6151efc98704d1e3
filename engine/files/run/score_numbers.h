#pragma once
// How a task goes, as plain bytes: for a checkpoint, and for the threads of a live session.

#include <cstdint>
#include <type_traits>

namespace seldinger {

/// Those that are not below 0.
struct ScoreSums {
    double time = 0;              // from the first move of a hub until the target was reached, or so far [s]
    double path_length = 0;       // of the tip of the instrument that counts [m]
    double advanced = 0, pulled_back = 0;  // of its hub [m]
    double wall_force = 0, wall_force_mean = 0, wall_force_max = 0;  // [N]
    double patch_force = 0, patch_force_max = 0;  // on the worst patch of the wall (contact/force_per_length.h) [N]
    double patch_force_max_time = 0;  // when that was [s]
    double hand_force_max = 0;    // magnitude, of that hub [N]
    double time_above = 0;        // with more wall force, on all or on a patch, than allowed [s]
    double fluoroscopy = 0;       // [s]
    double contrast = 0;          // [ml]
    double force_time = 0;        // integral of the wall force, for the next step [N s]
};

/// Those of either sign.
struct ScoreReals {
    double distance = -1;         // of the tip from the target [m]; -1: no target
    double reached_at_m = 0, reached_at_s = 0;  // inserted length and time when the target was reached [m], [s]
    // state for the next step
    double tip[3] = {};           // [m]
    double inserted = 0;          // [m]
    double turned = 0;            // [rad]
    double run = 0;               // of the hub since it last turned round [m]
};

struct ScoreNumbers : ScoreSums, ScoreReals {
    std::uint32_t pushes = 0, pull_backs = 0;  // changes of direction
    std::int32_t direction = 0;
    // 0 or 1: a file may hold anything, which a bool may not
    std::uint8_t reached = 0, failed = 0;  // failed: a limit was exceeded before
    std::uint8_t has_tip = 0;
    std::uint8_t begun = 0;       // that hub has moved
};
static_assert(std::is_trivially_copyable_v<ScoreNumbers>);

/// Whether the force on the worst patch was still rising when the target was reached: a target a little farther in has a larger
/// one.
[[nodiscard]] inline bool is_rising(double patch_force_max_time, double reached_at_s)
{
    return patch_force_max_time > reached_at_s - 0.02;
}

}  // namespace seldinger
