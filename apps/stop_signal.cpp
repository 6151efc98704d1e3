// Handlers and masks of SIGINT and SIGTERM, obeyed also while an OpenCL driver has handlers of its own.
#include "stop_signal.h"

#include <ctime>

namespace seldinger::apps {
namespace {

volatile std::sig_atomic_t received = 0;

extern "C" void remember_signal(int signal) { received = signal; }

sigset_t both_signals()
{
    sigset_t both;
    sigemptyset(&both);
    sigaddset(&both, SIGINT);
    sigaddset(&both, SIGTERM);
    return both;
}

}  // namespace

// A compiler inside an OpenCL driver sets handlers of its own while it builds a kernel, and ends the process in them. So the
// signals are kept off this thread and those that it starts, and looked up where they wait; the handler is for threads that were
// there before.
StopSignal::StopSignal()
{
    struct sigaction action {};
    action.sa_handler = remember_signal;
    // reset after the first: whoever asks twice means now. Restart: a write that is cut off would be a damaged file
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
    const sigset_t both = both_signals();
    pthread_sigmask(SIG_BLOCK, &both, &old_mask_);
}

StopSignal::~StopSignal()
{
    (void)stop_asked_for();  // one that waits is taken as it was meant, not by the old handlers
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
    pthread_sigmask(SIG_SETMASK, &old_mask_, nullptr);
}

int stop_asked_for()
{
    if (received != 0) return received;
    sigset_t waiting;
    const sigset_t both = both_signals();
    if (sigpending(&waiting) != 0 || (sigismember(&waiting, SIGINT) != 1 && sigismember(&waiting, SIGTERM) != 1)) return 0;
    const timespec now{};
    const int taken = sigtimedwait(&both, nullptr, &now);
    if (taken <= 0) return received;  // another thread was faster
    received = taken;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    pthread_sigmask(SIG_UNBLOCK, &both, nullptr);
    return received;
}

}  // namespace seldinger::apps
