#pragma once
// When the next step is due, and whether the last one was late. It has no clock: the caller passes the time, so that a test can
// choose it.
//
// Step k begins at its due time d and is to be over by d + T. A step that ends later is late: session time stretches by the
// delay, and the next one is due at once. Later steps never run faster to catch up, because the hand would feel a wire that runs.

#include <algorithm>
#include <cstdint>

namespace seldinger {

class Pacer {
public:
    /// @param period  T [s]
    explicit Pacer(double period) : period_(period) {}

    void start(double now) { due_ = begun_ = now; }
    /// When the next step is to begin [s].
    [[nodiscard]] double due() const { return due_; }
    /// When it did begin [s]; left out: when it was due.
    void begin(double now) { begun_ = now; }
    /// A step is over. @return whether it was late
    bool finished(double now)
    {
        const double deadline = due_ + period_, took = now - begun_;
        ++steps_;
        due_ = begun_ = std::max(now, deadline);
        if (now <= deadline) return false;
        ++late_;
        if (took <= period_) ++woken_late_;
        stretched_ += now - deadline;
        return true;
    }
    /// No step was taken (paused).
    void rest(double now) { due_ = begun_ = now + period_; }

    [[nodiscard]] std::uint64_t steps() const { return steps_; }
    [[nodiscard]] std::uint64_t late() const { return late_; }
    /// Late steps that took no longer than a period: the machine woke the session too late.
    [[nodiscard]] std::uint64_t woken_late() const { return woken_late_; }
    /// By how much the session has taken longer than its own time says, pauses left out [s].
    [[nodiscard]] double stretched() const { return stretched_; }

private:
    double period_, due_ = 0, begun_ = 0, stretched_ = 0;
    std::uint64_t steps_ = 0, late_ = 0, woken_late_ = 0;
};

}  // namespace seldinger
