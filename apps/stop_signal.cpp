// The thread that waits for SIGINT and SIGTERM, and its response to them.
#include "stop_signal.h"

#include "core/clock.h"
#include "core/error.h"
#include "core/exit_code.h"
#include "device/compiler_watch.h"

#include <fcntl.h>
#include <unistd.h>
#include <atomic>
#include <chrono>
#include <string_view>
#include <thread>

namespace seldinger::apps {
namespace {

constexpr std::chrono::seconds patience(8);  // under the ten that schedulers wait between SIGTERM and SIGKILL

std::atomic<int> received = 0, listeners = 0, deaf = 0;
std::atomic<const char*> how_to_go_on = "";
int own_stderr = STDERR_FILENO;  // one that nobody turns away while a compiler talks
std::atomic<bool> heard = false;  // a loop knows of it, and saves

sigset_t both_signals()
{
    sigset_t both;
    sigemptyset(&both);
    sigaddset(&both, SIGINT);
    sigaddset(&both, SIGTERM);
    return both;
}

/// As kill -9 would, but said: whole files appear by a rename, tables grow row by row, and what a file that was being written
/// leaves goes with the next run in its folder.
[[noreturn]] void end_at_once(int signal)
{
    const auto say = say_at_once;
    say(signal == SIGINT ? "seldinger: interrupted" : "seldinger: stopped by a signal");
    if (listeners > 0) {
        say(" before it could save; what was saved last is there, ");
        say(how_to_go_on.load());
    }
    say("\n");
    const ErrorKind code = signal == SIGINT ? ErrorKind::Interrupted : ErrorKind::TimeLimit;
    ::_exit(listeners == 0 ? 128 + signal : exit_code(code));
}

/// Not after a loop has responded: from then until the return from main, the orderly end is running.
bool nobody_asks(Clock::time_point since)
{
    if (heard) return false;
    return listeners == 0 || deaf > 0 || device::compiling_threads() > 0 || Clock::now() - since > patience;
}

[[noreturn]] void wait_for_signals()
{
    const sigset_t both = both_signals();
    Clock::time_point since;
    for (;;) {
        const timespec while_asked{0, 20'000'000};
        const int taken = received == 0 ? sigwaitinfo(&both, nullptr) : sigtimedwait(&both, nullptr, &while_asked);
        if (taken > 0 && received != 0) end_at_once(taken);
        if (taken > 0) since = Clock::now(), received = taken;
        if (received != 0 && nobody_asks(since)) end_at_once(received);
    }
}

}  // namespace

void say_at_once(std::string_view text) { (void)!::write(own_stderr, text.data(), text.size()); }

void watch_signals()
{
    const sigset_t both = both_signals();
    if (const int copy = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3); copy >= 0) own_stderr = copy;
    std::signal(SIGINT, SIG_DFL);  // also where a shell has them ignored for what runs in the background
    std::signal(SIGTERM, SIG_DFL);
    pthread_sigmask(SIG_BLOCK, &both, nullptr);
    std::thread(wait_for_signals).detach();
}

StopSignal::StopSignal(const char* advice)
{
    how_to_go_on = advice;
    ++listeners;
}

StopSignal::~StopSignal() { --listeners; }
NoPolling::NoPolling() { ++deaf; }
NoPolling::~NoPolling() { --deaf; }

int stop_asked_for()
{
    const int signal = received;
    if (signal != 0) heard = true;
    return signal;
}

}  // namespace seldinger::apps
