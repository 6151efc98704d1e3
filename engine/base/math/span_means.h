#pragma once
// Means of a force over an exact span of time, whatever the steps last: all 20 ms means of a run but those at its end
// (math/end_mean.h, which a checkpoint carries).

#include <algorithm>
#include <cstddef>
#include <deque>

namespace seldinger {

/// A value that holds for a step is constant within it. A mean begins or ends with a step and takes a part of the step at its
/// other end, so that runs with any steps have means over the same time.
class SpanMeans {
public:
    explicit SpanMeans(double span) : span_(span) {}

    /// @param dt  that the value holds for [s]
    void add(double value, double dt)
    {
        sum_ += value * dt;
        time_ += dt;
        ends_.push_back({time_, sum_, value});
        const double begin = time_ - span_;  // of the mean that ends here
        for (; next_ < ends_.size() && ends_[next_].time <= begin + tiny(); ++next_)
            take(sum_ - value * (begin - ends_[next_].time) - ends_[next_].sum);  // begins with a step and ends within this one
        for (; next_ > 1; --next_) ends_.pop_front();
        if (full()) take(sum_since(begin));
    }

    /// As much time has been added as a mean takes.
    [[nodiscard]] bool full() const { return time_ >= span_ - tiny(); }
    /// Over the last span; over all where that is shorter, 0 without any.
    [[nodiscard]] double mean() const { return full() ? sum_since(time_ - span_) / span_ : time_ > 0 ? sum_ / time_ : 0; }
    /// Of the means that begin or end with a step; mean() where no mean is full.
    [[nodiscard]] double largest() const { return full() ? most_ / span_ : mean(); }

private:
    struct End {  // of a step
        double time, sum, value;  // since the first one [s], [force s]; during it
    };
    [[nodiscard]] double tiny() const { return 1e-9 * span_; }  // times are sums of steps
    /// @param begin  within the step after the first one kept, or at its beginning
    [[nodiscard]] double sum_since(double begin) const
    {
        const End &before = ends_[0], &after = ends_[1];
        return sum_ - before.sum - after.value * std::max(0.0, begin - before.time);
    }
    void take(double sum)
    {
        most_ = any_ ? std::max(most_, sum) : sum;
        any_ = true;
    }

    double span_;
    std::deque<End> ends_{End{0, 0, 0}};  // the last at or before the beginning of the mean that ends now, and all after it
    std::size_t next_ = 0;                // of these, the first whose mean has not ended
    double time_ = 0, sum_ = 0, most_ = 0;
    bool any_ = false;
};

}  // namespace seldinger
