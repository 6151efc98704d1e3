// Factors of band and far entries, node by node in a given order, and solutions with them.
#include "math/node_factors.h"

#include "math/node_lanes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace seldinger {

// ---- the numbers ----------------------------------------------------------------------------------------------------

/// Adds a block of the matrix at these places.
void NodeFactors::load_block(int row, int col, const double (&value)[width][width], bool lower)
{
    if (row > col && !lower) return;
    if (row > col) {
        Block& to = lower_[place_of(col, row)];
        for (int r = 0; r < width; ++r)
            for (int c = 0; c < width; ++c) to.v[c][r] += value[r][c];
        return;
    }
    double(&to)[width][width] = row == col ? diagonal_[row].v : upper_[place_of(row, col)].v;
    for (int r = 0; r < width; ++r)
        for (int c = 0; c < width; ++c) to[r][c] += value[r][c];
}

void NodeFactors::load_band(const BandRows& band, bool lower)
{
    for (int a = 0; a < nodes(); ++a)
        for (int b = std::max(0, a - RodDofs::reach); b <= std::min(nodes() - 1, a + RodDofs::reach); ++b) {
            if (!lower && place_[a] > place_[b]) continue;
            if (a != b && !joined_[RodDofs::reach * std::min(a, b) + std::abs(a - b) - 1]) continue;
            double value[width][width];
            for (int r = 0; r < width; ++r)
                std::memcpy(value[r], band.row(width * a + r) + BandRows::half_bandwidth + width * (b - a) - r, sizeof value[r]);
            if (a - b == RodDofs::reach) value[width - 1][0] = 0.0;  // before the row's first entry
            load_block(place_[a], place_[b], value, lower);
        }
}

void NodeFactors::load_far(const FarEntries& far, std::span<const unsigned char> fixed, bool lower)
{
    for (const FarEntries::Block& from : far.blocks()) {
        if (!lower && place_[from.row] > place_[from.col]) continue;
        double value[width][width];
        for (int r = 0; r < width; ++r)
            for (int c = 0; c < width; ++c)
                value[r][c] = fixed[width * from.row + r] || fixed[width * from.col + c] ? 0.0 : from.value[r][c];
        load_block(place_[from.row], place_[from.col], value, lower);
    }
}

void NodeFactors::load(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed, bool lower, bool fourth)
{
    std::fill(upper_.begin(), upper_.end(), Block{});
    lower_.assign(lower ? cols_.size() : 0, Block{});
    std::fill(diagonal_.begin(), diagonal_.end(), Diagonal{});
    load_band(band, lower);
    load_far(far, fixed, lower);
    fourth_ = fourth;
    if (!fourth) drop_fourth();
    find_scales(lower);
}

/// Largest magnitudes in the rows; 1 where all are zero.
void NodeFactors::find_scales(bool lower)
{
    std::fill(scale_.begin(), scale_.end(), 0.0);
    const auto see = [](Vec4d& most, const Vec4d& v) {
        const Vec4d size = v > -v ? v : -v;
        most = size > most ? size : most;
    };
    const auto see_in = [&](int node, const double(&of)[width][width]) {  // the columns of a block
        Vec4d most;
        read_block(&scale_[width * node], most);
        for (const double(&row)[width] : of) see(most, block(row));
        std::memcpy(&scale_[width * node], &most, sizeof most);
    };
    for (int row = 0; row < nodes(); ++row) {
        const double(&own)[width][width] = diagonal_[row].v;
        for (int r = 0; r < width; ++r) {
            Vec4d most = {0, 0, 0, 0};
            for (int c = 0; c < width; ++c) most[c] = std::abs(lower || c >= r ? own[r][c] : own[c][r]);
            for (std::size_t k = begin_[row]; k < begin_[row + 1]; ++k) see(most, block(upper_[k].v[r]));
            scale_[width * row + r] = std::max(scale_[width * row + r], largest(most));
        }
        for (std::size_t k = begin_[row]; k < begin_[row + 1]; ++k) see_in(cols_[k], (lower ? lower_ : upper_)[k].v);
    }
    for (double& scale : scale_) scale = scale > 0 ? scale : 1.0;
}

/// The fourth unknowns' equations become x = 0.
void NodeFactors::drop_fourth()
{
    constexpr int last = width - 1;
    for (Diagonal& diagonal : diagonal_)
        for (int c = 0; c < width; ++c) diagonal.v[last][c] = diagonal.v[c][last] = c == last;
    for (std::vector<Block>* blocks : {&upper_, &lower_})
        for (Block& of : *blocks)
            for (int c = 0; c < width; ++c) of.v[last][c] = of.v[c][last] = 0;
}

/// What the node leaves of the rows of its columns. LDL^T: scaled_ holds its row over its pivots.
template <bool lower>
void NodeFactors::update_following(int node)
{
    const std::size_t begin = begin_[node], end = begin_[node + 1];
    const int* target = targets_.data() + target_begin_[node];
    for (std::size_t k = begin; k < end; ++k) {
        const Block& from = lower ? lower_[k] : scaled_[k - begin];
        for (std::size_t l = k; l < end; ++l) {
            const int at = l == k ? 0 : *target++;
            double(&to)[width][width] = l == k ? diagonal_[cols_[k]].v : upper_[at].v;
            for (int t = 0; t < width; ++t) {
                Vec4d row = block(to[t]);
                for (int p = 0; p < width; ++p) row -= from.v[p][t] * block(upper_[l].v[p]);
                block(to[t]) = row;
            }
            if (!lower || l == k) continue;
            for (int t = 0; t < width; ++t) {
                Vec4d row = block(lower_[at].v[t]);
                for (int p = 0; p < width; ++p) row -= upper_[k].v[p][t] * block(lower_[l].v[p]);
                block(lower_[at].v[t]) = row;
            }
        }
    }
}

// ---- LDL^T ----------------------------------------------------------------------------------------------------

/// @return pivots raised
int NodeFactors::eliminate_ldlt(int node)
{
    Diagonal& own = diagonal_[node];
    const std::size_t begin = begin_[node], end = begin_[node + 1];
    int raised = 0;
    for (int p = 0; p < width; ++p) {
        double pivot = own.v[p][p];
        for (int c = 0; c <= p; ++c) own.v[p][c] = 0.0;  // so that the solve can use whole blocks
        const Vec4d row = block(own.v[p]);
        double needed = largest(row * row * block(own.inverse_diagonal));
        for (std::size_t k = begin; k < end; ++k) {
            const Vec4d beside = block(upper_[k].v[p]);
            needed = std::max(needed, largest(beside * beside * block(diagonal_[cols_[k]].inverse_diagonal)));
        }
        if (!(pivot * own.inverse_diagonal[p] > BandMatrix::pivot_floor && pivot > 0.5 * needed)) {  // not-a-number too
            pivot = std::max(1.0 / own.inverse_diagonal[p], needed);
            ++raised;
        }
        const double inverse = own.inverse_pivot[p] = 1.0 / pivot;
        for (int q = p + 1; q < width; ++q) {
            const double multiplier = own.v[p][q] * inverse;
            block(own.v[q]) -= multiplier * row;
            for (std::size_t k = begin; k < end; ++k) block(upper_[k].v[q]) -= multiplier * block(upper_[k].v[p]);
        }
        for (std::size_t k = begin; k < end; ++k) block(scaled_[k - begin].v[p]) = block(upper_[k].v[p]) * inverse;
    }
    update_following<false>(node);
    return raised;
}

int NodeFactors::factor_ldlt(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed,
                             std::span<const int> order, bool fourth)
{
    lay_out(band, far, order);
    load(band, far, fixed, false, fourth);
    for (int node = 0; node < nodes(); ++node)
        for (int p = 0; p < width; ++p) {
            const double size = std::abs(diagonal_[node].v[p][p]);
            diagonal_[node].inverse_diagonal[p] = 1.0 / (size > 0 ? size : scale_[width * node + p]);
        }
    int raised = 0;
    for (int node = 0; node < nodes(); ++node) raised += eliminate_ldlt(node);
    return raised;
}

/// The right side in elimination order.
void NodeFactors::gather(std::span<const double> from)
{
    SEL_ASSERT(static_cast<int>(from.size()) >= width * nodes());
    for (int at = 0; at < nodes(); ++at) {
        double* to = x_[at / width].v[at % width];
        std::copy_n(&from[width * order_[at]], width, to);
        if (!fourth_) to[width - 1] = 0;
    }
}

void NodeFactors::scatter(std::span<double> to) const
{
    for (int at = 0; at < nodes(); ++at) std::copy_n(x_[at / width].v[at % width], width, &to[width * order_[at]]);
}

void NodeFactors::solve_ldlt(std::span<double> rhs_to_x)
{
    gather(rhs_to_x);
    const auto x = [this](int at) -> Vec4d& { return block(x_[at / width].v[at % width]); };
    for (int node = 0; node < nodes(); ++node) {
        const Diagonal& f = diagonal_[node];
        Vec4d own = x(node);
        for (int p = 0; p < width; ++p) own -= own[p] * f.inverse_pivot[p] * block(f.v[p]);
        const Vec4d z = own * block(f.inverse_pivot);
        for (std::size_t k = begin_[node]; k < begin_[node + 1]; ++k) {
            Vec4d to = x(cols_[k]);
            for (int p = 0; p < width; ++p) to -= z[p] * block(upper_[k].v[p]);
            x(cols_[k]) = to;
        }
        x(node) = z;
    }
    for (int node = nodes() - 1; node >= 0; --node) {
        const Diagonal& f = diagonal_[node];
        Vec4d inner[width] = {};
        for (std::size_t k = begin_[node]; k < begin_[node + 1]; ++k)
            for (int p = 0; p < width; ++p) inner[p] += block(upper_[k].v[p]) * x(cols_[k]);
        Vec4d own = x(node);
        for (int p = width - 1; p >= 0; --p) own[p] -= f.inverse_pivot[p] * (sum(inner[p]) + sum(block(f.v[p]) * own));
        x(node) = own;
    }
    scatter(rhs_to_x);
}

// ---- LU ----------------------------------------------------------------------------------------------------

/// @return false where a pivot vanishes
bool NodeFactors::eliminate_lu(int node)
{
    Diagonal& own = diagonal_[node];
    const std::size_t begin = begin_[node], end = begin_[node + 1];
    for (int p = 0; p < width; ++p) {
        const double pivot = own.v[p][p];
        if (!(std::abs(pivot) > BandMatrix::pivot_floor * scale_[width * node + p])) return false;
        negative_pivots_ += pivot < 0;
        const double inverse = own.inverse_pivot[p] = 1.0 / pivot;
        Vec4d right = block(own.v[p]);
        for (int c = 0; c <= p; ++c) right[c] = 0.0;  // multipliers and the pivot itself
        for (int q = p + 1; q < width; ++q) {
            const double multiplier = own.v[q][p] * inverse;
            block(own.v[q]) -= multiplier * right;
            for (std::size_t k = begin; k < end; ++k) block(upper_[k].v[q]) -= multiplier * block(upper_[k].v[p]);
            own.v[q][p] = multiplier;
        }
        for (std::size_t k = begin; k < end; ++k) {
            block(lower_[k].v[p]) *= inverse;
            for (int q = p + 1; q < width; ++q) block(lower_[k].v[q]) -= own.v[p][q] * block(lower_[k].v[p]);
        }
    }
    update_following<true>(node);
    return true;
}

bool NodeFactors::factor_lu(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed,
                            std::span<const int> order, bool fourth)
{
    lay_out(band, far, order);
    load(band, far, fixed, true, fourth);
    negative_pivots_ = 0;
    for (int node = 0; node < nodes(); ++node)
        if (!eliminate_lu(node)) return false;
    return true;
}

void NodeFactors::solve_lu(std::span<double> rhs_to_x)
{
    gather(rhs_to_x);
    const auto x = [this](int at) -> Vec4d& { return block(x_[at / width].v[at % width]); };
    for (int node = 0; node < nodes(); ++node) {
        const Diagonal& f = diagonal_[node];
        double* own = x_[node / width].v[node % width];
        for (int p = 0; p < width; ++p)
            for (int q = p + 1; q < width; ++q) own[q] -= f.v[q][p] * own[p];
        for (std::size_t k = begin_[node]; k < begin_[node + 1]; ++k)
            for (int p = 0; p < width; ++p) x(cols_[k]) -= own[p] * block(lower_[k].v[p]);
    }
    for (int node = nodes() - 1; node >= 0; --node) {
        const Diagonal& f = diagonal_[node];
        Vec4d inner[width] = {};
        for (std::size_t k = begin_[node]; k < begin_[node + 1]; ++k)
            for (int p = 0; p < width; ++p) inner[p] += block(upper_[k].v[p]) * x(cols_[k]);
        double* own = x_[node / width].v[node % width];
        for (int p = width - 1; p >= 0; --p) {
            double left = own[p] - sum(inner[p]);
            for (int c = p + 1; c < width; ++c) left -= f.v[p][c] * own[c];
            own[p] = left * f.inverse_pivot[p];
        }
    }
    scatter(rhs_to_x);
}

}  // namespace seldinger
