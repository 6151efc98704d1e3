#pragma once
// Sums of small blocks between control vertices, then an Eigen matrix of them.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

/// Which vertices share a triangle's stencil. Blocks are kept for column <= row; the rest follows by symmetry.
class BlockPattern {
public:
    /// @param stencils  vertices that are joined with each other, one list per triangle
    BlockPattern(std::int32_t vertices, std::span<const std::vector<std::int32_t>> stencils);

    [[nodiscard]] std::int32_t vertex_count() const { return static_cast<std::int32_t>(first_.size()) - 1; }
    [[nodiscard]] std::size_t block_count() const { return row_.size(); }
    /// Place of block (row, column), row >= column.
    [[nodiscard]] std::size_t find(std::int32_t row, std::int32_t column) const;
    /// Symmetric matrix of blocks of size x size numbers, column by column. @param values  [block_count][size][size]
    [[nodiscard]] Eigen::SparseMatrix<double> matrix(std::span<const double> values, int size) const;

private:
    std::vector<std::int32_t> first_;  // [V + 1]
    std::vector<std::int32_t> row_;    // of the blocks of a column, increasing, from the diagonal on
};

}  // namespace seldinger
