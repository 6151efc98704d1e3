#pragma once
// Wall-clock time of the commands' loops.

#include <chrono>

namespace seldinger::apps {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_since(Clock::time_point start)
{
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace seldinger::apps
