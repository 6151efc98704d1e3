#pragma once
// Tables of state hashes (tests/golden/*.txt): reads them, runs the world of each entry and compares its hash with the table's.

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::test {

/// One wire: a scene, its settings, and the hash of its state at the end.
struct GoldenRow {
    std::string hash;                   // 16 hex digits, as state_hash in summary.json
    std::string duration;               // [s], or "whole": as the scene has it
    std::string scene;                  // below the source folder, or "$SHARED/...": below the shared reference data
    std::vector<std::string> settings;  // as --set of `seldinger run`, "$SHARED" put in the place of the folder's path

    [[nodiscard]] std::string line() const;  // as in the table
    [[nodiscard]] bool needs_shared() const;
};

/// Rows of the table, those of one world together. A row is "hash duration scene setting ..."; '#' begins a comment line. An
/// indented row is another wire of the world above it, and its hash that of the wire (the same as that of the wire alone).
[[nodiscard]] std::vector<std::vector<GoldenRow>> read_golden_table(const std::filesystem::path& file);

/// Checks every world of tests/golden/<name>. A hash that differs fails with the line that would replace the table's.
/// @param device_index  as in `seldinger devices`; -1: the default
void check_golden_table(const std::string& name, int device_index = -1);

}  // namespace seldinger::test
