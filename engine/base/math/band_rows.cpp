// Row operations on the entries of a banded matrix.
#include "math/band_matrix.h"

#include <algorithm>

namespace seldinger {

void BandRows::fix(int i)
{
    std::fill_n(row(i), row_width, 0.0);
    const int first = std::max(0, i - half_bandwidth), last = std::min(size_ - 1, i + half_bandwidth);
    for (int j = first; j <= last; ++j) row(j)[i - j + half_bandwidth] = 0.0;
    row(i)[half_bandwidth] = 1.0;
}

void BandRows::scale(double factor)
{
    for (int k = 0; k < size_ * stride; ++k) rows_[k] *= factor;
}

void BandRows::add_scaled(const BandRows& other, double factor)
{
    SEL_ASSERT(other.size() == size_);
    const double* entries = other.row(0);
    for (int k = 0; k < size_ * stride; ++k) rows_[k] += factor * entries[k];
}

void BandRows::multiply(std::span<const double> x, std::span<double> y) const
{
    constexpr int abreast = node_size;  // rows whose sums, each in order, do not wait for each other
    for (int i = 0; i < size_; i += abreast) {
        double sums[abreast] = {};
        const int first = i - half_bandwidth, last = i + half_bandwidth;
        if (first >= 0 && last + abreast <= size_) {
            for (int k = 0; k < row_width; ++k)
                for (int l = 0; l < abreast; ++l) sums[l] += row(i + l)[k] * x[first + l + k];
        } else {
            for (int l = 0; l < abreast; ++l)
                for (int j = std::max(0, first + l); j <= std::min(size_ - 1, last + l); ++j) sums[l] += at(i + l, j) * x[j];
        }
        std::copy_n(sums, abreast, y.begin() + i);
    }
}

void BandRows::add_column(int j, double x_j, std::span<double> y) const
{
    const int first = std::max(0, j - half_bandwidth), last = std::min(size_ - 1, j + half_bandwidth);
    for (int i = first; i <= last; ++i) y[i] += at(i, j) * x_j;
}

}  // namespace seldinger
