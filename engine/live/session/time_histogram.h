#pragma once
// Durations as quantiles over a whole session in constant memory: one thread adds, any reads.
// Bins of an octave's 32nd part: a quantile is right to 3 %.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>

namespace seldinger {

class TimeHistogram {
public:
    void add(double seconds)
    {
        auto& bin = bins_[bin_of(seconds)];
        bin.store(bin.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        if (seconds > worst_.load(std::memory_order_relaxed)) worst_.store(seconds, std::memory_order_relaxed);
    }
    [[nodiscard]] std::uint64_t count() const
    {
        std::uint64_t sum = 0;
        for (const auto& bin : bins_) sum += bin.load(std::memory_order_relaxed);
        return sum;
    }
    /// Time that a share of all did not exceed [s], to a bin's upper end; 0 without any.
    [[nodiscard]] double quantile(double share) const
    {
        const double wanted = share * static_cast<double>(count());
        double seen = 0;
        for (int k = 0; k < bin_count; ++k) {
            seen += static_cast<double>(bins_[static_cast<std::size_t>(k)].load(std::memory_order_relaxed));
            if (seen > 0 && seen >= wanted) return std::min(shortest * std::exp2((k + 1) / per_octave), worst());
        }
        return 0;
    }
    [[nodiscard]] double worst() const { return worst_.load(std::memory_order_relaxed); }

private:
    static constexpr double shortest = 1e-7, per_octave = 32;  // [s]
    static constexpr int bin_count = 32 * 30;                  // to 100 s
    static std::size_t bin_of(double seconds)
    {
        const double bin = per_octave * std::log2(std::max(seconds, shortest) / shortest);
        return static_cast<std::size_t>(std::min(bin, bin_count - 1.0));
    }
    std::array<std::atomic<std::uint64_t>, bin_count> bins_{};
    std::atomic<double> worst_{0};
};

}  // namespace seldinger
