// Writes and submits a job array of Slurm, whose tasks run one part of a farm each, and the merge behind it.
#include "farm.h"

#include "core/child_process.h"
#include "core/file_io.h"
#include "core/printable.h"

#include <fmt/format.h>

#include <cstdio>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

struct Said {
    int code;
    std::string text;
};

Said ask(const std::string& command)
{
    std::string text;
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "re");
    if (!pipe) throw Error(ErrorKind::BadFile, why_not_started("sh", "it is needed to ask Slurm"));
    char part[4096];
    for (std::size_t got = 0; (got = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, got);
    return {exit_code(pclose(pipe)), text};
}

/// @return the job's number
std::string submitted(const std::vector<std::string>& words)
{
    const Said said = ask(shell_text(words));
    const std::string job = said.text.substr(0, said.text.find_first_of(";\n"));
    if (said.code != 0 || job.empty() || job.find_first_not_of("0123456789") != std::string::npos)
        throw Error(ErrorKind::BadFile,
                    fmt::format("{}: Slurm refuses it ({}); change the job with --sbatch, or take fewer --tasks",
                                shell_text(words), one_line(said.text)));
    return job;
}

/// A folder as a line #SBATCH carries it: in quotes for blanks and #, each % twice since Slurm puts the job's number in the place
/// of %j. Quotes and backslashes would end that, and a line break would make the rest of the name a command of the script.
std::string slurm_text(const fs::path& dir)
{
    std::string text;
    for (const char c : dir.string()) {
        if (c == '"' || c == '\\' || (c >= 0 && c < ' '))
            throw Error(ErrorKind::BadScene,
                        fmt::format("{}: a job's script cannot name a folder with {} in its name. Fix: choose another with -o",
                                    dir.string(),
                                    c == '"'    ? "a quotation mark"
                                    : c == '\\' ? "a backslash"
                                                : "a line break or tab"));
        text += c == '%' ? std::string("%%") : std::string(1, c);
    }
    return text;
}

/// TERM@60 goes to the job's steps: the part saves its state and ends with 75, and the script asks for another turn.
constexpr const char* script = R"(#!/bin/sh
#SBATCH --job-name=seldinger-farm
#SBATCH --output="{log}/slurm-%A_%a.txt"
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=TERM@60
{options}[ "$1" != merge ] || exec {merge}
task=$SLURM_ARRAY_TASK_ID
cpus=${{SLURM_CPUS_PER_TASK:-1}}
step="srun --ntasks=1 --cpus-per-task=$cpus"
command -v srun >/dev/null 2>&1 || step=
$step {part} --threads "$cpus" {which}
code=$?
# 75: stopped with its state saved. Ended by a signal (out of memory, a node that goes down): again too, three times
if [ $code -eq 75 ] || {{ [ $code -gt 128 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 3 ]; }}; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$task" && exit 0
fi
exit $code
)";

}  // namespace

std::string shell_text(const std::vector<std::string>& words)
{
    constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./,:@%+";
    std::string text;
    for (const std::string& word : words) {
        if (!text.empty()) text += ' ';
        if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) {
            text += word;
            continue;
        }
        text += '\'';
        for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
        text += '\'';
    }
    return text;
}

void check_job_script(const fs::path& dir, const std::vector<std::string>& options)
{
    (void)slurm_text(dir);
    for (const std::string& option : options)
        if (option.find_first_of("\r\n") != std::string::npos)
            throw Error(ErrorKind::BadScene,
                        "--sbatch: got a line break, which would make the rest a command of the job's script. Fix: give one "
                        "option, in one line, each time");
}

std::vector<std::string> write_slurm_job(const Folder& dir, const PartPlan& plan, const PartCommand& command,
                                         const std::vector<std::string>& options, const std::vector<std::size_t>& parts)
{
    const std::string which = !plan.frames
                                  ? fmt::format("--part \"$task/{}\"", plan.parts)
                                  : fmt::format("--frames \"$(({0} + (task - 1) * {1} / {2})):$(({0} + task * {1} / {2} - 1))\"",
                                                plan.first, plan.items, plan.parts);
    std::string lines;
    for (const std::string& option : options) lines += "#SBATCH " + option + "\n";
    using fmt::arg;
    const std::string text = fmt::format(script, arg("log", slurm_text(dir.make("log").path())), arg("options", lines),
                                         arg("part", shell_text(command.words)), arg("which", which),
                                         arg("merge", shell_text({command.words.front(), "farm", "merge", dir.path().string()})));
    write_file(dir / "job.sh", text);
    return {"sbatch", "--parsable", "--array=" + list_ranges(parts, ","), (dir.path() / "job.sh").string()};
}

void need_slurm()
{
    if (ask("command -v sbatch").code != 0)
        throw Error(ErrorKind::BadFile,
                    "--submit: there is no sbatch here; submit from a machine with Slurm (Debian: apt-get install "
                    "slurm-client), or give --backend local");
}

std::string submit(const Folder& dir, const std::vector<std::string>& array)
{
    const std::string job = submitted(array);
    const std::string merge =
        submitted({"sbatch", "--parsable", "--dependency=afterany:" + job,
                   "--output=" + slurm_text(dir.path() / "log") + "/slurm-merge-%j.txt", array.back(), "merge"});
    return fmt::format("  job {}: {}\n  job {}: merge, when they have ended\n", job, array[2], merge);
}

}  // namespace seldinger::apps
