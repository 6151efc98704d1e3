#pragma once
// summary.json: the results of a run, as one JSON object and as a few lines for people.

#include "bands/error_band.h"
#include "engine.h"
#include "math/end_mean.h"
#include "run/closed_ends.h"
#include "run/exits.h"
#include "run/scene_run.h"
#include "run/score.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace seldinger {

/// The most of what contacts along the wire came to (contact/force_per_length.h): forces over every step, places and extent over
/// the rows of trace.csv.
struct LoadNumbers {
    double per_length = 0, per_length_at = 0, per_length_time = 0;  // [N/m], from the tip [m], [s]
    double patch_force = 0, patch_at = 0, patch_time = 0;           // [N], from the tip [m], [s]
    double extent = 0, window = 0, patch = 0;                       // [m]
};
struct LoadTally : LoadNumbers {
    std::int64_t regions = 0;
    std::uint8_t widened = 0;      // 0 or 1: a file may hold anything, which a bool may not
    std::uint8_t unused[7] = {};   // a checkpoint has no bytes that nobody sets
    void take_in(const ContactAlong& now, double time);
    /// Whether contacts of this sum of normal forces [N] can bear more: no stretch of a wire bears more than all of them, but for
    /// rounding (contact/contact_sums.h).
    [[nodiscard]] bool may_rise(double normal) const { return (1 + 1e-9) * normal > std::min(patch_force, per_length * window); }
};

/// The greatest value of a reading of the wall, where on the wall that has not moved, and when.
struct Greatest {
    double value = 0, at[3] = {}, time = 0;  // [m], [s]
    WallBand band;                           // ± of it [m], [Pa]
    void take_in(double now, const double (&where)[3], const WallBand& band_there, double when);
};

/// The counters among RunTally; nothing else, so that whoever reads them from a file can check them all (record/checkpoint.h).
struct TallyCounts {
    std::int64_t steps = 0;  // taken
    std::int64_t contacts_max = 0, newton_max = 0;
    std::int64_t halved_steps = 0;   // StepHalved
    std::int64_t outside_steps = 0;  // StepWallPenetration
    std::int64_t non_finite = 0;     // numbers that could not be written
    std::int64_t resumes = 0;
    std::int64_t rest_steps = 0;                                // steps in a row that World::at_rest() held
    std::int64_t far_steps = 0;                                 // StepWallFar
    std::int64_t unequal_steps = 0;                             // StepContactSums
    std::int64_t missed_steps = 0;                              // StepBestEffort
    std::int64_t row_newton = 0, row_flags = 0, row_steps = 0;  // since the last row of trace.csv
};

/// Likewise its numbers that are not below 0.
struct TallySums {
    double friction_max = 0, overlap_max = 0, outside_max = 0;  // over every step [N], [m], [m]
    double contact_area_max = 0, contact_pressure_max = 0;      // over the rows of trace.csv [m^2], [Pa]
    double hand_force_max = 0, hand_force_time = 0;             // over every step, of |hand force| [N], [s]
    double overlap_share = 0, overlap_time = 0;                 // of the radius, at the worst step [-], [s]
    double normal_max = 0, sunk_force = 0;  // sum of normal forces; by how much of it a harder surface has more (take_in) [N]
    double wall = 0;      // the loop with writing, earlier parts of a resumed run included [s]
    StageTimes stages;    // sums [s]
    double record = 0;    // writing, summed [s]
    double row_time = 0;  // since the last row of trace.csv [s]
};

/// Everything that is counted over a run. Plain bytes, so that a checkpoint carries it as it is.
struct RunTally : TallyCounts, TallySums {
    Greatest wall_move, wall_stress;    // over every step under the wires, over the rows of trace.csv everywhere [m], [Pa]
    LoadTally on_wall, on_instruments;  // per_length and patch_force over every step, the others over rows
    double overlap_at[3] = {};          // where overlap_share was [m]
    ExitTally exits;
    ScoreNumbers score;  // of [task]
    EndMean end;         // hand force and friction, over every step
    EndTouch end_touch;  // rows

    /// Adds one wire's step to counts, maxima and means; `steps` and times are the caller's. @param dt  0: an equilibrium [s]
    ///
    /// A wall that prescribes the wire's deflection d bends it with the energy U = K d^2/2 and the forces N = K d. Where the
    /// surface gives way by o, d is smaller by o, and the forces by dN/N = o/d = N o/(2 U). With the deepest overlap of all
    /// contacts for o, this is a bound.
    void take_in(const WireReadings& readings, unsigned flags, int newton_iterations, double dt);
    /// Hand force and friction over the last 20 ms; of an equilibrium its own.
    [[nodiscard]] EndMean::Mean at_end(const WireReadings& last) const;
    /// Flags that are seen only where a state is read (WireOutput::report), counted unless a step of the row has said so.
    void note_read(unsigned flags);
};
static_assert(std::is_trivially_copyable_v<RunTally>);

/// A ledger's entries as trace.csv and summary.json name them, in the order of the columns [J].
struct EnergyEntry {
    const char* name;
    double value;
};
[[nodiscard]] std::array<EnergyEntry, 10> energy_entries(const EnergyLedger& ledger);

/// What the summary tells beyond the tally and the world itself.
struct SummaryNotes {
    const Scene* scene = nullptr;
    const RepairReport* vessel = nullptr;
    RunStatus status = RunStatus::Running;
    WireReadings readings;              // of the last accepted step
    std::vector<std::string> warnings;  // one sentence each
    Branches branches;                  // as the leading wire meets them
    Branches::Place tip;                // where its tip is
    std::optional<ErrorEstimate> estimate;  // of what the step's length leaves in forces and tip
};

/// The JSON object, indented, with a line end. A number that is not finite is null, and `warnings` says so.
[[nodiscard]] std::string summary_json(const World& world, const RunTally& tally, const SummaryNotes& notes);

/// What became of [task], as `task` of summary.json.
[[nodiscard]] std::string task_json(const World& world, const Scene& scene, const ScoreNumbers& score);

/// Five lines from the JSON of a run in `dir` and its warnings; the last line is the answer: where the tip is, or what became of
/// the task.
/// @param verbose  more lines: model, numerics, what the bands come from
[[nodiscard]] std::string summary_for_people(const std::string& json, const std::filesystem::path& dir, bool verbose = false);

}  // namespace seldinger
