#pragma once
// Cholesky factor of a sparse symmetric positive definite matrix of 3 x 3 blocks, in dense panels (supernodes), for many solves.

#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// P A P^T = L L^T. Order: nested dissection of the graph of blocks. The bits of a solution depend on the matrix alone.
class BlockCholesky {
public:
    /// @param matrix  [3B][3B], both triangles stored
    /// @param skip    [B] 1: rows and columns of this block are left out, solutions are 0 there; may be empty
    /// @return false when the matrix is not positive definite
    [[nodiscard]] bool factor(const Eigen::SparseMatrix<double>& matrix, std::span<const unsigned char> skip = {});

    /// x = A^-1 x in place for `count` right-hand sides. @param x  [count] pointers to [3B]  @param work  scratch
    void solve(std::span<double* const> x, std::vector<double>& work) const;

    /// Numbers in L, and multiply-adds of a factorization.
    [[nodiscard]] std::size_t entries() const { return values_.size(); }
    [[nodiscard]] double factor_work() const { return work_; }

private:
    struct Panel {
        std::int32_t first_column, columns;  // in the new order, unknowns
        std::int32_t first_row, rows;        // in rows_: of unknowns below the panel's own square
        std::int64_t first_value;            // [columns + rows][columns] in values_, column by column
    };
    std::int32_t blocks_ = 0;
    std::vector<std::int32_t> order_;  // [free blocks] old block of each new one
    std::vector<Panel> panels_;
    std::vector<std::int32_t> rows_;  // [..] new unknowns
    std::vector<double> values_;
    double work_ = 0;
};

}  // namespace seldinger
