#pragma once
// checkpoint.bin: state of a run, which continues from it with the same bits after any stop. A sealed file (core/sealed_file.h)
// with magic "SELCKPT5".

#include "run/summary.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

/// A frame that was recorded: files are named after its step.
struct FrameMark {
    std::int64_t step = 0;
    double time = 0;  // [s]
};

struct Checkpoint {
    std::string version, device;
    std::string scene;              // as write_scene() writes it: the state is of no other one
    std::uint64_t vessel_hash = 0;  // of the repaired wall: a changed mesh file cannot be resumed on
    RunStatus status = RunStatus::Running;
    RunTally tally;
    std::vector<std::uint64_t> trace_bytes;  // length of trace.csv, each trace_NAME.csv and sensor_NAME.csv
    std::vector<FrameMark> wire_frames, contact_frames;
    std::vector<std::uint8_t> state;  // World::save_state()
};

/// Complete or not at all, and there after a power cut. @throws Error BadFile
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// @throws Error BadFile: missing, damaged, or of another version
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Whether every count and sum can be true of a run of at most so many steps, of a task.
[[nodiscard]] bool is_sound(const RunTally& tally, std::int64_t most);
[[nodiscard]] bool is_sound(const ScoreNumbers& score);

/// That it is of this scene and that every number can be true; the state itself is World::restore_state's affair.
/// @param scene  scene to resume, as write_scene() writes it
/// @throws Error BadFile naming what differs
void check_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint, const Scene& of, const std::string& scene);

[[nodiscard]] std::uint64_t hash_of(const WallMesh& mesh);

}  // namespace seldinger
