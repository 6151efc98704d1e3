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

#include "math/span_means.h"

#include <algorithm>
#include <deque>
#include <utility>

namespace seldinger {

class ReleaseWatch {
public:
    static constexpr double release_time = 0.1;  // [s]
    static constexpr double fall_time = 0.02;    // [s]
    static constexpr double least_fall = 0.2;    // of the largest value

    /// @param mean_time  that the largest value is a mean over [s]
    explicit ReleaseWatch(double mean_time) : mean_(mean_time) {}

    /// @param value  of one step, not negative   @param dt  that it lasts [s]
    void add(double value, double dt)
    {
        mean_.add(value, dt);
        time_ += dt;
        if (!mean_.full()) return;
        const double now = mean_.mean();
        while (!before_.empty() && before_.front().first < time_ - (1 + 1e-9) * release_time) before_.pop_front();
        if (now > peak_) {
            const auto lowest = std::ranges::min_element(before_, {}, &std::pair<double, double>::second);
            rise_ = lowest == before_.end() ? 0 : now - lowest->second;
            peak_ = now;
            peak_time_ = time_;
            fall_ = 0;
        } else if (time_ <= peak_time_ + (1 + 1e-9) * fall_time) {
            fall_ = std::max(fall_, peak_ - now);
        }
        before_.emplace_back(time_, now);
    }

    /// The bound dF of the largest mean, 0 where nothing lets go.
    [[nodiscard]] double bound() const { return fall_ > least_fall * peak_ ? std::max(rise_, 0.0) : 0; }

private:
    SpanMeans mean_;
    std::deque<std::pair<double, double>> before_;  // time [s] and mean of each step within release_time
    double time_ = 0, peak_ = 0, peak_time_ = 0, rise_ = 0, fall_ = 0;
};

}  // namespace seldinger
