// A driver's compiler that ends the process: the message names the device, with the compiler's last words.
#include "device/compiler_watch.h"

#include <doctest/doctest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

namespace test_compiler_watch {

using seldinger::device::CompilerWatch;

namespace {

struct Ending {
    std::string words;
    int status = 0;
};

/// What a process says and how it ends whose compiler does that.
Ending ending_of(const std::function<void()>& compile)
{
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDERR_FILENO);
        close(ends[0]);
        compile();
        _exit(0);
    }
    close(ends[1]);
    Ending ending;
    char part[256];
    for (ssize_t got; (got = read(ends[0], part, sizeof part)) > 0;) ending.words.append(part, static_cast<std::size_t>(got));
    close(ends[0]);
    REQUIRE(waitpid(child, &ending.status, 0) == child);
    return ending;
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void say_and_exit()
{
    const CompilerWatch watch("device \"X\"");
    std::fputs("Unexpected\n\033[31mintrinsic\n", stderr);
    std::exit(8);
}

}  // namespace

TEST_SUITE("device/compiler_watch")
{
    TEST_CASE("regression: a compiler that calls exit() is named, with its last words on one line")
    {
        const Ending ending = ending_of(say_and_exit);
        CHECK(WIFEXITED(ending.status));
        CHECK(WEXITSTATUS(ending.status) == 5);
        CHECK(ending.words == "device \"X\". The driver's last words: Unexpected  [31mintrinsic \n");
    }

    TEST_CASE("property: a compiler that crashes is named")
    {
        for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE}) {
            CAPTURE(signal);
            const Ending ending = ending_of([&] {
                const CompilerWatch watch("device \"X\"");
                raise(signal);
            });
            CHECK(WIFEXITED(ending.status));
            CHECK(WEXITSTATUS(ending.status) == 5);
            CHECK(ending.words == "device \"X\"\n");
        }
    }

    TEST_CASE("property: what ends the process after a compiler's call, or beside it, is as without it")
    {
        const Ending after = ending_of([] {
            { const CompilerWatch watch("device \"X\""); }
            std::fputs("later\n", stderr);
            std::signal(SIGTERM, SIG_DFL);  // doctest has one of its own
            raise(SIGTERM);
        });
        CHECK(after.words == "later\n");
        CHECK(WIFSIGNALED(after.status));
        const Ending crash = ending_of([] {
            { const CompilerWatch watch("device \"X\""); }
            std::signal(SIGABRT, SIG_DFL);
            raise(SIGABRT);
        });
        CHECK(WIFSIGNALED(crash.status));
        CHECK_FALSE(holds(crash.words, "device"));
        const Ending beside = ending_of([] {
            const CompilerWatch watch("device \"X\"");
            std::thread([] { std::exit(3); }).join();
        });
        CHECK(WEXITSTATUS(beside.status) == 3);
        CHECK(beside.words.empty());
    }
}

}  // namespace test_compiler_watch
