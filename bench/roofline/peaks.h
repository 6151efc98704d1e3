#pragma once
// What a device can do at most, measured: memory traffic, multiply-adds, and what a launch costs. The roofs of `seldinger bench`.

#include "device/device.h"

#include <functional>
#include <string>
#include <vector>

namespace seldinger::device {

/// One queue of a context. On PoCL's CPU pair `light` is one core, `heavy` all of them; elsewhere they are the same queue.
struct Peaks {
    std::string queue;                           // "light", "heavy"
    double bandwidth = 0;                        // triad from memory, bytes it must move: 3 per element [B/s]
    double cached_bandwidth = 0;                 // the same on arrays of 384 kB in all, less the launch [B/s]
    double flops_float = 0;                      // [1/s], a multiply-add is two; the best vector width
    double flops_double = 0;                     // 0 where the context has none
    int width_float = 0, width_double = 0;       // of the best
    double scalar_float = 0, scalar_double = 0;  // width 1
    double launch = 0;                           // one empty kernel, enqueued and waited for [s]
    double chained = 0;                          // of one more in a chain of 64 [s]
    double round_trip = 0;                       // write 4 kB, launch, read 4 kB [s]
};

/// Rates: the best of `repeats` timings of a few milliseconds each, since a roof is what nothing goes above; costs of launches:
/// medians.
/// @param mega_bytes  of memory that the triad walks through
[[nodiscard]] Peaks measure_peaks(Context& context, Queue queue, int repeats, int mega_bytes);

/// Median (rank 0.5; 0: the shortest) over `repeats` timings of call() [s], each of so many calls in a row that it lasts `least`
/// seconds; call() must wait for its own end.
[[nodiscard]] double median_time(const std::function<void()>& call, int repeats, double least, double rank = 0.5);

}  // namespace seldinger::device
