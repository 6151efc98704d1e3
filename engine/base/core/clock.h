#pragma once
// Time that passes, by a clock that nobody sets.

#include <chrono>

namespace seldinger {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double in_seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }
[[nodiscard]] inline double seconds_since(Clock::time_point start) { return in_seconds(Clock::now() - start); }
[[nodiscard]] inline double seconds_of_the_clock() { return in_seconds(Clock::now().time_since_epoch()); }

}  // namespace seldinger
