#pragma once
// Eigenvalues of small symmetric matrices by Jacobi's rotations [Golub13, sec. 8.5], and their positive part. Nothing is
// allocated.

#include <array>
#include <cmath>

namespace seldinger {

template <int n>
class FixedMatrix {
public:
    [[nodiscard]] static constexpr int size() { return n; }
    [[nodiscard]] double& operator()(int i, int j) { return entries_[static_cast<std::size_t>(i) * n + j]; }
    [[nodiscard]] double operator()(int i, int j) const { return entries_[static_cast<std::size_t>(i) * n + j]; }

private:
    std::array<double, static_cast<std::size_t>(n) * n> entries_{};
};

/// Rotates rows and columns p and q of `a` so that a(p, q) becomes 0.
template <class Matrix>
void rotate(Matrix& a, Matrix& vectors, int p, int q)
{
    if (a(p, q) == 0) return;
    const double cot = (a(q, q) - a(p, p)) / (2 * a(p, q));
    const double t = (cot >= 0 ? 1 : -1) / (std::abs(cot) + std::sqrt(1 + cot * cot));
    const double c = 1 / std::sqrt(1 + t * t), s = t * c;
    for (int k = 0; k < a.size(); ++k) {
        const double kp = a(k, p), kq = a(k, q);
        a(k, p) = c * kp - s * kq;
        a(k, q) = s * kp + c * kq;
    }
    for (int k = 0; k < a.size(); ++k) {
        const double pk = a(p, k), qk = a(q, k), vp = vectors(k, p), vq = vectors(k, q);
        a(p, k) = c * pk - s * qk;
        a(q, k) = s * pk + c * qk;
        vectors(k, p) = c * vp - s * vq;
        vectors(k, q) = s * vp + c * vq;
    }
}

/// Eigenvalues of a symmetric matrix onto its diagonal. @param vectors  zero; column k becomes that of a(k, k)
template <class Matrix>
void diagonalise(Matrix& a, Matrix& vectors)
{
    constexpr int most_sweeps = 30;  // convergence is quadratic: 6 to 10 are the rule
    const int n = a.size();
    for (int k = 0; k < n; ++k) vectors(k, k) = 1;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        double off = 0, all = 0;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) (i == j ? all : off) += a(i, j) * a(i, j);
        if (!(off > 1e-30 * all)) break;
        for (int p = 0; p < n; ++p)
            for (int q = p + 1; q < n; ++q) rotate(a, vectors, p, q);
    }
}

/// A symmetric matrix without its negative eigenvalues: the nearest one that is positive semidefinite.
template <int n>
[[nodiscard]] FixedMatrix<n> positive_part(FixedMatrix<n> a)
{
    FixedMatrix<n> vectors, positive;
    diagonalise(a, vectors);
    for (int k = 0; k < n; ++k) {
        if (!(a(k, k) > 0)) continue;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) positive(i, j) += vectors(i, k) * a(k, k) * vectors(j, k);
    }
    return positive;
}

}  // namespace seldinger
