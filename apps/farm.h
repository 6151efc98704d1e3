#pragma once
// Who runs the parts of a farm: processes of this program here, or Slurm's array jobs.

#include "batch/parts.h"
#include "core/error.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace seldinger::apps {

class CommandLine;

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
/// Runs every part that is not done, in `jobs` processes at a time, and waits for those that others run.
/// @return Done, or TimeLimit, Interrupted after a signal, or a failed part's code. @throws Error
ErrorKind run_here(const Folder& dir, const PartPlan& plan, const PartCommand& command, const LocalBackend& backend);

/// The options that say who runs the parts.
struct FarmBackend {
    std::string name = "local";
    std::optional<int> tasks;
    LocalBackend local;
    std::vector<std::string> sbatch;
    bool submit = false, dry_run = false;

    void declare(CommandLine& command);
    /// What its words alone can get wrong. @param dir  absolute   @throws Error BadScene, BadFile
    void check(const std::filesystem::path& dir) const;
    /// As many parts as asked for, or as the folder has, or as suit who runs them. @throws Error BadScene
    [[nodiscard]] std::size_t part_count(const std::filesystem::path& dir, std::size_t items, const char* word) const;
    /// Runs what is not done here, or gives it to Slurm, or prints it. @param command  without the program's name
    /// @param merge  where all is there   @throws Error
    ErrorKind run(const std::filesystem::path& dir, const PartPlan& plan, PartCommand command,
                  const std::function<ErrorKind()>& merge) const;
};

/// Refuses a folder or an option that would become commands of a job's script. Before anything is made. @throws Error BadScene
void check_job_script(const std::filesystem::path& dir, const std::vector<std::string>& options);
/// Writes DIR/job.sh. @param options  of sbatch. @return the command that submits these parts, as words
[[nodiscard]] std::vector<std::string> write_slurm_job(const Folder& dir, const PartPlan& plan, const PartCommand& command,
                                                       const std::vector<std::string>& options,
                                                       const std::vector<std::size_t>& parts);
/// Submits it and the merge behind it. @return what to tell. @throws Error BadFile: Slurm refuses
[[nodiscard]] std::string submit(const Folder& dir, const std::vector<std::string>& array);
/// @throws Error BadFile: there is no sbatch
void need_slurm();

/// A command line that a shell reads back as these words.
[[nodiscard]] std::string shell_text(const std::vector<std::string>& words);

}  // namespace seldinger::apps
