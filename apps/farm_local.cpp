// Runs the parts of a farm in processes of this program, as many at a time as asked for, beside other farms on the same folder.
#include "farm.h"

#include "core/child_process.h"
#include "core/exit_code.h"
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
        : dir_(dir),
          plan_(plan),
          command_(command),
          jobs_(static_cast<std::size_t>(backend.jobs)),
          quiet_(backend.quiet),
          shows_(!backend.quiet && isatty(STDERR_FILENO))
    {
        // parts that run at a time share the cores: threads of one would wait for those of another
        const int shared = backend.jobs > 1 ? std::max(1, thread_count() / backend.jobs) : 0,
                  threads = backend.threads > 0 ? backend.threads : shared;
        const auto add = [&](const char* option, int value) {
            command_.words.insert(command_.words.end(), {option, std::to_string(value)});
        };
        add("--parent", getpid());
        if (threads > 0) add("--threads", threads);
        if (backend.device >= 0 && (!plan.frames || plan.of_dataset())) add("--device", backend.device);
        for (std::size_t part = 1; part <= plan.parts; ++part) open_.push_back(part);
    }
    ~LocalFarm()
    {
        for (const Child& child : children_) kill(child.process, SIGTERM);
    }
    LocalFarm(const LocalFarm&) = delete;
    LocalFarm& operator=(const LocalFarm&) = delete;

    ErrorKind run()
    {
        for (bool left = true; !children_.empty() || (left && asked_ == 0);) {
            left = asked_ == 0 && start_free();
            reap();
            if (asked_ == 0 && (asked_ = stop_asked_for()) != 0)
                for (const Child& child : children_) kill(child.process, asked_);
            if (shows_) show();
            const bool waits = children_.empty() && left;
            if (waits && !quiet_ && ++waits_ == 20)
                note(fmt::format("{}: waiting for {} tasks that other processes have\n", dir_.path().string(), open_.size()));
            std::this_thread::sleep_for(std::chrono::milliseconds(waits ? 50 : shows_ ? 100 : 5));
        }
        if (asked_ != 0) return asked_ == SIGINT ? ErrorKind::Interrupted : ErrorKind::TimeLimit;
        return kind_of_exit_code(worst_);
    }

private:
    /// Tasks that are done, and the time that the rest takes if it goes on like this.
    void show() const
    {
        const std::size_t done = plan_.parts - open_.size();
        std::string left;
        if (ended_ > 0 && !open_.empty())
            left =
                fmt::format(", {:.0f} s left", std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() *
                                                   static_cast<double>(open_.size()) / static_cast<double>(ended_));
        note(fmt::format("\r\033[Ktask {} of {}{}{}", done, plan_.parts, left, open_.empty() ? "\r\033[K" : ""));
    }

    struct Child {
        pid_t process;
        std::size_t part;
        FileLock lock;  // against other farms on this folder; the process has its own, against all
    };

    /// @return whether parts are left: others have them, or there is no room now
    bool start_free()
    {
        bool left = false;
        const std::vector<std::size_t> open = open_;
        for (const std::size_t part : open) {
            if (std::any_of(children_.begin(), children_.end(), [&](const Child& child) { return child.part == part; })) continue;
            if (children_.size() >= jobs_) return true;
            const FilePlace file = part_file(dir_, plan_, part);
            std::optional<FileLock> lock = FileLock::if_free(file.beside(plan_.name(part)));
            if (!lock || !FileLock::if_free(file)) left = true;
            else if (is_done(dir_, plan_, part)) std::erase(open_, part);
            else start(part, std::move(*lock));
        }
        return left;
    }

    void start(std::size_t part, FileLock lock)
    {
        const std::vector<std::string> words = command_.of(plan_, part);
        // of a group of its own: Ctrl-C reaches it by us alone, so once
        const pid_t process = start_program(words, no_descriptor, no_descriptor, no_descriptor, ProcessGroup::Own);
        if (process < 0)
            throw Error(ErrorKind::BadFile, "a part: " + why_not_started(words.front(), "install the program again"));
        children_.push_back({process, part, std::move(lock)});
    }

    /// A part that failed here, or ended its process, is not started again: it would do so again.
    void reap()
    {
        std::erase_if(children_, [&](const Child& child) {
            int status = 0;
            if (waitpid(child.process, &status, WNOHANG) != child.process) return false;
            worst_ = std::max(worst_, exit_code(status));
            std::erase(open_, child.part);
            ++ended_;
            return true;
        });
    }

    const Folder& dir_;
    const PartPlan& plan_;
    PartCommand command_;
    std::size_t jobs_;
    std::vector<std::size_t> open_;  // parts that are not known to be done and have not failed here
    std::vector<Child> children_;
    bool quiet_, shows_;
    int worst_ = 0, asked_ = 0, waits_ = 0;
    std::size_t ended_ = 0;  // here
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

ErrorKind run_here(const Folder& dir, const PartPlan& plan, const PartCommand& command, const LocalBackend& backend)
{
    const StopSignal listening("run the same command again");
    return LocalFarm(dir, plan, command, backend).run();
}

}  // namespace seldinger::apps
