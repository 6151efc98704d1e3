#pragma once
// `seldinger batch` for programs: the runs of a sweep over a scene, and the answer to its [task]. Component `studies`.
//
//     const seldinger::BatchResult made = seldinger::run_batch("aortic-arch", "[vary]\n\"wire.mu_sliding\" = [0.05, 0.2]\n");

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace seldinger {

struct BatchRun {
    std::vector<std::string> overrides;     // what the sweep sets, as of --set
    std::string status;                     // "done"; "stopped": no state was found, the numbers are of the last good one
    std::map<std::string, double> numbers;  // columns of results.csv by name (docs/study-tables.md); NaN: an empty field
    std::string state_hash;
};

struct BatchResult {
    std::vector<BatchRun> runs;        // in the sweep's order
    std::vector<std::size_t> ranking;  // runs that reached the target within the task's limits, the least force on the wall first
    std::string answer;                // the command's line; empty where there is nothing to say
    std::string csv;                   // results.csv
};

/// Runs that can share a world are stepped together; each has the bits of a run alone. Writes no files.
/// @param scene  a scene file, or the name of a scene that comes with the program
/// @param sweep  text of a sweep file (docs/command-line.md); files of designs are looked for in the present folder
/// @param overrides  as of --set, "table.key=value", for all runs
/// @param progress  called every few steps with the number of runs that have ended; what it throws ends the batch
/// @throws Error BadFile, BadScene: before the first step
[[nodiscard]] BatchResult run_batch(const std::filesystem::path& scene, const std::string& sweep,
                                    const std::vector<std::string>& overrides = {},
                                    const std::function<void(std::size_t ended)>& progress = {});

}  // namespace seldinger
