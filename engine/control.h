#pragma once
// What is asked of the instruments in one step: how far the hub of each is pushed in, and how far it is turned. Key frames
// (scene/key_frames.h), a hand or a policy give it; the engine does not know which.

#include "solve/solve_spec.h"

#include <span>
#include <vector>

namespace seldinger {

class Control {
public:
    /// Nothing is asked: every hub stays where it is.
    Control() = default;

    /// At the end of the step the hub of `instrument` (an index of WorldSetup::wires, one that is fed) has `advance` metres of wire
    /// pushed in and is turned by `turn` [rad], right-handed about the direction of insertion. It goes there steadily.
    /// @throws Error BadScene: a negative index
    Control& move_to(int instrument, double advance, double turn);

    /// The hub follows a way that is known beforehand: keys of increasing times of the world [s], between which it goes steadily;
    /// before the first and after the last it stays. What lies beyond the step tells the engine what comes next.
    /// @param keys  must outlive the step. @throws Error BadScene: a negative index, no keys
    Control& follow(int instrument, std::span<const FeedKey> keys);

    /// Takes back what was asked.
    void clear() { hubs_.clear(); }

    /// Of one hub.
    struct Hub {
        enum class Kind { Stay, MoveTo, Follow } kind = Kind::Stay;
        double advance = 0, turn = 0;   // MoveTo
        std::span<const FeedKey> keys;  // Follow
    };
    /// From instrument 0 on, up to the last that something was asked of.
    [[nodiscard]] std::span<const Hub> hubs() const { return hubs_; }

private:
    Hub& hub(int instrument);
    std::vector<Hub> hubs_;
};

}  // namespace seldinger
