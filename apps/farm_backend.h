#pragma once
// Backends of a farm: worker processes on this machine, or Slurm's array jobs.

#include "core/error.h"
#include "batch/farm.h"

#include <filesystem>
#include <string>
#include <vector>

namespace seldinger::apps {

struct LocalBackend {
    int jobs = 1, threads = 0, device = -1;
    bool quiet = false;
};
/// Does every task that is not done, in `jobs` processes, and returns when they have ended. @throws Error
ExitCode run_here(const Folder& dir, const FarmPlan& plan, const LocalBackend& backend);

struct SlurmBackend {
    std::vector<std::string> options;  // of sbatch, each a #SBATCH line
};
/// Refuses a folder or an option that would become commands of a job's script. Before anything is made. @throws Error BadScene
void check_job_scripts(const std::filesystem::path& dir, const std::vector<std::string>& options);
/// Writes DIR/job.sh and DIR/merge.sh. @return the commands that submit the tasks that are not done, as words
/// @throws Error BadScene: a folder whose name Slurm cannot be told
[[nodiscard]] std::vector<std::vector<std::string>> write_slurm_jobs(const Folder& dir, const FarmPlan& plan,
                                                                     const SlurmBackend& backend);
/// Submits them and the merge behind them. @return what to tell. @throws Error BadFile: no Slurm, or it refuses
[[nodiscard]] std::string submit(const Folder& dir, const std::vector<std::vector<std::string>>& arrays);
/// @throws Error BadFile: there is no sbatch
void need_slurm();

/// A command line that a shell reads back as these words.
[[nodiscard]] std::string shell_text(const std::vector<std::string>& words);

}  // namespace seldinger::apps
