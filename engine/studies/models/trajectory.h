#pragma once
// Observables of a run on a grid of times that all models share, so that any two runs can be compared.

#include "core/folder.h"
#include "models/peaks.h"
#include "models/simulation.h"

#include <filesystem>
#include <vector>

namespace seldinger {

/// Forces are means over the last `average` seconds before t (20 ms unless said otherwise); the shape is that at t.
struct Sample {
    double t = 0;             // [s]
    double inserted = 0;      // [m]
    std::vector<Vec3> shape;  // tip first [m]
    double hand_force = 0;    // [N]
    double friction = 0;      // total, sum of magnitudes [N]
    double normal = 0;        // total, sum of magnitudes [N]
    /// Normal force between the tip and s, at `contact_grid` places s = k length / (contact_grid - 1) of the whole wire [N].
    std::vector<double> contact_up_to;
};

inline constexpr int contact_grid = 257;

struct Trajectory {
    double wire_length = 0;       // [m], what contact_up_to is spread over
    std::vector<Sample> samples;  // times strictly increasing
    Peaks peaks{};                // of the whole run, where RunPlan::peaks asked for them
};

/// Cumulative force on the grid; a force between two grid places is shared between them by the lever rule.
[[nodiscard]] std::vector<double> accumulate_forces(const std::vector<ForceAt>& forces, double wire_length);

/// Binary, checksummed, written in one go. @throws Error BadFile
void save_trajectory(const FilePlace& file, const Trajectory& trajectory);
/// @return false when the file is missing, damaged, of another version or holds what no run makes (then the run is simply done
/// again)
[[nodiscard]] bool load_trajectory(const FilePlace& file, Trajectory& trajectory);

}  // namespace seldinger
