#pragma once
// The largest mean of a given number of consecutive values.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace seldinger {

class RunningPeak {
public:
    explicit RunningPeak(std::size_t wide = 1) : last_(std::max<std::size_t>(wide, 1), 0.0) {}

    void add(double value)
    {
        double& oldest = last_[count_ % last_.size()];
        sum_ += value - oldest;
        oldest = value;
        if (++count_ == last_.size()) most_ = mean();
        else if (count_ > last_.size()) most_ = std::max(most_, mean());
    }
    /// With fewer values than a mean takes: the mean of all; 0 without any.
    [[nodiscard]] double value() const { return count_ == 0 ? 0 : count_ < last_.size() ? sum_ / static_cast<double>(count_) : most_; }

    /// As many values as a mean takes have been added.
    [[nodiscard]] bool full() const { return count_ >= last_.size(); }
    /// Mean of the last values, once full.
    [[nodiscard]] double mean() const { return sum_ / static_cast<double>(last_.size()); }

private:
    std::vector<double> last_;  // a ring
    std::size_t count_ = 0;
    double sum_ = 0, most_ = 0;
};

}  // namespace seldinger
