#pragma once
// Banded Newton matrix of a system of rods: unknowns node by node (x, y, z, theta; math/dof_map.h), half bandwidth 10.
// Factorised in O(n) by 4x4 blocks, in place of a general sparse solver; nothing is allocated after construction.
//
// The pattern is that of D1-D3 and of contact. The unknowns of nodes a and b couple only when |a - b| <= 2, and then only
// within the half bandwidth (x_a never meets theta_{a+2}, 11 apart).

#include "math/dof_map.h"

#include <cstdlib>
#include <span>
#include <vector>

namespace seldinger {

/// Entries of a banded matrix row by row, or of a part of it: one instrument's in the matrix of its system. Does not own them.
class BandRows {
public:
    static constexpr int half_bandwidth = RodDofs::half_bandwidth;
    static constexpr int row_width = 2 * half_bandwidth + 1;
    static constexpr int stride = 24;  // doubles per row, a multiple of the SIMD width; those past row_width stay zero
    static constexpr int node_size = RodDofs::per_node;  // unknowns of a node, the block of the factorisation

    [[nodiscard]] int size() const { return size_; }
    /// A(i, j) += value; |i - j| <= half_bandwidth, nodes at most two apart. Assembly fills both halves, also when symmetric.
    void add(int i, int j, double value)
    {
        SEL_VALIDATE(std::abs(i - j) <= half_bandwidth && std::abs(RodDofs::node(i) - RodDofs::node(j)) <= RodDofs::reach);
        rows_[i * stride + (j - i) + half_bandwidth] += value;
    }
    [[nodiscard]] double at(int i, int j) const { return rows_[i * stride + (j - i) + half_bandwidth]; }
    /// Row i, entry for column i at offset half_bandwidth.
    [[nodiscard]] double* row(int i) { return rows_ + i * stride; }
    [[nodiscard]] const double* row(int i) const { return rows_ + i * stride; }
    /// Rows and columns first, first + 1, ..., first + size - 1.
    [[nodiscard]] BandRows part(int first, int size) const { return {rows_ + first * stride, size}; }

    /// Makes unknown i prescribed: row and column zero, unit diagonal.
    void fix(int i);
    void scale(double factor);
    /// A += factor * other, of the same size.
    void add_scaled(const BandRows& other, double factor);
    /// y = A x
    void multiply(std::span<const double> x, std::span<double> y) const;
    /// y += x_j times column j
    void add_column(int j, double x_j, std::span<double> y) const;

protected:
    BandRows() = default;
    BandRows(double* rows, int size) : rows_(rows), size_(size) {}
    double* rows_ = nullptr;
    int size_ = 0;
};

/// The matrix with its memory and its factors.
class BandMatrix : public BandRows {
private:
    // Factors of one node's rows: columns of this node and of the next two, and (LU) the multipliers of the next two nodes'
    // rows, transposed. In the LU upper[p][0..p-1] holds the multipliers inside the block.
    struct alignas(32) NodeFactor {
        double upper[4][12];
        double lower[4][8];
        double inverse_pivot[4];
        double inverse_diagonal[4];  // 1 / |a_kk| of the matrix itself
    };

public:
    /// Memory for entries and factors. A matrix makes its own where it first needs some: many work in another's only.
    struct Storage {
        explicit Storage(int max_size = 0);
        std::vector<double> rows;
        std::vector<NodeFactor> factor;  // two more than nodes, so that the last ones need no special case
    };

    explicit BandMatrix(int max_size = 0);
    BandMatrix(BandMatrix&&) = default;
    BandMatrix& operator=(BandMatrix&&) = default;
    /// From now on entries (factors) are in that memory, which is as large as its own; null: in its own. Nothing is copied. A
    /// thread that assembles one small matrix after the other in the same place finds it in its cache.
    void use_rows(Storage* storage) { rows_ = (storage ? *storage : own_).rows.data(); }
    void use_factor(Storage* storage) { factor_ = (storage ? *storage : own_).factor.data(); }
    void reset(int size);  // size = 4 n unknowns, <= max_size; zero entries
    /// Whether every node's fourth unknown takes part in factors and solutions (default). If not it is 0 in any solution, and
    /// what the matrix and the right side have there is of no account: three quarters of the pivots, and of the work at each.
    void set_fourth(bool takes_part) { fourth_ = takes_part; }

    /// LDL^T of the symmetric matrix (reads the upper half), into its own storage: the matrix stays as assembled. A pivot is
    /// raised, at least to a_kk, if no positive definite matrix could have it. It is then below pivot_floor times its diagonal
    /// a_kk, or below c_kj^2 / a_jj for some entry c_kj of the reduced row. The result is always positive definite, its entries
    /// stay bounded, and the step along one raised pivot is as small as the diagonal alone would make it. [Gill81, sec. 4.4.2.2]
    /// with the bound taken per entry, so that it does not depend on units. Several of them behind each other may leave tiny
    /// pivots between them and directions of 1e59 m: no use, and nothing here says so. @return pivots raised
    int factor_ldlt() { return fourth_ ? factor_ldlt_of<4>() : factor_ldlt_of<3>(); }
    void solve_ldlt(std::span<double> rhs_to_x) { fourth_ ? solve_ldlt_of<4>(rhs_to_x) : solve_ldlt_of<3>(rhs_to_x); }
    /// LU with the full, unsymmetric matrix without pivoting (diagonally strong by inertia or stiffness). Takes the place
    /// of an LDL^T. @return false when a pivot vanishes against its row's scale; the caller falls back to factor_ldlt
    [[nodiscard]] bool factor_lu() { return fourth_ ? factor_lu_of<4>() : factor_lu_of<3>(); }
    /// Negative pivots of the last factor_lu(): none when the symmetric part is positive definite.
    [[nodiscard]] int negative_pivots() const { return negative_pivots_; }
    void solve_lu(std::span<double> rhs_to_x) { fourth_ ? solve_lu_of<4>(rhs_to_x) : solve_lu_of<3>(rhs_to_x); }

    /// Rounding leaves a pivot that should be 0 at about 1e-15 of its diagonal. The weakest real one is about 1e-11 of it (the
    /// inertia of a stiff fine wire at a long step, m/h^2 against EA/l).
    static constexpr double pivot_floor = 1e-14;

private:
    // `active`: unknowns of a node that take part. Blocks stay four wide: with three, the fourth lane carries numbers that reach
    // no other lane, since its pivots' inverses are 0.
    template <int active>
    int factor_ldlt_of();
    template <int active>
    void solve_ldlt_of(std::span<double> rhs_to_x);
    template <int active>
    bool factor_lu_of();
    template <int active>
    void solve_lu_of(std::span<double> rhs_to_x);
    void load_upper();
    void load_lower();
    [[nodiscard]] double row_scale(int i) const;  // largest magnitude in row i; 1 when all are zero

    int max_size_ = 0;
    int negative_pivots_ = 0;
    bool fourth_ = true;
    Storage own_;
    NodeFactor* factor_ = nullptr;
    std::vector<double> scratch_;
};

}  // namespace seldinger
