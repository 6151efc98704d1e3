// Runs the parts of a farm in processes of this program, as many at a time as asked for, beside other farms on the same folder.
#include "farm.h"

#include "core/child_process.h"
#include "core/file_lock.h"
#include "core/note.h"
#include "core/parallel.h"
#include "stop_signal.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

namespace seldinger::apps {
namespace {

class LocalFarm {
public:
    LocalFarm(const Folder& dir, const PartPlan& plan, const PartCommand& command, const LocalBackend& backend)
        : dir_(dir), plan_(plan), command_(command), backend_(backend), shows_(!backend.quiet && isatty(STDERR_FILENO))
    {
        // parts that run at a time share the cores: threads of one would wait for those of another
        const int shared = backend.jobs > 1 ? std::max(1, thread_count() / backend.jobs) : 0, threads = backend.threads > 0 ? backend.threads : shared;
        const auto add = [&](const char* option, int value) { command_.words.insert(command_.words.end(), {option, std::to_string(value)}); };
        add("--parent", getpid());
        if (threads > 0) add("--threads", threads);
        if (backend.device >= 0 && !plan.frames) add("--device", backend.device);
        for (std::size_t part = 1; part <= plan.parts; ++part) open_.push_back(part);
    }
    ~LocalFarm()
    {
        for (const Child& child : children_) kill(child.process, SIGTERM);
    }
    LocalFarm(const LocalFarm&) = delete;
    LocalFarm& operator=(const LocalFarm&) = delete;

    ExitCode run()
    {
        for (bool others = true; !children_.empty() || (others && asked_ == 0);) {
            others = start_free();
            reap();
            listen();
            if (shows_) note(fmt::format("\r\033[Ktask {} of {}{}", plan_.parts - open_.size(), plan_.parts, open_.empty() ? "\r\033[K" : ""));
            if (children_.empty() && others) wait_for_others();
            else if (!children_.empty()) nap(shows_ ? 100 : 5);
        }
        if (asked_ != 0) return asked_ == SIGINT ? ExitCode::Interrupted : ExitCode::TimeLimit;
        return static_cast<ExitCode>(worst_);
    }

private:
    struct Child {
        pid_t process;
        std::size_t part;
        FileLock lock;  // against other farms on this folder; the process has its own, against all
    };

    static void nap(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

    /// @return whether parts are left that others have, or that may still be started here
    bool start_free()
    {
        bool left = false;
        for (std::size_t k = 0; k < open_.size() && asked_ == 0;) {
            const std::size_t part = open_[k];
            if (std::any_of(children_.begin(), children_.end(), [&](const Child& child) { return child.part == part; })) {
                ++k;
                continue;
            }
            if (children_.size() >= static_cast<std::size_t>(backend_.jobs)) return true;
            const FilePlace file = part_file(dir_, plan_, part);
            std::optional<FileLock> lock = FileLock::if_free(file.beside(plan_.name(part)));
            if (!lock || !FileLock::if_free(file)) {
                left = true, ++k;
                continue;
            }
            if (is_done(dir_, plan_, part)) {
                open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
                continue;
            }
            const std::vector<std::string> words = command_.of(plan_, part);
            // of a group of its own: Ctrl-C reaches it by us alone, so once
            const pid_t process = start_program(words, no_descriptor, no_descriptor, no_descriptor, ProcessGroup::Own);
            if (process < 0) throw Error(ExitCode::BadFile, "a part: " + why_not_started(words.front(), "install the program again"));
            children_.push_back({process, part, std::move(*lock)});
            ++k;
        }
        return left;
    }

    /// A part that failed here, or ended its process, is not started again: it would do so again.
    void reap()
    {
        for (std::size_t k = children_.size(); k-- > 0;) {
            int status = 0;
            if (waitpid(children_[k].process, &status, WNOHANG) != children_[k].process) continue;
            worst_ = std::max(worst_, exit_code(status));
            std::erase(open_, children_[k].part);
            children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(k));
        }
    }

    void listen()
    {
        const int signal = stop_asked_for();
        if (signal == 0 || asked_ != 0) return;
        asked_ = signal;
        for (const Child& child : children_) kill(child.process, signal);
    }

    void wait_for_others()
    {
        if (!backend_.quiet && ++waits_ == 20)
            note(fmt::format("{}: waiting for {} tasks that other processes have\n", dir_.path().string(), open_.size()));
        nap(waits_ < 20 ? 50 : 250);
    }

    const Folder& dir_;
    const PartPlan& plan_;
    PartCommand command_;
    const LocalBackend& backend_;
    std::vector<std::size_t> open_;  // parts that are not known to be done and have not failed here
    std::vector<Child> children_;
    bool shows_;
    int worst_ = 0, asked_ = 0, waits_ = 0;
};

}  // namespace

ExitCode run_here(const Folder& dir, const PartPlan& plan, const PartCommand& command, const LocalBackend& backend)
{
    const StopSignal listening("run the same command again");
    return LocalFarm(dir, plan, command, backend).run();
}

}  // namespace seldinger::apps
