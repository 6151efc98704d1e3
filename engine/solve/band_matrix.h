#pragma once
// Banded Newton matrix of one wire: unknowns node by node (x, y, z, theta), half bandwidth 10, 4 unknowns a node.
// Factorised in O(n), in place of a general sparse solver; nothing is allocated after construction.

#include <span>
#include <vector>

namespace seldinger {

class BandMatrix {
public:
    static constexpr int half_bandwidth = 10;
    static constexpr int row_width = 2 * half_bandwidth + 1;
    static constexpr int stride = 24;  // doubles per row, a multiple of the SIMD width

    explicit BandMatrix(int max_size = 0);
    void reset(int size);  // size = 4 n unknowns; zero entries
    [[nodiscard]] int size() const { return size_; }

    /// A(i, j) += value; |i - j| <= half_bandwidth. Assembly fills both halves, also when symmetric.
    void add(int i, int j, double value) { rows_[i * stride + (j - i) + half_bandwidth] += value; }
    [[nodiscard]] double at(int i, int j) const { return rows_[i * stride + (j - i) + half_bandwidth]; }
    /// Row i, entry for column i at offset half_bandwidth.
    [[nodiscard]] double* row(int i) { return rows_.data() + i * stride; }
    [[nodiscard]] const double* row(int i) const { return rows_.data() + i * stride; }

    /// Makes unknown i prescribed: row and column zero, unit diagonal.
    void fix(int i);
    /// y = A x
    void multiply(std::span<const double> x, std::span<double> y) const;

    /// LDL^T of the lower half, into its own storage (the matrix stays as assembled). A pivot below `floor` times the
    /// row's diagonal scale is raised to it, so that the result is always positive definite. @return pivots raised
    int factor_ldlt();
    void solve_ldlt(std::span<double> rhs_to_x) const;
    /// LU with the full, unsymmetric matrix, row-scaled, without pivoting (diagonally strong by inertia or stiffness).
    /// @return false when a pivot vanishes; the caller falls back to factor_ldlt
    [[nodiscard]] bool factor_lu();
    void solve_lu(std::span<double> rhs_to_x) const;

private:
    int size_ = 0;
    std::vector<double> rows_, factor_, scratch_;
};

}  // namespace seldinger
