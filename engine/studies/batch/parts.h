#pragma once
// A batch, or the pictures of a run, in parts that any machines do in any order: each part's result depends on the plan and its
// number alone.
//
//   parts.json          the plan: how many parts of what
//   parts/3-of-40.bin   rows of a part of a batch, and where it stands (batch_saved.h); complete or absent
//
// All of it is reached from the open folder and never through a link: a folder may come from somebody else, or lie where others
// write.

#include "batch/batch_saved.h"

#include <optional>
#include <string>
#include <vector>

namespace seldinger {

struct PartPlan {
    bool frames = false;                   // pictures of a run; else runs of a sweep
    std::size_t items = 0, parts = 0;      // runs or frames, and how many parts they are cut into
    std::string key;                       // differs when what a result depends on does: scene, sweep, vessel, options, version
    std::size_t first = 0;                 // frame
    double rate = 0;                       // of a film of them [1/s]
    std::vector<std::string> files = {};   // that each frame has in the folder, ###### its number

    struct Range {
        std::size_t begin, end;  // items
    };
    /// Parts differ by one item at most. @param part  from 1
    [[nodiscard]] Range range(std::size_t part) const { return {(part - 1) * items / parts, part * items / parts}; }
    [[nodiscard]] std::size_t size(std::size_t part) const { return range(part).end - range(part).begin; }
    [[nodiscard]] std::string name(std::size_t part) const { return std::to_string(part) + "-of-" + std::to_string(parts); }
    /// What each run of a data set leaves when it is done: its frames are made by the part that made the run.
    static constexpr const char* dataset_file = "runs/run_######.json";
    [[nodiscard]] bool of_dataset() const { return files == std::vector<std::string>{dataset_file}; }
    [[nodiscard]] const char* item_word() const { return frames && !of_dataset() ? "frame" : "run"; }
};

/// 16 hex digits over texts in order.
[[nodiscard]] std::string plan_key(const std::vector<std::string>& texts);

/// Writes parts.json, or leaves the same one. @throws Error BadScene: another plan is there, or another version's; BadFile
void write_plan(const Folder& dir, const PartPlan& plan);
/// @throws Error BadFile: there is none, or it is damaged
[[nodiscard]] PartPlan read_plan(const Folder& dir);

/// Where a part of a batch is saved; parts/ is made.
[[nodiscard]] FilePlace part_file(const Folder& dir, const PartPlan& plan, std::size_t part);
/// What a part of a batch has saved; nothing where it was not begun. @throws Error BadFile: damaged, or of another plan
[[nodiscard]] std::optional<SavedBatch> read_part(const Folder& dir, const PartPlan& plan, std::size_t part);

/// A file of a frame, below the folder. @param pattern  of PartPlan::files
[[nodiscard]] std::string frame_file(const std::string& pattern, std::size_t frame);

/// How many of a part's items are there. A damaged part has none.
[[nodiscard]] std::size_t items_there(const Folder& dir, const PartPlan& plan, std::size_t part);
[[nodiscard]] inline bool is_done(const Folder& dir, const PartPlan& plan, std::size_t part)
{
    return items_there(dir, plan, part) == plan.size(part);
}

/// "3, 17-19" of increasing numbers.
[[nodiscard]] std::string list_ranges(const std::vector<std::size_t>& numbers, const char* between = ", ");

}  // namespace seldinger
