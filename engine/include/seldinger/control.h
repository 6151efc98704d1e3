#pragma once
// Input of one step: the prescribed insertion and rotation of each instrument's hub at its end, and loads. It may come from key
// frames (setup/key_frames.h), a user's hand or a policy.

#include "solve/solve_spec.h"

#include <span>
#include <vector>

namespace seldinger {

class Control {
public:
    /// Nothing is prescribed: every hub stays where it is.
    Control() = default;

    /// Sets the end of the step for the hub of `instrument` (an index of WorldSetup::wires, one that is fed). `advance` metres of
    /// wire are then pushed in, and the hub is turned by `turn` [rad], right-handed about the direction of insertion. It goes
    /// there steadily.
    /// @throws Error BadScene: a negative index
    Control& move_to(int instrument, double advance, double turn);

    /// Pushes a hub that a force drives (HubSpec), and turns it. With `spring` the force is `force` where the hub is at the start
    /// of the step, and falls by that much per metre that it goes on: a spring to a hand, taken at the end of the step.
    /// @throws Error BadScene: a negative index
    Control& push(int instrument, double force, double turn, double spring = 0);

    /// The hub follows a path that is known beforehand: keys of increasing times of the world [s], between which it goes
    /// steadily; before the first and after the last it stays. Keys beyond the step let the engine look ahead. Of a hub that a
    /// force drives they are forces and turns.
    /// @param keys  must outlive the step. @throws Error BadScene: a negative index, no keys
    Control& follow(int instrument, std::span<const FeedKey> keys);

    /// A force [N] and a moment [N m] in world axes, constant through the step, on the instrument's point that is `at` metres
    /// from its tip along the unstressed wire. Loads add up. A point that is not inside yet feels nothing.
    /// @throws Error BadScene: a negative index, a number that is not finite
    Control& load(int instrument, double at, const Vec3& force, const Vec3& moment = Vec3::Zero());

    /// Removes everything prescribed.
    void clear()
    {
        hubs_.clear();
        loads_.clear();
    }

    /// Input of one hub.
    struct Hub {
        enum class Kind { Stay, MoveTo, Push, Follow } kind = Kind::Stay;
        double advance = 0, turn = 0;   // MoveTo; the latter of Push, too
        double force = 0, spring = 0;   // Push [N], [N/m]
        std::span<const FeedKey> keys;  // Follow
    };
    /// From instrument 0 up to the last for which something is prescribed.
    [[nodiscard]] std::span<const Hub> hubs() const { return hubs_; }
    struct Load {
        int instrument;
        LoadSpec spec;
    };
    [[nodiscard]] std::span<const Load> loads() const { return loads_; }

private:
    Hub& hub(int instrument);
    std::vector<Hub> hubs_;
    std::vector<Load> loads_;
};

}  // namespace seldinger
