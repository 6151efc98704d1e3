#pragma once
// What a run's forces do while it goes: falls, strikes, releases.
//
// A tip that hangs on a crease, or a contact that sticks, is held while the hand's force climbs, and let go at a threshold whose
// time differs between any two runs. A window taken again from one state releases where the run did. A time that is uncertain by
// release_time leaves the largest force uncertain by what it has risen in that time. Calibrated: on a stiff wire in a patient's
// arch the same catch releases up to 0.03 s later at 1/8 of the step, and the friction there is 0.997 of this bound.

#include "math/span_means.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace seldinger {

class MeanSquare {
public:
    void add(double value) { sum_ += value * value, ++count_; }
    [[nodiscard]] double root() const { return count_ > 0 ? std::sqrt(sum_ / static_cast<double>(count_)) : 0; }

private:
    double sum_ = 0;
    long count_ = 0;
};

/// How much a force falls in all, as means over a time, against its largest.
class FallSum {
public:
    explicit FallSum(double mean_time) : mean_(mean_time) {}
    void add(double value, double dt)
    {
        mean_.add(value, dt);
        if (!mean_.full()) return;
        const double now = mean_.mean();
        fallen_ += std::max(0.0, last_ - now);
        last_ = now;
        most_ = std::max(most_, now);
    }
    /// 1 for falls of the largest value or more.
    [[nodiscard]] double share() const { return most_ > 0 ? std::min(1.0, fallen_ / most_) : 1; }

private:
    SpanMeans mean_;
    double last_ = 0, most_ = 0, fallen_ = 0;
};

/// The largest fall of a force of single steps within a time. A strike rises and falls within one; a force that only rises has
/// none.
class LargestFall {
public:
    explicit LargestFall(double time) : span_(time) {}
    void add(double value, double dt)
    {
        time_ += dt;
        while (!tops_.empty() && tops_.back().second <= value) tops_.pop_back();
        tops_.emplace_back(time_, value);
        while (tops_.front().first < time_ - (1 + 1e-9) * span_) tops_.pop_front();
        most_ = std::max(most_, tops_.front().second - value);
    }
    [[nodiscard]] double largest() const { return most_; }

private:
    double span_, time_ = 0, most_ = 0;
    std::deque<std::pair<double, double>> tops_;  // time and value of those that no later one exceeds
};

/// Whether the largest force of a run is a sudden release, and how uncertain its time leaves it.
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
