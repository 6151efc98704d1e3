#pragma once
// What a session shows of its newest step to the threads beside it: copies of fixed size or of kept capacity, nothing to wait
// for.

#include "run/score_numbers.h"
#include "session/session_limits.h"

#include <array>
#include <cstdint>
#include <vector>

namespace seldinger {

/// Numbers of one instrument.
struct InstrumentNumbers {
    double hand = 0;                     // where the hand is [m]
    double advance = 0, turn = 0;        // of the hub since the start [m], [rad]
    double force = 0, torque = 0;        // of the coupling, on the hand [N], [N m]
    double force_per_advance = 0;        // [N/m]
    double wire_force = 0;               // that the instrument answers at the hub [N]
    double wall_force = 0;               // sum of normal contact forces [N]
    std::uint32_t contacts = 0;
};

struct StepNumbers {
    std::uint64_t step = 0;
    double time = 0;          // session time [s]
    std::uint64_t late = 0;
    std::uint64_t cut_short = 0;  // steps that ended at their deadline
    double stretched = 0;     // [s]
    double step_time = 0;     // of this one [s]
    bool was_late = false, was_cut_short = false, paused = false, stopped = false, fluoroscopy = false, contrast = false;
    std::uint32_t resets = 0;
    std::uint64_t request = 0;  // of the hand, the newest that this step knows of
    int instruments = 0;
    std::array<InstrumentNumbers, most_instruments> instrument{};
    ScoreNumbers score;
    int stretch = -1;        // of the vessel that the leading tip is in (Branches); -1: no centreline. Of views only
    double branch_depth = 0;  // behind its mouth [m]
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
