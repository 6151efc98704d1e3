#pragma once
// Small dense matrices of any size, and their LU. Eigen's own of run-time size are no good in the library: how they
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
    /// With the transposed matrix: faster than with the matrix for many unknowns, since rows are read in order.
    void solve_transposed(std::span<double> rhs_to_x) const;

private:
    void exchange(int k);

    SmallMatrix lu_;
    std::vector<int> row_;  // exchanged with row k at step k
};

}  // namespace seldinger
