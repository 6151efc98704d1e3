// Blocks of entries outside of a band.
#include "math/far_entries.h"

namespace seldinger {

void FarEntries::clear()
{
    for (const Block& block : blocks_) heads_[block.row] = -1;
    blocks_.clear();
    last_ = 0;
}

int FarEntries::find(int row, int col) const
{
    int at = head(row);
    while (at >= 0 && blocks_[at].col != col) at = blocks_[at].next;
    return at;
}

/// @return its place
int FarEntries::make(int row, int col)
{
    if (row >= static_cast<int>(heads_.size())) heads_.resize(row + 1, -1);
    const int at = static_cast<int>(blocks_.size());
    blocks_.push_back({{}, row, col, heads_[row], at});
    return heads_[row] = at;
}

FarEntries::Block& FarEntries::block(int row, int col)
{
    SEL_VALIDATE(row >= 0 && col >= 0);
    if (!blocks_.empty() && blocks_[last_].row == row && blocks_[last_].col == col) return blocks_[last_];
    last_ = find(row, col);
    if (last_ >= 0) return blocks_[last_];
    last_ = make(row, col);
    if (row != col) {
        const int mirror = make(col, row);
        blocks_[mirror].mirror = last_;
        blocks_[last_].mirror = mirror;
    }
    return blocks_[last_];
}

void FarEntries::add_scaled(const FarEntries& other, double factor)
{
    for (const Block& from : other.blocks_) {
        Block& to = block(from.row, from.col);
        for (int r = 0; r < width; ++r)
            for (int c = 0; c < width; ++c) to.value[r][c] += factor * from.value[r][c];
    }
}

void FarEntries::add_product(std::span<const double> x, std::span<double> y) const
{
    for (const Block& block : blocks_) {
        const double* in = &x[width * block.col];
        double* out = &y[width * block.row];
        for (int r = 0; r < width; ++r) {
            double sum = 0;
            for (int c = 0; c < width; ++c) sum += block.value[r][c] * in[c];
            out[r] += sum;
        }
    }
}

void FarEntries::add_column(int j, double x_j, std::span<double> y) const
{
    for (int at = head(j / width); at >= 0; at = blocks_[at].next) {
        const Block& block = blocks_[blocks_[at].mirror];
        for (int r = 0; r < width; ++r) y[width * block.row + r] += block.value[r][j % width] * x_j;
    }
}

}  // namespace seldinger
