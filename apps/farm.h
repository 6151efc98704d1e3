#pragma once
// Who runs the parts of a farm: processes of this program here, or Slurm's array jobs.

#include "batch/parts.h"
#include "core/error.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

/// What runs one part: these words of this program, then `option` with the part: --part 3/40, or --frames 20:29.
struct PartCommand {
    std::vector<std::string> words;
    const char* option = "--part";
    [[nodiscard]] std::vector<std::string> of(const PartPlan& plan, std::size_t part) const;
};

struct LocalBackend {
    int jobs = 1, threads = 0, device = -1;
    bool quiet = false;
};
/// Runs every part that is not done, in `jobs` processes at a time; returns when all are, or those left have failed here.
/// @return Done, or TimeLimit, Interrupted after a signal, or a failed part's code. @throws Error
ExitCode run_here(const Folder& dir, const PartPlan& plan, const PartCommand& command, const LocalBackend& backend);

/// Refuses a folder or an option that would become commands of a job's script. Before anything is made. @throws Error BadScene
void check_job_scripts(const std::filesystem::path& dir, const std::vector<std::string>& options);
/// Writes DIR/job.sh and DIR/merge.sh. @param options  of sbatch. @return the commands that submit the parts that are not done, as words
[[nodiscard]] std::vector<std::vector<std::string>> write_slurm_jobs(const Folder& dir, const PartPlan& plan, const PartCommand& command,
                                                                     const std::vector<std::string>& options);
/// Submits them and the merge behind them. @return what to tell. @throws Error BadFile: no Slurm, or it refuses
[[nodiscard]] std::string submit(const Folder& dir, const std::vector<std::vector<std::string>>& arrays);
/// @throws Error BadFile: there is no sbatch
void need_slurm();

/// A command line that a shell reads back as these words.
[[nodiscard]] std::string shell_text(const std::vector<std::string>& words);

}  // namespace seldinger::apps
