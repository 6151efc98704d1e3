#pragma once
// SIGINT and SIGTERM: a flag that a loop looks at between steps, and the end of the process where nobody looks.
//
// Both are blocked in every thread and taken by a separate one, which waits for them. So handlers that a compiler inside an
// OpenCL driver sets never run, and nothing has to be safe inside a handler. While a StopSignal lives, the first signal is a
// request. The process ends at once in four cases. First, at a second signal. Second, while a kernel is built or a NoPolling
// lives: vessel repair and batch planning take seconds without a check, and write nothing. Third, if no loop has polled for eight
// seconds, as when a driver compiles while a kernel first runs. Fourth, if no StopSignal lives and none has answered.

#include <csignal>
#include <string_view>

namespace seldinger::apps {

/// Keeps both signals off the calling thread and those that it starts, and starts the one that waits for them. First of all.
void watch_signals();

/// To stderr, also while a compiler is kept from it. Allocates nothing.
void say_at_once(std::string_view text);

/// A loop that asks stop_asked_for() continues while this lives.
class StopSignal {
public:
    /// @param advice  how to go on where the process has to end at once; a literal
    explicit StopSignal(const char* advice = "run again with --resume");
    ~StopSignal();
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;
};

/// A part of it that cannot ask.
class NoPolling {
public:
    NoPolling();
    ~NoPolling();
    NoPolling(const NoPolling&) = delete;
    NoPolling& operator=(const NoPolling&) = delete;
};

/// SIGINT, SIGTERM, or 0 when none has come.
[[nodiscard]] int stop_asked_for();

}  // namespace seldinger::apps
