// Starts worker processes, or writes and submits Slurm's array jobs.
#include "farm_backend.h"

#include "core/child_process.h"
#include "core/file_io.h"
#include "core/note.h"
#include "core/parallel.h"
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
#include <utility>

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t default_array_size = 1001;  // Slurm's MaxArraySize unless configured: indices 0 to 1000

fs::path this_program() { return fs::read_symlink("/proc/self/exe"); }

pid_t start_worker(const std::vector<std::string>& words)
{
    const pid_t process = start_program(words, no_descriptor, no_descriptor, no_descriptor, ProcessGroup::Own);  // Ctrl-C reaches it by us alone, so once
    if (process < 0) throw Error(ExitCode::BadFile, "a worker: " + why_not_started(words.front(), "install the program again"));
    return process;
}

/// The workers of one command, and its progress report of the farm.
class LocalFarm {
public:
    LocalFarm(const Folder& dir, const FarmPlan& plan, const LocalBackend& backend)
        : dir_(dir), plan_(plan), shows_(!backend.quiet && isatty(STDERR_FILENO)), quiet_(backend.quiet)
    {
        words_ = {this_program().string(), "farm", "task", dir.path().string(), "--all", "--parent", std::to_string(getpid())};
        // tasks that run at a time share the cores: threads of one task would wait for those of another
        const int shared = backend.jobs > 1 ? std::max(1, thread_count() / backend.jobs) : 0, threads = backend.threads > 0 ? backend.threads : shared;
        if (threads > 0) words_.insert(words_.end(), {"--threads", std::to_string(threads)});
        if (backend.device >= 0) words_.insert(words_.end(), {"--device", std::to_string(backend.device)});
    }
    ~LocalFarm()
    {
        for (const pid_t worker : workers_) kill(worker, SIGTERM);
    }
    LocalFarm(const LocalFarm&) = delete;
    LocalFarm& operator=(const LocalFarm&) = delete;

    /// So many workers, each with every task that nobody has, until they have ended. @return the worst of their exit codes
    int work(std::size_t workers)
    {
        for (std::size_t k = 0; k < workers; ++k) workers_.push_back(start_worker(words_));
        int worst = 0;
        while (!workers_.empty()) {
            listen();
            for (std::size_t k = workers_.size(); k-- > 0;) {
                int status = 0;
                if (waitpid(workers_[k], &status, WNOHANG) != workers_[k]) continue;
                worst = std::max(worst, exit_code(status));
                workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(k));
            }
            show();
            if (!workers_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(shows_ ? 200 : 5));
        }
        return worst;
    }

    /// Until no worker of another command has a task. @return how many are not done then; 0 once a signal asks to end
    std::size_t wait_for_others()
    {
        using namespace std::chrono;
        waited_ = false;
        for (const auto begun = steady_clock::now(); asked_ == 0;) {
            const std::vector<TaskState> states = task_states(dir_, plan_);
            const auto running = static_cast<std::size_t>(std::count(states.begin(), states.end(), TaskState::Running));
            const auto done = static_cast<std::size_t>(std::count(states.begin(), states.end(), TaskState::Done));
            if (running == 0) return plan_.tasks - done;
            waited_ = true;
            if (!quiet_ && !told_ && steady_clock::now() - begun > seconds(1)) {
                told_ = true;
                note(fmt::format("{}: waiting for {} tasks that other workers have\n", dir_.path().string(), running));
            }
            // a twentieth of the wait so far, so that it costs little however long it is
            const auto nap = duration_cast<milliseconds>(steady_clock::now() - begun) / 20;
            for (auto left = std::clamp(nap, milliseconds(5), milliseconds(1000)); left > left.zero() && asked_ == 0; left -= milliseconds(50)) {
                std::this_thread::sleep_for(std::min(left, milliseconds(50)));
                listen();
            }
        }
        return 0;
    }

    [[nodiscard]] bool waited() const { return waited_; }  // for others, the last time
    [[nodiscard]] int asked() const { return asked_; }     // the signal to end, or 0

private:
    void listen()
    {
        const int signal = stop_asked_for();
        if (signal == 0 || asked_ != 0) return;
        asked_ = signal;
        for (const pid_t worker : workers_) kill(worker, signal);
    }
    void show() const
    {
        if (!shows_) return;
        const std::size_t done = dir_.inner("done").names().size();
        note(fmt::format("\r\033[Ktask {} of {}{}", done, plan_.tasks, workers_.empty() ? "\r\033[K" : ""));
    }

    const Folder& dir_;
    const FarmPlan& plan_;
    std::vector<std::string> words_;
    std::vector<pid_t> workers_;
    bool shows_, quiet_, told_ = false, waited_ = false;
    int asked_ = 0;
};

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
                    slurm_text(dir.inner("log").path()), output);
    for (const std::string& option : options) text += "#SBATCH " + option + "\n";
    return text;
}

/// TERM@60 goes to the job's steps: the task saves its state and ends with 75, and the script asks for another turn.
std::string job_script(const Folder& dir, const SlurmBackend& backend)
{
    return head(dir, "task", "slurm-%A_%a.txt", backend.options) + fmt::format(R"(#SBATCH --requeue
#SBATCH --signal=TERM@60
# task = index in the array + an offset given at submission (an array holds some 1,000)
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
    LocalFarm farm(dir, plan, backend);
    int worst = 0;
    std::size_t left = plan.tasks, before = 0;
    // again for what others have left undone; not for what failed or ended a worker here, which would do so again
    do {
        before = left;
        worst = farm.work(std::min(static_cast<std::size_t>(backend.jobs), left));
        if (worst == 0 && farm.asked() == 0) left = farm.wait_for_others();
    } while (worst == 0 && farm.asked() == 0 && left > 0 && (left < before || farm.waited()));
    if (farm.asked() != 0) return farm.asked() == SIGINT ? ExitCode::Interrupted : ExitCode::TimeLimit;
    return static_cast<ExitCode>(worst);
}

void check_job_scripts(const fs::path& dir, const std::vector<std::string>& options)
{
    (void)slurm_text(dir);
    for (const std::string& option : options)
        if (option.find_first_of("\r\n") != std::string::npos)
            throw Error(ExitCode::BadScene, "--sbatch: got a line break, which would make the rest a command of the job's script. Fix: give one "
                                            "option, in one line, each time");
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
