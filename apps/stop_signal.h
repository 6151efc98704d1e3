#pragma once
// SIGINT and SIGTERM as a flag that the loop looks at between steps. A second one ends the process at once.

#include <csignal>

namespace seldinger::apps {

/// Listens while it lives; the old handlers return afterwards.
class StopSignal {
public:
    StopSignal();
    ~StopSignal();
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;

private:
    struct sigaction old_int_ {
    }, old_term_{};
    sigset_t old_mask_{};
};

/// SIGINT, SIGTERM, or 0 when none has come.
[[nodiscard]] int stop_asked_for();

}  // namespace seldinger::apps
