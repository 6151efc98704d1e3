// Starts worker processes, or writes and submits Slurm's array jobs.
#include "farm_backend.h"

#include "core/child_process.h"
#include "core/file_io.h"
#include "core/note.h"
#include "core/printable.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <thread>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t default_array_size = 1001;  // Slurm's MaxArraySize unless configured: indices 0 to 1000

fs::path this_program() { return fs::read_symlink("/proc/self/exe"); }

pid_t start_worker(const std::vector<std::string>& words)
{
    const pid_t process = start_program(words);
    if (process < 0) throw Error(ExitCode::BadFile, words.front() + ": cannot be started as a worker");
    return process;
}

struct Said {
    int code;
    std::string text;
};

Said ask(const std::string& command)
{
    std::string text;
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "re");
    if (!pipe) return {127, {}};
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
                    slurm_text(dir.inner("log").path()), output);
    for (const std::string& option : options) {
        if (option.find_first_of("\r\n") != std::string::npos)
            throw Error(ExitCode::BadScene, "--sbatch: got a line break, which would make the rest a command of the job's script. Fix: give one "
                                            "option, in one line, each time");
        text += "#SBATCH " + option + "\n";
    }
    return text;
}

/// TERM@60 goes to the job's steps: the task saves its state and ends with 75, and the script asks for another turn.
std::string job_script(const Folder& dir, const SlurmBackend& backend)
{
    return head(dir, "task", "slurm-%A_%a.txt", backend.options) + fmt::format(R"(#SBATCH --requeue
#SBATCH --signal=TERM@60
# task = index in the array + what was submitted with it (an array holds some 1,000)
task=$((SLURM_ARRAY_TASK_ID + ${{1:-0}}))
cpus=${{SLURM_CPUS_PER_TASK:-1}}
step="srun --ntasks=1 --cpus-per-task=$cpus"
command -v srun >/dev/null 2>&1 || step=
$step {} farm task {} "$task" --threads "$cpus"
code=$?
# 75: stopped with its state saved. Ended by a signal (out of memory, a node that goes down): again too, three times
if [ $code -eq 75 ] || {{ [ $code -gt 128 ] && [ "${{SLURM_RESTART_COUNT:-0}}" -lt 3 ]; }}; then
    scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && exit 0
fi
exit $code
)",
                                                                               shell_text({this_program().string()}),
                                                                               shell_text({dir.path().string()}));
}

std::string merge_script(const Folder& dir)
{
    return head(dir, "merge", "slurm-merge-%j.txt", {}) +
           fmt::format("exec {} farm merge {}\n", shell_text({this_program().string()}), shell_text({dir.path().string()}));
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

ExitCode run_here(const Folder& dir, const FarmPlan& plan, const LocalBackend& backend)
{
    const StopSignal listening;
    std::vector<std::string> words = {this_program().string(), "farm", "task", dir.path().string(), "--all"};
    if (backend.threads > 0) words.insert(words.end(), {"--threads", std::to_string(backend.threads)});
    if (backend.device >= 0) words.insert(words.end(), {"--device", std::to_string(backend.device)});
    std::vector<pid_t> workers;
    for (int k = 0; k < backend.jobs; ++k) workers.push_back(start_worker(words));
    const bool shows = !backend.quiet && isatty(STDERR_FILENO);
    int worst = 0, asked = 0;
    while (!workers.empty()) {
        if (const int signal = stop_asked_for(); signal != 0 && asked == 0) {
            asked = signal;
            for (const pid_t worker : workers) kill(worker, signal);
        }
        for (std::size_t k = workers.size(); k-- > 0;) {
            int status = 0;
            if (waitpid(workers[k], &status, WNOHANG) != workers[k]) continue;
            worst = std::max(worst, exit_code(status));
            workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(k));
        }
        if (shows) {
            const std::size_t done = dir.inner("done").names().size();
            note(fmt::format("\r\033[Ktask {} of {}{}", done, plan.tasks, workers.empty() ? "\r\033[K" : ""));
        }
        if (!workers.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(shows ? 200 : 5));
    }
    if (asked != 0) return asked == SIGINT ? ExitCode::Interrupted : ExitCode::TimeLimit;
    return static_cast<ExitCode>(worst);
}

std::vector<std::vector<std::string>> write_slurm_jobs(const Folder& dir, const FarmPlan& plan, const SlurmBackend& backend)
{
    const std::string job = job_script(dir, backend), merge = merge_script(dir);  // refused before either is written
    write_file(dir / "job.sh", job);
    write_file(dir / "merge.sh", merge);
    const FarmReport report = look_at_farm(dir, plan);
    const std::size_t most = array_size() - 1;
    std::vector<std::vector<std::string>> arrays;
    for (std::size_t offset = 0; offset < plan.tasks; offset += most) {
        std::vector<std::size_t> indices;
        for (std::size_t t = offset; t < std::min(plan.tasks, offset + most); ++t)
            if (report.state[t] != TaskState::Done) indices.push_back(t - offset);
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
