#pragma once
// The record of a live session: the input of every hub in every step, to the bit. A run with the same input ends with the same
// bits. A file that grows in blocks of a fraction of a second, each with its checksum: what a killed session leaves is whole up
// to the last block.
//
//   "SELLIVE1" · u32 length · header (JSON) · blocks: u32 length · u64 FNV-1a · entries, packed
//   entry: u8 kind · u8 flags · [Step: per instrument f64 advance or force, f64 turn] · [CutShort: u32 trials] ·
//   [End: 16 characters of the state's hash]

#include "core/file_io.h"
#include "scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace seldinger {

struct RecordHeader {
    std::string version, scene_name, device;
    std::uint64_t scene_hash = 0, vessel_hash = 0;
    double dt = 0;  // [s]
    int instruments = 0;
};

struct RecordEntry {
    enum class Kind : std::uint8_t { Step = 's', CutShort = 'c', Reset = 'r', End = 'e' };
    static constexpr std::uint8_t fluoroscopy = 1, contrast = 2;
    Kind kind = Kind::Step;
    std::uint8_t flags = 0;
    std::vector<double> hubs;  // Step: advance (of a driven hub: Coupling::pull), turn of each as the world was asked, from 0 on
    // CutShort, of the step before: at which call World::cut_when() was told that its time is up, from 1 on
    std::uint32_t trials = 0;
    std::string hash;          // End
};

struct SessionRecord {
    RecordHeader header;
    std::vector<RecordEntry> entries;
    bool whole = false;  // it has its end: the session was not killed
    [[nodiscard]] long steps() const;
};

/// What of a scene a record depends on: everything but how long and how finely it is run and recorded, and its key frames after
/// the start.
[[nodiscard]] std::uint64_t record_hash(const Scene& scene);

/// Packs an entry at the end of `bytes`.
void put_step(std::vector<std::uint8_t>& bytes, std::uint8_t flags, const double* hubs, int instruments);
void put_cut_short(std::vector<std::uint8_t>& bytes, std::uint32_t trials);
void put_reset(std::vector<std::uint8_t>& bytes);

class RecordWriter {
public:
    /// Starts anew. @throws Error BadFile: not writable; BadScene: there is a file that is no record
    RecordWriter(const std::filesystem::path& path, const RecordHeader& header);
    void append(const std::vector<std::uint8_t>& entries);
    void finish(const std::string& state_hash);

private:
    AppendFile file_;
};

/// @throws Error BadFile: missing, no record, damaged at its head
[[nodiscard]] SessionRecord read_record(const std::filesystem::path& path);

/// @throws Error BadScene: of another scene, vessel or version, in one line
void check_record(const SessionRecord& record, const std::filesystem::path& path, const Scene& scene, std::uint64_t vessel_hash);

}  // namespace seldinger
