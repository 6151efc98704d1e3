// Runs plot scripts with Debian's python3.
#include "assets.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <spawn.h>
#include <sys/wait.h>
#include <csignal>
#include <filesystem>

extern char** environ;

namespace seldinger::apps {
namespace {

namespace fs = std::filesystem;

std::string python()
{
    // Debian's own: another python3 ahead of it in PATH need not have its packages
    return fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
}

/// Exit code, or -1 when the program could not be started.
int run_program(const std::vector<std::string>& words)
{
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    pid_t child = 0;
    int status = 0;
    // signals that wait for a thread of ours are its own business: it hears them as usual
    posix_spawnattr_t how;
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&how);
    posix_spawnattr_setflags(&how, POSIX_SPAWN_SETSIGMASK);
    posix_spawnattr_setsigmask(&how, &none);
    const int problem = posix_spawnp(&child, argv[0], nullptr, &how, argv.data(), environ);
    posix_spawnattr_destroy(&how);
    if (problem != 0) return -1;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

bool draw_with(const std::string& script, const std::vector<std::string>& arguments)
{
    std::vector<std::string> words = {python(), (assets_folder() / script).string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    if (run_program(words) == 0) return true;
    fmt::print(stderr, "seldinger: no pictures: {} failed; it needs python3-matplotlib; to draw them: {}\n", script,
               fmt::join(words, " "));
    return false;
}

}  // namespace seldinger::apps
