// Writes and submits Slurm's array jobs, one of which runs one part of a farm.
#include "farm.h"

#include "core/child_process.h"
#include "core/file_io.h"
#include "core/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t default_array_size = 1001;  // Slurm's MaxArraySize unless configured: indices 0 to 1000

struct Said {
    int code;
    std::string text;
};

Said ask(const std::string& command)
{
    std::string text;
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "re");
    if (!pipe) throw Error(ExitCode::BadFile, why_not_started("sh", "it is needed to ask Slurm"));
    char part[4096];
    for (std::size_t got = 0; (got = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, got);
    const int code = exit_code(pclose(pipe));
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return {code, text};
}

std::size_t array_size()
{
    const Said said = ask("scontrol show config");
    const std::size_t at = said.text.find("MaxArraySize");
    const std::size_t equals = at == std::string::npos ? at : said.text.find('=', at);
    if (said.code != 0 || equals == std::string::npos) return default_array_size;
    return std::max(2ul, std::strtoul(said.text.c_str() + equals + 1, nullptr, 10));
}

/// A folder as a line #SBATCH carries it: in quotes for blanks and #, each % twice since Slurm puts the job's number in the place of %j.
/// Quotes and backslashes would end that, and a line break would make the rest of the name a command of the script.
std::string slurm_text(const fs::path& dir)
{
    std::string text;
    for (const char c : dir.string()) {
        if (c == '"' || c == '\\' || (c >= 0 && c < ' '))
            throw Error(ExitCode::BadScene, fmt::format("{}: a job's script cannot name a folder with {} in its name. Fix: choose another with -o",
                                                        dir.string(), c == '"' ? "a quotation mark" : c == '\\' ? "a backslash" : "a line break or tab"));
        text += c == '%' ? std::string("%%") : std::string(1, c);
    }
    return text;
}

std::string head(const Folder& dir, const char* what, const char* output, const std::vector<std::string>& options)
{
    std::string text =
        fmt::format("#!/bin/sh\n#SBATCH --job-name=seldinger-{}\n#SBATCH --output=\"{}/{}\"\n#SBATCH --open-mode=append\n", what,
                    slurm_text(dir.path() / "log"), output);
    for (const std::string& option : options) text += "#SBATCH " + option + "\n";
    return text;
}

/// The shell's words for a part's number or frames, where $task is the part.
std::string part_in_shell(const PartPlan& plan)
{
    if (!plan.frames) return fmt::format("\"$task/{}\"", plan.parts);
    return fmt::format("\"$(({0} + (task - 1) * {1} / {2})):$(({0} + task * {1} / {2} - 1))\"", plan.first, plan.items, plan.parts);
}

/// TERM@60 goes to the job's steps: the part saves its state and ends with 75, and the script asks for another turn.
std::string job_script(const Folder& dir, const PartPlan& plan, const PartCommand& command, const std::vector<std::string>& options)
{
    return head(dir, "task", "slurm-%A_%a.txt", options) + fmt::format(R"(#SBATCH --requeue
#SBATCH --signal=TERM@60
# task = index in the array + an offset given at submission (an array holds some 1,000)
task=$((SLURM_ARRAY_TASK_ID + ${{1:-0}}))
cpus=${{SLURM_CPUS_PER_TASK:-1}}
step="srun --ntasks=1 --cpus-per-task=$cpus"
command -v srun >/dev/null 2>&1 || step=
$step {} --threads "$cpus" {} {}
code=$?
# 75: stopped with its state saved. Ended by a signal (out of memory, a node that goes down): again too, three times
if [ $code -eq 75 ] || {{ [ $code -gt 128 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 3 ]; }}; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && exit 0
fi
exit $code
)",
                                                                        shell_text(command.words), command.option, part_in_shell(plan));
}

std::string merge_script(const Folder& dir, const PartCommand& command)
{
    return head(dir, "merge", "slurm-merge-%j.txt", {}) +
           fmt::format("exec {} farm merge {}\n", shell_text({command.words.front()}), shell_text({dir.path().string()}));
}

}  // namespace

std::string shell_text(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) {
        if (!text.empty()) text += ' ';
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                                "-_=./,:@%+") == std::string::npos;
        if (plain) {
            text += word;
            continue;
        }
        text += '\'';
        for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
        text += '\'';
    }
    return text;
}

void check_job_scripts(const fs::path& dir, const std::vector<std::string>& options)
{
    (void)slurm_text(dir);
    for (const std::string& option : options)
        if (option.find_first_of("\r\n") != std::string::npos)
            throw Error(ExitCode::BadScene, "--sbatch: got a line break, which would make the rest a command of the job's script. Fix: give one "
                                            "option, in one line, each time");
}

std::vector<std::vector<std::string>> write_slurm_jobs(const Folder& dir, const PartPlan& plan, const PartCommand& command,
                                                       const std::vector<std::string>& options)
{
    const std::string job = job_script(dir, plan, command, options), merge = merge_script(dir, command);  // refused before either is written
    (void)dir.make("log");
    write_file(dir / "job.sh", job);
    write_file(dir / "merge.sh", merge);
    const std::size_t most = array_size() - 1;
    std::vector<std::vector<std::string>> arrays;
    for (std::size_t offset = 0; offset < plan.parts; offset += most) {
        std::vector<std::size_t> indices;
        for (std::size_t part = offset + 1; part <= std::min(plan.parts, offset + most); ++part)
            if (!is_done(dir, plan, part)) indices.push_back(part - offset);
        if (indices.empty()) continue;
        arrays.push_back(
            {"sbatch", "--parsable", "--array=" + list_ranges(indices, ","), (dir.path() / "job.sh").string(), std::to_string(offset)});
    }
    return arrays;
}

void need_slurm()
{
    if (ask("command -v sbatch").code != 0)
        throw Error(ExitCode::BadFile,
                    "--submit: there is no sbatch here; submit from a machine with Slurm (Debian: apt-get install "
                    "slurm-client), or give --backend local");
}

std::string submit(const Folder& dir, const std::vector<std::vector<std::string>>& arrays)
{
    const auto submitted = [](const std::vector<std::string>& words) {
        const Said said = ask(shell_text(words));
        const std::string job = said.text.substr(0, said.text.find_first_of(";\n"));
        if (said.code != 0 || job.empty() || job.find_first_not_of("0123456789") != std::string::npos) {
            throw Error(ExitCode::BadFile, fmt::format("{}: Slurm refuses it ({}); change the job with --sbatch",
                                                       shell_text(words), one_line(said.text)));
        }
        return job;
    };
    std::string told, jobs;
    for (const std::vector<std::string>& array : arrays) {
        const std::string job = submitted(array);
        jobs += ":" + job;
        told += fmt::format("  job {}: {}\n", job, array[2]);
    }
    if (jobs.empty()) return told;
    return told + fmt::format("  job {}: merge, when they have ended\n",
                              submitted({"sbatch", "--parsable", "--dependency=afterany" + jobs, (dir.path() / "merge.sh").string()}));
}

}  // namespace seldinger::apps
