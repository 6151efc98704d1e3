#pragma once
// A few sparse rows, filled one after the other and then only read: couplings of two sets of unknowns.

#include <cstddef>
#include <span>
#include <vector>

namespace seldinger {

class SparseRows {
public:
    struct Entry {
        int unknown;
        double value;
    };

    void clear()
    {
        entries_.clear();
        ends_.clear();
    }
    /// The next row, empty.
    void begin_row() { ends_.push_back(entries_.size()); }
    /// To the last row.
    void add(int unknown, double value)
    {
        entries_.push_back({unknown, value});
        ++ends_.back();
    }
    [[nodiscard]] std::size_t count() const { return ends_.size(); }
    [[nodiscard]] std::span<const Entry> row(std::size_t k) const
    {
        const std::size_t from = k == 0 ? 0 : ends_[k - 1];
        return {entries_.data() + from, ends_[k] - from};
    }
    [[nodiscard]] std::span<Entry> entries() { return entries_; }

    /// out_k = row k times x, [rows]
    void times(std::span<const double> x, std::span<double> out) const
    {
        const Entry* entry = entries_.data();
        for (std::size_t k = 0; k < ends_.size(); ++k) {
            double sum = 0;
            for (const Entry* const end = entries_.data() + ends_[k]; entry != end; ++entry)
                sum += entry->value * x[entry->unknown];
            out[k] = sum;
        }
    }
    /// y += rows^T v
    void add_transposed(std::span<const double> v, std::span<double> y) const
    {
        const Entry* entry = entries_.data();
        for (std::size_t k = 0; k < ends_.size(); ++k)
            for (const Entry* const end = entries_.data() + ends_[k]; entry != end; ++entry)
                y[entry->unknown] += entry->value * v[k];
    }

private:
    std::vector<Entry> entries_;
    std::vector<std::size_t> ends_;  // [rows]
};

}  // namespace seldinger
