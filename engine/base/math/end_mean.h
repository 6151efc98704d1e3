#pragma once
// Means of hand force and friction over the last 20 ms: comparable between runs with different steps.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace seldinger {

/// Plain bytes, so that a checkpoint carries it. Steps shorter than a slot's time share a slot.
struct EndMean {
    static constexpr double span = 0.02;        // [s]
    static constexpr double slot_time = 2e-4;   // [s]
    static constexpr std::int64_t slots = 128;  // more than span / slot_time
    struct Mean {
        double hand = 0, friction = 0;  // [N]
        double seconds = 0;             // that they span; 0: no step was added
    };

    void add(double hand_force, double friction_force, double dt)
    {
        if (time[last] >= (1 - 1e-9) * slot_time) {
            last = (last + 1) % slots;
            time[last] = hand[last] = friction[last] = 0;
        }
        time[last] += dt;
        hand[last] += hand_force * dt;
        friction[last] += friction_force * dt;
    }
    /// Over `span` up to the end, of the oldest slot the part that it takes; over all where that is shorter.
    [[nodiscard]] Mean mean() const
    {
        Mean sum;
        for (std::int64_t back = 0; back < slots; ++back) {
            const std::int64_t k = (last + slots - back) % slots;
            const double left = span - sum.seconds;
            if (time[k] == 0 || left <= 1e-9 * span) break;
            const double part = std::min(1.0, left / time[k]);
            sum.hand += part * hand[k], sum.friction += part * friction[k], sum.seconds += part * time[k];
        }
        if (sum.seconds > 0) sum.hand /= sum.seconds, sum.friction /= sum.seconds;
        return sum;
    }
    /// Whether bytes from a file can be one.
    [[nodiscard]] bool is_sound() const
    {
        if (last < 0 || last >= slots) return false;
        bool ended = false;  // from the last slot back, used ones come first, and the others hold nothing
        for (std::int64_t back = 0; back < slots; ++back) {
            const std::int64_t k = (last + slots - back) % slots;
            ended = ended || time[k] == 0;
            const bool is_used = time[k] > 0 && time[k] < 1e12 && std::isfinite(hand[k]) && std::isfinite(friction[k]);
            if (ended ? time[k] != 0 || hand[k] != 0 || friction[k] != 0 : !is_used) return false;
        }
        return true;
    }

    double time[slots] = {}, hand[slots] = {}, friction[slots] = {};  // of a slot: its time [s], force times time [N s]
    std::int64_t last = 0;                                            // the slot of the last step
};

}  // namespace seldinger
