// Starts programs with default signals (posix_spawn), and waits for them.
#include "core/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

extern char** environ;

namespace seldinger {
namespace {

/// POSIX's two lists of what happens between fork and exec.
struct HowToStart {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;

    HowToStart()
    {
        posix_spawn_file_actions_init(&files);
        posix_spawnattr_init(&attributes);
    }
    ~HowToStart()
    {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }
    HowToStart(const HowToStart&) = delete;
    HowToStart& operator=(const HowToStart&) = delete;
};

}  // namespace

pid_t start_program(const std::vector<std::string>& words, int input, int error, int output, ProcessGroup group)
{
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    HowToStart how;
    if (input >= 0) posix_spawn_file_actions_adddup2(&how.files, input, STDIN_FILENO);
    else posix_spawn_file_actions_addopen(&how.files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (error >= 0) posix_spawn_file_actions_adddup2(&how.files, error, STDERR_FILENO);
    if (output >= 0) posix_spawn_file_actions_adddup2(&how.files, output, STDOUT_FILENO);
    sigset_t none;
    sigemptyset(&none);
    const int own_group = group == ProcessGroup::Own ? POSIX_SPAWN_SETPGROUP : 0;
    posix_spawnattr_setflags(&how.attributes, static_cast<short>(POSIX_SPAWN_SETSIGMASK | own_group));
    posix_spawnattr_setsigmask(&how.attributes, &none);
    pid_t process = -1;
    errno = posix_spawnp(&process, arguments[0], &how.files, &how.attributes, arguments.data(), environ);
    return errno == 0 ? process : -1;
}

void end_with_parent(pid_t parent, int signal)
{
    (void)::prctl(PR_SET_PDEATHSIG, signal);
    if (::getppid() != parent) ::kill(::getpid(), signal);  // ended before it could be asked for
}

std::string why_not_started(const std::string& program, const std::string& advice)
{
    if (errno == ENOENT) return program + " is not installed; " + advice;
    const char* fix = errno == EAGAIN || errno == ENOMEM ? "; raise the limits of memory and processes (ulimit -a)" : "";
    return fmt::format("{} cannot be started: {}{}", program, std::strerror(errno), fix);
}

int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

int wait_for_program(pid_t process)
{
    int status = 0;
    while (waitpid(process, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return exit_code(status);
}

}  // namespace seldinger
