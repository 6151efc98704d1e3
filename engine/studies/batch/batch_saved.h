#pragma once
// What a batch, or one part of it, saves: its rows so far, and where it stands. One sealed file, complete or absent, to which the
// state of the world that is open may be appended.

#include "batch/batch_table.h"
#include "core/folder.h"
#include "output.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace seldinger {

/// Sums over all calls that it took. Plain bytes.
struct BatchTotals {
    std::int64_t wire_steps = 0, world_steps = 0, resumes = 0;
    double wall = 0;  // [s]
    StageTimes stages;
};

struct SavedBatch {
    std::string device;
    std::string scene, sweep;   // whose it is: the scene as text (of a part the key of its plan), and the sweep's file
    std::string name;           // of run 0
    std::int64_t seed = 0;      // of the sweep's draws
    BatchLayout layout;
    std::uint64_t instruments = 1;     // of a run
    std::uint64_t begin = 0, end = 0;  // runs
    RunStatus status = RunStatus::Running;
    bool ramp = false;  // plan_worlds()
    BatchTotals totals;
    std::vector<BatchRow> rows;  // in the order in which the runs ended
    std::uint64_t at = 0;        // world, of plan_worlds()
    bool open = false;           // its state follows
};

/// @param put_world  appends the state of the world, where one is open
void write_saved(const FilePlace& file, const SavedBatch& saved,
                 const std::function<void(std::vector<std::uint8_t>&)>& put_world = {});
/// @param world  out. @throws Error BadFile: damaged, of another version, or not what a batch can come to
[[nodiscard]] SavedBatch read_saved(const FilePlace& file, std::vector<std::uint8_t>& world);

}  // namespace seldinger
