// LU of small dense matrices [Golub13, sec. 3.4].
#include "math/small_dense.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

void SmallLu::factor(const SmallMatrix& matrix)
{
    // four pivots at a time: the rest of the matrix is read and written once for all four
    constexpr int wide = 4;
    lu_ = matrix;
    const int n = lu_.size();
    row_.assign(n, 0);
    for (int first = 0; first < n; first += wide) {
        const int last = std::min(n, first + wide);
        for (int k = first; k < last; ++k) {
            exchange(k);
            for (int i = k + 1; i < n; ++i) {
                const double multiplier = lu_(i, k) /= lu_(k, k);
                for (int j = k + 1; j < last; ++j) lu_(i, j) -= multiplier * lu_(k, j);
            }
        }
        if (last == n) break;
        for (int k = first; k < last; ++k)
            for (int above = first; above < k; ++above) {
                const double multiplier = lu_(k, above);
                for (int j = last; j < n; ++j) lu_(k, j) -= multiplier * lu_(above, j);
            }
        const double *a = &lu_(first, 0), *b = a + n, *c = b + n, *d = c + n;
        for (int i = last; i < n; ++i) {
            double* const to = &lu_(i, 0);
            const double by_a = to[first], by_b = to[first + 1], by_c = to[first + 2], by_d = to[first + 3];
            for (int j = last; j < n; ++j) to[j] = (((to[j] - by_a * a[j]) - by_b * b[j]) - by_c * c[j]) - by_d * d[j];
        }
    }
}

/// The row with the largest entry in column k becomes row k.
void SmallLu::exchange(int k)
{
    const int n = lu_.size();
    int best = k;
    for (int i = k + 1; i < n; ++i)
        if (std::abs(lu_(i, k)) > std::abs(lu_(best, k))) best = i;
    row_[k] = best;
    for (int j = 0; j < n && best != k; ++j) std::swap(lu_(k, j), lu_(best, j));
}

void SmallLu::solve_transposed(std::span<double> x) const
{
    const int n = lu_.size();
    for (int i = 0; i < n; ++i) {
        const double own = x[i] /= lu_(i, i);
        for (int j = i + 1; j < n; ++j) x[j] -= lu_(i, j) * own;
    }
    for (int i = n - 1; i >= 0; --i) {
        const double own = x[i];
        for (int j = 0; j < i; ++j) x[j] -= lu_(i, j) * own;
    }
    for (int k = n - 1; k >= 0; --k) std::swap(x[k], x[row_[k]]);
}

}  // namespace seldinger
