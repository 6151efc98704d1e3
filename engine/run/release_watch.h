#pragma once
// Detects whether the largest force of a run is a sudden release.
//
// A tip that hangs on a crease, or a contact that sticks, is held while the hand's force climbs, and let go at a threshold. Its
// time differs between any two runs, also with the length of the step. A window computed again from one state at half the step
// releases where the run did. A time of release that is uncertain by dt_release leaves the largest force F uncertain by
//
//     dF = (dF/dt before the release) x dt_release,    dt_release = 0.1 s
//
// read off the run: by how much F has risen in the 0.1 s before it. Calibrated, not derived: on a stiff wire in a patient's arch
// the same catch releases up to 0.03 s later at 1/8 of the step, and the friction there is 0.997 of this bound.
// A force that does not fall by more than 20 % within 20 ms after its largest is no release, and the bound is 0. The catch above
// falls by 22 to 26 % at steps of 1 to 17 ms. A tip that lands on a tube's floor and settles falls by 15 %.

#include "math/running_peak.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace seldinger {

class ReleaseWatch {
public:
    static constexpr double release_time = 0.1;  // [s]
    static constexpr double fall_time = 0.02;    // [s]
    static constexpr double least_fall = 0.2;    // of the largest value

    /// @param mean_time  that the largest value is a mean over [s]
    ReleaseWatch(double dt, double mean_time) : mean_(steps_in(mean_time, dt)), before_(steps_in(release_time, dt)), fall_steps_(steps_in(fall_time, dt)) {}

    /// @param value  of one step, not negative
    void add(double value)
    {
        mean_.add(value);
        if (!mean_.full()) return;
        const double now = mean_.mean();
        if (now > peak_) {
            peak_ = now;
            rise_ = count_ == 0 ? 0 : now - *std::min_element(before_.begin(), before_.begin() + filled());
            fall_ = 0;
            since_ = 0;
        } else if (since_++ < fall_steps_) {
            fall_ = std::max(fall_, peak_ - now);
        }
        before_[count_++ % before_.size()] = now;
    }

    /// The bound dF of the largest mean, 0 where nothing lets go.
    [[nodiscard]] double bound() const { return fall_ > least_fall * peak_ ? std::max(rise_, 0.0) : 0; }

private:
    static std::size_t steps_in(double time, double dt) { return static_cast<std::size_t>(std::max(1L, std::lround(time / dt))); }
    [[nodiscard]] std::ptrdiff_t filled() const { return static_cast<std::ptrdiff_t>(std::min(count_, before_.size())); }

    RunningPeak mean_;
    std::vector<double> before_;  // a ring of means
    std::size_t fall_steps_;
    std::size_t count_ = 0, since_ = 0;
    double peak_ = 0, rise_ = 0, fall_ = 0;
};

}  // namespace seldinger
