#pragma once
// From a scene and a sweep to a finished results table: steps the worlds one after the other, saves and stops.

#include "core/folder.h"
#include "run_loop.h"
#include "batch/batch.h"

#include <nlohmann/json.hpp>

namespace seldinger::apps {

using Json = nlohmann::ordered_json;

/// @throws Error
[[nodiscard]] RunOutcome run_batch(const std::filesystem::path& scene, const std::filesystem::path& sweep,
                                   const RunOptions& options);

/// Result of one task of many.
struct BatchPart {
    RunOutcome outcome;
    std::vector<BatchRow> rows;  // of the runs that have ended, in any order
    double step_s = 0;           // spent in steps by this call
};

/// Runs `begin` to `end` of a sweep alone in an open folder; options.use as of a batch in it, options.dir is ignored. @throws Error
[[nodiscard]] BatchPart run_batch_part(const BatchSource& source, const std::string& sweep_text, std::size_t begin,
                                       std::size_t end, const Folder& folder, const RunOptions& options);

/// Takes a batch's own files out of a folder, by their names. @throws Error BadFile
void remove_batch(const Folder& folder);

/// The tables of a batch, and of a merged farm. results.csv comes last: who finds it finds the others.
void write_tables(const Folder& folder, const BatchSource& source, const std::vector<BatchRow>& rows);

/// Counts, outcomes, ranking and the answer in one line, as a batch's summary.json and a farm's have them.
void add_answer(Json& summary, const BatchSource& source, const std::vector<BatchRow>& rows);

/// The scene with every default filled in, as a batch in `dir` writes it.
[[nodiscard]] std::string resolved_scene(const BatchSource& source, const std::filesystem::path& dir);

}  // namespace seldinger::apps
