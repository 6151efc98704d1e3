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

/// Sums of one triangle's blocks, in the order of its stencil; those with the greater vertex first count.
class StencilBlocks {
public:
    template <class Weights>
    StencilBlocks(const BlockPattern& pattern, const Weights& w) : place_(w.size() * w.size(), 0), counts_(w.size() * w.size(), 0)
    {
        for (std::size_t i = 0; i < w.size(); ++i)
            for (std::size_t j = 0; j < w.size(); ++j)
                if (w[i].vertex >= w[j].vertex) {
                    place_[i * w.size() + j] = pattern.find(w[i].vertex, w[j].vertex);
                    counts_[i * w.size() + j] = 1;
                }
    }
    /// values[its place] += block(i, j)
    template <int size, class Block>
    void add(std::vector<double>& values, std::size_t count, const Block& block) const
    {
        for (std::size_t i = 0, k = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j, ++k)
                if (counts_[k]) {
                    const auto sum = block(i, j);
                    double* to = values.data() + size * size * place_[k];
                    if constexpr (size == 1) *to += sum;
                    else for (int e = 0; e < size * size; ++e) to[e] += sum.data()[e];
                }
    }

private:
    std::vector<std::size_t> place_;  // [M][M] in the pattern
    std::vector<unsigned char> counts_;
};

}  // namespace seldinger
