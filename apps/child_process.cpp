// Starts the program again with pipes for stdin and stdout, and waits for it while it listens for signals.
#include "child_process.h"

#include "core/error.h"
#include "stop_signal.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstring>

extern char** environ;

namespace seldinger::apps {
namespace {

constexpr int look_every = 50;  // for a signal [ms]

class Pipe {
public:
    Pipe()
    {
        if (::pipe2(ends_.data(), O_CLOEXEC) != 0)
            throw Error(ErrorKind::Stopped, fmt::format("no pipe could be made: {}", std::strerror(errno)));
    }
    ~Pipe() { shut(0), shut(1); }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    [[nodiscard]] int end(int which) const { return ends_[static_cast<std::size_t>(which)]; }
    void shut(int which)
    {
        int& file = ends_[static_cast<std::size_t>(which)];
        if (file >= 0) ::close(file);
        file = -1;
    }

private:
    std::array<int, 2> ends_{-1, -1};  // to read from, to write to
};

pid_t start(const std::vector<std::string>& arguments, const Pipe& input, const Pipe& output)
{
    std::string own = "seldinger";
    std::vector<std::string> texts = arguments;
    std::vector<char*> argv = {own.data()};
    for (std::string& text : texts) argv.push_back(text.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, input.end(0), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, output.end(1), STDOUT_FILENO);
    posix_spawnattr_t how;
    posix_spawnattr_init(&how);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETPGROUP);  // Ctrl-C reaches it by us alone, so once
    pid_t child = 0;
    const int failed = ::posix_spawn(&child, "/proc/self/exe", &files, &how, argv.data(), environ);
    posix_spawnattr_destroy(&how);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0) throw Error(ErrorKind::Stopped, fmt::format("no process could be started: {}", std::strerror(failed)));
    return child;
}

/// What arrives until the other end is shut.
std::string read_all(int file, pid_t child)
{
    std::string text;
    bool told = false;
    std::array<char, 4096> bytes{};
    for (;;) {
        pollfd ready{file, POLLIN, 0};
        const int count = ::poll(&ready, 1, look_every);
        if (const int signal = told ? 0 : stop_asked_for(); signal != 0) told = true, ::kill(child, signal);
        if (count <= 0) continue;
        const ssize_t got = ::read(file, bytes.data(), bytes.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return text;
        text.append(bytes.data(), static_cast<std::size_t>(got));
    }
}

}  // namespace

ChildEnd run_self(const std::vector<std::string>& arguments, const std::string& input)
{
    Pipe to, from;
    const pid_t child = start(arguments, to, from);
    to.shut(0), from.shut(1);
    for (std::size_t at = 0; at < input.size();) {
        const ssize_t put = ::write(to.end(1), input.data() + at, input.size() - at);
        if (put < 0 && errno != EINTR) break;  // it has ended, and its exit code says why
        if (put > 0) at += static_cast<std::size_t>(put);
    }
    to.shut(1);
    ChildEnd end;
    end.out = read_all(from.end(0), child);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    end.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return end;
}

}  // namespace seldinger::apps
