#pragma once
// Where a run of a scene begins and when it is over: one rule for the command, batches, Python and tests.

#include "scene/scene.h"

namespace seldinger {

/// Whether the run begins with a static equilibrium.
[[nodiscard]] inline bool settles_first(const Scene& scene) { return scene.start_settled || scene.integrator.scheme == Scheme::Static; }

class RunEnd {
public:
    RunEnd() = default;
    explicit RunEnd(const Scene& scene) : until_(scene.until), steps_(scene.steps()), moving_until_(prescribed_until(scene)) {}

    /// Whether it can be over before the scene's duration, so that is_over() has to be asked after each step.
    [[nodiscard]] bool is_watched() const { return until_ != Until::Time; }
    /// @param steps  taken   @param rest_steps  of those, the last ones in a row after which World::at_rest() held
    /// @param time  of the instruments [s]   @param reached  whether the tip has been at the target of [task]
    [[nodiscard]] bool is_over(long steps, long rest_steps, double time, bool reached) const
    {
        if (steps >= steps_ || (until_ == Until::Reached && reached)) return true;
        return until_ == Until::Rest && rest_steps >= steps_at_rest && time >= moving_until_;
    }

private:
    Until until_ = Until::Time;
    long steps_ = 0;
    double moving_until_ = 0;  // rest before that is a pause [s]
};

}  // namespace seldinger
