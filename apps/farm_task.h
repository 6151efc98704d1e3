#pragma once
// One task of a farm, done here: claimed, run or drawn, its result put in place.

#include "commands.h"
#include "batch/batch.h"
#include "batch/farm.h"

namespace seldinger::apps {

struct TaskOptions {
    int threads = 0, device = -1;
};

/// What a task's result depends on besides its number, from the files as they are now.
[[nodiscard]] std::string sweep_key(const BatchSource& source, const std::string& sweep_text);
[[nodiscard]] std::string frames_key(const std::filesystem::path& run, std::size_t first, std::size_t frames,
                                     const std::vector<std::string>& render);

/// The scene and sweep that a farm's folder carries. @param sweep_text  out. @throws Error
[[nodiscard]] BatchSource farm_source(const Folder& dir, const FarmPlan& plan, std::string& sweep_text);

/// The render command of a part. @throws Error BadScene: options that `render` does not know or that a farm gives itself
[[nodiscard]] Command render_command(const FarmPlan& plan, FarmPlan::Part part, const std::filesystem::path& dir);

/// Does the task unless it is done or another living worker has it.
/// @return Done, or TimeLimit, Interrupted after a signal (finished work is kept). @throws Error
ExitCode do_task(const Folder& dir, const FarmPlan& plan, std::size_t task, const TaskOptions& options);

/// Every task that nobody does, one after the other; one that fails does not keep the others from being done.
ExitCode do_all_tasks(const Folder& dir, const FarmPlan& plan, const TaskOptions& options);

}  // namespace seldinger::apps
