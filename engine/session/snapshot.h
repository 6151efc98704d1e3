#pragma once
// What a session shows of its newest step to the threads beside it: copies of fixed size or of kept capacity, nothing to wait for.

#include "session/session_limits.h"

#include <array>
#include <cstdint>
#include <vector>

namespace seldinger {

/// Numbers of one instrument.
struct InstrumentNumbers {
    double hand = 0, hand_turn = 0;      // where the hand is [m], [rad]
    double advance = 0, turn = 0;        // of the hub since the start [m], [rad]
    double force = 0, torque = 0;        // of the coupling, on the hand [N], [N m]
    double force_per_advance = 0;        // [N/m]
    double wire_force = 0;               // that the instrument answers at the hub [N]
    double coupling_energy = 0;          // of the observer, both degrees of freedom [J]
    double wall_force = 0;               // sum of normal contact forces [N]
    std::uint32_t contacts = 0;
};

/// How the task goes.
struct ScoreNumbers {
    double time = 0;              // until the target was reached, or so far [s]
    double path_length = 0;       // of the tip of the instrument that counts [m]
    double advanced = 0, pulled_back = 0;  // of its hub [m]
    double wall_force = 0, wall_force_mean = 0, wall_force_max = 0;  // [N]
    double patch_force = 0, patch_force_max = 0;  // on the worst patch of the wall (contact/force_per_length.h) [N]
    double time_above = 0;        // with more wall force, on all or on a patch, than allowed [s]
    double fluoroscopy = 0;       // [s]
    double contrast = 0;          // [ml]
    double distance = -1;         // of the tip from the target [m]; -1: no target
    std::uint32_t pushes = 0, pull_backs = 0;  // changes of the hand's mind
    bool reached = false, failed = false;      // failed: a limit was exceeded before
};

struct StepNumbers {
    std::uint64_t step = 0;
    double time = 0;          // session time [s]
    std::uint64_t late = 0;
    double stretched = 0;     // [s]
    double step_time = 0;     // of this one [s]
    bool was_late = false, paused = false, stopped = false, fluoroscopy = false, contrast = false;
    std::uint32_t resets = 0;
    std::uint64_t request = 0;  // of the hand, the newest that this step knows of
    int instruments = 0;
    std::array<InstrumentNumbers, most_instruments> instrument{};
    ScoreNumbers score;
};

/// A node of an instrument, tip first.
struct ViewNode {
    float x = 0, y = 0, z = 0;  // [m]
    float force = 0;            // of the wall on it [N]
};

struct ViewFrame {
    StepNumbers numbers;
    std::array<std::vector<ViewNode>, most_instruments> nodes;
};

}  // namespace seldinger
