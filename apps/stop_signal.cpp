#include "stop_signal.h"

namespace seldinger::apps {
namespace {

volatile std::sig_atomic_t received = 0;

extern "C" void remember_signal(int signal) { received = signal; }

}  // namespace

StopSignal::StopSignal()
{
    struct sigaction action {};
    action.sa_handler = remember_signal;
    // reset after the first: whoever asks twice means now. Restart: a write that is cut off would be a damaged file
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
}

StopSignal::~StopSignal()
{
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
}

int stop_asked_for() { return received; }

}  // namespace seldinger::apps
