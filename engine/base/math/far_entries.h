#pragma once
// Entries of a system's matrix that its band does not reach: what couples nodes of different rods, or far nodes of one, along
// their whole length. Kept by blocks of four rows and columns (a node, math/dof_map.h), in the order in which the blocks are
// first added to, so that sums do not depend on anything else. A step's entries are mostly those of the step before: memory is
// taken only while it grows.

#include "core/check.h"

#include <span>
#include <vector>

namespace seldinger {

class FarEntries {
public:
    static constexpr int width = 4;  // rows and columns of a block

    struct alignas(32) Block {
        double value[width][width];
        int row, col;  // of blocks
        int next;      // of the same row, -1: none
        int mirror;    // the block of the other half
    };

    /// No entries.
    void clear();
    [[nodiscard]] bool empty() const { return blocks_.empty(); }
    /// A(i, j) += value, any i and j. Callers fill both halves, also when symmetric.
    void add(int i, int j, double value) { block(i / width, j / width).value[i % width][j % width] += value; }
    /// A += factor * other
    void add_scaled(const FarEntries& other, double factor);
    /// The block of these rows and columns, made of zeros where there was none, and its mirror image with it: which blocks there
    /// are is symmetric. Valid until the next block is made.
    [[nodiscard]] Block& block(int row, int col);

    /// y += F x
    void add_product(std::span<const double> x, std::span<double> y) const;
    /// y += x_j times column j
    void add_column(int j, double x_j, std::span<double> y) const;

    [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }

private:
    [[nodiscard]] int find(int row, int col) const;
    int make(int row, int col);
    [[nodiscard]] int head(int row) const { return row < static_cast<int>(heads_.size()) ? heads_[row] : -1; }

    std::vector<Block> blocks_;
    std::vector<int> heads_;  // [rows of blocks] its first, -1: none
    int last_ = 0;            // that was asked for
};

}  // namespace seldinger
