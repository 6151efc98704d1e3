#pragma once
// checkpoint.bin: where a run stands, so that it can go on with the same bits after any stop. A sealed file (core/sealed_file.h)
// with magic "SELCKPT1".

#include "scene/summary.h"

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
    std::uint64_t vessel_hash = 0;  // of the repaired wall: a changed mesh file cannot be resumed on
    RunStatus status = RunStatus::Running;
    RunTally tally;
    std::vector<std::uint64_t> trace_bytes;  // length of trace.csv, and of each trace_NAME.csv
    std::vector<FrameMark> wire_frames, contact_frames;
    std::vector<std::uint8_t> state;  // World::save_state()
};

/// Complete or not at all, and there after a power cut. @throws Error BadFile
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// @throws Error BadFile: missing, damaged, or of another version
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& path);

[[nodiscard]] std::uint64_t hash_of(const WallMesh& mesh);

}  // namespace seldinger
