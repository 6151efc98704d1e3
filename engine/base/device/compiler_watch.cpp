// Catches exit() and the signals of a crash in the thread that compiles. Once the process ends, only calls that are safe in a
// signal handler are made: the message is complete beforehand.
#include "core/exit_code.h"
#include "device/compiler_watch.h"

#include "core/error.h"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>

namespace seldinger::device {
namespace {

constexpr std::array<int, 5> crashes = {SIGABRT, SIGSEGV, SIGBUS, SIGILL, SIGFPE};
constexpr int no_stderr = -1;

std::atomic<int> threads = 0;
std::mutex watching;
std::atomic<bool> compiling = false;
// of the call in progress; under `watching`
std::string notice;
pthread_t compiler;
int true_stderr = no_stderr, kept_back = no_stderr;
std::array<struct sigaction, crashes.size()> before;

void print(const char* words, std::size_t size)
{
    if (write(true_stderr == no_stderr ? STDERR_FILENO : true_stderr, words, size) < 0) return;  // nobody to tell
}

/// The end of what the compiler wrote, on one line.
void print_last_words()
{
    char words[240];
    const off_t size = kept_back == no_stderr ? 0 : lseek(kept_back, 0, SEEK_END);
    const off_t from = size > static_cast<off_t>(sizeof words) ? size - static_cast<off_t>(sizeof words) : 0;
    const ssize_t got = size > 0 ? pread(kept_back, words, sizeof words, from) : 0;
    if (got <= 0) return;
    for (ssize_t k = 0; k < got; ++k)
        if (words[k] < ' ' || words[k] > '~') words[k] = ' ';  // lines, and what a terminal would obey
    constexpr char opening[] = ". The driver's last words: ";
    print(opening, sizeof opening - 1);
    print(words, static_cast<std::size_t>(got));
}

bool ends_the_compiler() { return compiling && pthread_equal(compiler, pthread_self()); }

[[noreturn]] void end_with_message()
{
    print(notice.data(), notice.size());
    print_last_words();
    print("\n", 1);
    _exit(exit_code(ErrorKind::NoDevice));
}

void at_exit()
{
    if (ends_the_compiler()) end_with_message();
}

void at_crash(int signal)
{
    if (ends_the_compiler()) end_with_message();
    for (std::size_t k = 0; k < crashes.size(); ++k)
        if (crashes[k] == signal) sigaction(signal, &before[k], nullptr);  // another thread's: as without us
    raise(signal);
}

}  // namespace

int compiling_threads() { return threads; }

CompilerBusy::CompilerBusy() { ++threads; }
CompilerBusy::~CompilerBusy() { --threads; }

CompilerWatch::CompilerWatch(const std::string& message)
{
    watching.lock();
    static std::once_flag once;
    std::call_once(once, [] { std::atexit(at_exit); });
    notice = message;
    compiler = pthread_self();
    std::fflush(stderr);
    kept_back = memfd_create("compiler", MFD_CLOEXEC);
    if (kept_back != no_stderr && (true_stderr = dup(STDERR_FILENO)) != no_stderr) dup2(kept_back, STDERR_FILENO);
    struct sigaction crash = {};
    crash.sa_handler = at_crash;
    sigemptyset(&crash.sa_mask);
    for (std::size_t k = 0; k < crashes.size(); ++k) sigaction(crashes[k], &crash, &before[k]);
    compiling = true;
}

CompilerWatch::~CompilerWatch()
{
    compiling = false;
    for (std::size_t k = 0; k < crashes.size(); ++k) sigaction(crashes[k], &before[k], nullptr);
    if (true_stderr != no_stderr) {
        dup2(true_stderr, STDERR_FILENO);
        close(true_stderr);
    }
    if (kept_back != no_stderr) close(kept_back);
    true_stderr = kept_back = no_stderr;
    watching.unlock();
}

}  // namespace seldinger::device
