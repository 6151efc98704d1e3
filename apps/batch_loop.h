#pragma once
// From a scene and a sweep to a finished results table: steps the worlds one after the other, saves and stops.

#include "batch/parts.h"
#include "core/folder.h"
#include "run_loop.h"
#include "batch/batch.h"

#include <nlohmann/json.hpp>

namespace seldinger::apps {

using Json = nlohmann::ordered_json;

/// @throws Error
[[nodiscard]] RunOutcome run_batch(const std::filesystem::path& scene, const std::filesystem::path& sweep,
                                   const RunOptions& options);

struct PartChoice {
    std::size_t part = 0, parts = 0;  // from 1, of so many
    std::filesystem::path scene_at;   // paths in the scene are as if it lay here; empty: where it is
};
/// One part of a batch in options.dir (batch/parts.h), from where it stands; its tables are left to merge_parts(). @throws Error
[[nodiscard]] RunOutcome run_batch_part(const std::filesystem::path& scene, const std::filesystem::path& sweep,
                                        const PartChoice& which, RunOptions options);

/// Prepares a folder for a batch in parts, or finds it prepared. @throws Error
PartPlan begin_parts(const BatchSource& source, const std::string& sweep_text, std::size_t parts,
                     const std::filesystem::path& dir);

/// Tables of a batch whose parts lie in these folders, in the first of them. @return as of run_batch()
/// @throws Error BadFile: parts are missing
[[nodiscard]] RunOutcome merge_parts(const std::vector<std::filesystem::path>& dirs);
/// The same, and tells of it on stdout.
ErrorKind merge_and_tell(const std::vector<std::filesystem::path>& dirs);
/// The line about what is missing. @param parts  at least one
[[noreturn]] void say_missing(const Folder& dir, const PartPlan& plan, const std::vector<std::size_t>& parts);

[[nodiscard]] bool holds_a_batch(const Folder& folder);
/// Takes a batch's own files out of a folder, by their names. @throws Error BadFile
void remove_batch(const Folder& folder);

/// What the table of a batch has.
struct BatchTable {
    const Sweep& sweep;
    const BatchLayout& layout;
};
/// results.csv comes last: who finds it finds the others.
void write_tables(const Folder& folder, const BatchTable& table, const std::vector<BatchRow>& rows);
/// Counts, outcomes, ranking and the answer in one line, as summary.json has them.
void add_answer(Json& summary, const BatchTable& table, const std::vector<BatchRow>& rows);

/// The scene with every default filled in, as a batch in `dir` writes it.
[[nodiscard]] std::string resolved_scene(const BatchSource& source, const std::filesystem::path& dir);

}  // namespace seldinger::apps
