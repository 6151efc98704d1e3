#pragma once
// Small dense matrices of any size: LU, Cholesky, eigenvalues. Eigen's own of run-time size are no good in the library: how they
// are allocated depends on the processor that a file is compiled for, and a program may be compiled for another.

#include <span>
#include <vector>

namespace seldinger {

class SmallMatrix {
public:
    explicit SmallMatrix(int size = 0) : size_(size), entries_(static_cast<std::size_t>(size) * size) {}
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] double& operator()(int i, int j) { return entries_[static_cast<std::size_t>(i) * size_ + j]; }
    [[nodiscard]] double operator()(int i, int j) const { return entries_[static_cast<std::size_t>(i) * size_ + j]; }

private:
    int size_;
    std::vector<double> entries_;
};

/// LU with row pivoting.
class SmallLu {
public:
    void factor(const SmallMatrix& matrix);
    void solve(std::span<double> rhs_to_x) const;
    /// With the transposed matrix; the faster one of the two for many unknowns.
    void solve_transposed(std::span<double> rhs_to_x) const;
    /// Sign of the determinant: -1, 0, 1.
    [[nodiscard]] int sign() const { return sign_; }

private:
    void exchange(int k);

    SmallMatrix lu_;
    std::vector<int> row_;  // exchanged with row k at step k
    int sign_ = 1;
};

/// Eigenvalues of a symmetric matrix by Jacobi's rotations; column k of `vectors` belongs to values[k].
struct SmallModes {
    explicit SmallModes(SmallMatrix symmetric);
    std::vector<double> values;
    SmallMatrix vectors;
};

/// L with L L^T = `symmetric`, as far as it is positive: rows of pivots that are not are 0.
[[nodiscard]] SmallMatrix small_cholesky(const SmallMatrix& symmetric);

}  // namespace seldinger
