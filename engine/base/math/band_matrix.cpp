// Factors of the band matrix, node by node, and solutions with them.
#include "math/band_matrix.h"

#include "math/node_lanes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace seldinger {
namespace {

constexpr std::size_t row_end = 4;                            // whole vectors may be read at the last row's end
constexpr int beside = 2 * BandRows::node_size + 4;  // of the scratch: two nodes past the last one; 4 more to align it

/// Memory of a matrix itself, made where it is first needed.
template <class Number>
void provide(Number*& use, std::vector<Number>& own, std::size_t count)
{
    if (use) return;
    own.resize(count);
    use = own.data();
}

}  // namespace

BandMatrix::Storage::Storage(int max_size)
{
    if (max_size == 0) return;
    rows.resize(static_cast<std::size_t>(max_size) * stride + row_end);
    factor.resize(max_size / node_size + 2);
}

BandMatrix::BandMatrix(int max_size) : max_size_(max_size)
{
    SEL_ASSERT(max_size % node_size == 0);
    scratch_.resize(max_size + beside);
}

void BandMatrix::reset(int size)
{
    SEL_ASSERT(size % node_size == 0 && size <= max_size_);
    provide(rows_, own_.rows, static_cast<std::size_t>(max_size_) * stride + row_end);
    size_ = size;
    std::fill_n(rows_, static_cast<std::size_t>(size) * stride, 0.0);
}

double BandMatrix::row_scale(int i) const
{
    Vec4d most = {};
    const double* entries = row(i);
    for (int c = 0; c < stride; c += 4) {  // what lies beyond row_width is 0
        Vec4d size;
        read_block(entries + c, size);
        size = magnitude(size);
        most = most < size ? size : most;
    }
    const double scale = largest(most);
    return scale > 0 ? scale : 1.0;
}

// Row p of a node holds columns 4b .. 4b+11 contiguously from offset 10 - p; the padding of the row supplies the zero that
// row 0 needs at column 4b+11.
void BandMatrix::load_upper()
{
    provide(factor_, own_.factor, max_size_ / node_size + 2);
    const int nodes = size_ / node_size;
    for (int b = 0; b < nodes; ++b)
        for (int p = 0; p < 4; ++p) std::memcpy(factor_[b].upper[p], row(4 * b + p) + half_bandwidth - p, 12 * sizeof(double));
    for (int b = nodes; b < nodes + 2; ++b) std::memset(&factor_[b], 0, sizeof(NodeFactor));
}

// Row t of the next two nodes has this node's columns at offset 6 - t. For t = 7 that is one before the row's first entry,
// outside of the matrix.
void BandMatrix::load_lower()
{
    const int nodes = size_ / node_size;
    for (int b = 0; b < nodes; ++b)
        for (int half = 0; half < 2; ++half) {
            Vec4d block_of[4] = {};
            for (int t = 0; t < 4 && b + 1 + half < nodes; ++t)
                read_block(row(4 * (b + 1 + half) + t) + 6 - 4 * half - t, block_of[t]);
            if (half == 1) block_of[3][0] = 0.0;
            transpose(block_of);
            for (int p = 0; p < 4; ++p) block(factor_[b].lower[p] + 4 * half) = block_of[p];
        }
}

namespace {

/// LDL^T of one node's four rows. @return pivots raised
template <int active, class NodeFactor>
inline int eliminate_node(NodeFactor& f, const NodeFactor& f1, const NodeFactor& f2, Vec4d (&near)[4], Vec4d (&far)[4])
{
    int raised = 0;
    for (int p = 0; p < active; ++p) {
        double pivot = f.upper[p][p];
        for (int c = 0; c <= p; ++c) f.upper[p][c] = 0.0;  // so that the solve can use whole blocks
        const Vec4d own = block(f.upper[p]), row1 = block(f.upper[p] + 4), row2 = block(f.upper[p] + 8);
        const Vec4d bound = own * own * block(f.inverse_diagonal) + row1 * row1 * block(f1.inverse_diagonal) +
                            row2 * row2 * block(f2.inverse_diagonal);
        // the sum of three squares is at most three times the largest
        const double needed = largest(bound) / 3;
        if (!(pivot * f.inverse_diagonal[p] > BandMatrix::pivot_floor && pivot > 0.5 * needed)) {  // not-a-number too
            pivot = std::max(1.0 / f.inverse_diagonal[p], needed);
            ++raised;
        }
        const double inverse = 1.0 / pivot;
        f.inverse_pivot[p] = inverse;
        for (int q = p + 1; q < active; ++q) {
            const double multiplier = f.upper[p][q] * inverse;
            block(f.upper[q]) -= multiplier * own;
            block(f.upper[q] + 4) -= multiplier * row1;
            block(f.upper[q] + 8) -= multiplier * row2;
        }
        near[p] = row1 * inverse;
        far[p] = row2 * inverse;
    }
    return raised;
}

/// What the node leaves of the rows of the next two.
template <int active, class NodeFactor>
inline void update_following(const NodeFactor& f, NodeFactor& f1, NodeFactor& f2, const Vec4d (&near)[4], const Vec4d (&far)[4])
{
    for (int t = 0; t < active; ++t) {
        Vec4d a = block(f1.upper[t]), c = block(f1.upper[t] + 4), d = block(f2.upper[t]);
        for (int p = 0; p < active; ++p) {
            a -= near[p][t] * block(f.upper[p] + 4);
            c -= near[p][t] * block(f.upper[p] + 8);
            d -= far[p][t] * block(f.upper[p] + 8);
        }
        block(f1.upper[t]) = a;
        block(f1.upper[t] + 4) = c;
        block(f2.upper[t]) = d;
    }
}

}  // namespace

template <int active>
int BandMatrix::factor_ldlt_of()
{
    load_upper();
    const int nodes = size_ / node_size;
    for (int i = 0; i < size_; ++i) {
        const double diagonal = std::abs(at(i, i));
        factor_[i / 4].inverse_diagonal[i % 4] = i % 4 < active ? 1.0 / (diagonal > 0 ? diagonal : row_scale(i)) : 0.0;
        factor_[i / 4].inverse_pivot[i % 4] = 0.0;
    }
    int raised = 0;
    for (int b = 0; b < nodes; ++b) {
        NodeFactor &f = factor_[b], &f1 = factor_[b + 1], &f2 = factor_[b + 2];
        Vec4d near[4], far[4];  // rows of the following two nodes' columns, scaled by the pivot
        raised += eliminate_node<active>(f, f1, f2, near, far);
        update_following<active>(f, f1, f2, near, far);
    }
    return raised;
}

namespace {

double* aligned(std::vector<double>& scratch)
{
    auto address = reinterpret_cast<std::uintptr_t>(scratch.data());
    return reinterpret_cast<double*>((address + 31) & ~std::uintptr_t{31});
}

/// From the last node to the first. The two solved last stay in registers: a vector that is loaded where four numbers have just
/// been stored waits for them. @param unknown  from its right side, the sum over the unknowns behind it, and 1 / pivot
template <int active, class NodeFactor>
void substitute_back(const NodeFactor* factor, int nodes, double* x, const auto& unknown)
{
    Vec4d near = {}, far = {};
    for (int b = nodes - 1; b >= 0; --b) {
        const NodeFactor& f = factor[b];
        double own[4] = {}, inner[4];
        for (int p = 0; p < active; ++p) inner[p] = sum(block(f.upper[p] + 4) * near + block(f.upper[p] + 8) * far);
        for (int p = active - 1; p >= 0; --p) {
            for (int c = p + 1; c < active; ++c) inner[p] += f.upper[p][c] * own[c];
            own[p] = unknown(x[4 * b + p], inner[p], f.inverse_pivot[p]);
        }
        far = near;
        near = Vec4d{own[0], own[1], own[2], own[3]};
        block(x + 4 * b) = near;
    }
}

}  // namespace

template <int active>
void BandMatrix::solve_ldlt_of(std::span<double> rhs_to_x)
{
    SEL_ASSERT(static_cast<int>(rhs_to_x.size()) >= size_);
    const int nodes = size_ / node_size;
    double* x = aligned(scratch_);
    std::copy_n(rhs_to_x.begin(), size_, x);
    std::fill_n(x + size_, 8, 0.0);
    for (int b = 0; b < nodes; ++b) {
        const NodeFactor& f = factor_[b];
        Vec4d own = block(x + 4 * b), near = block(x + 4 * b + 4), far = block(x + 4 * b + 8);
        for (int p = 0; p < active; ++p) {
            const double z = own[p] * f.inverse_pivot[p];
            own -= z * block(f.upper[p]);
            near -= z * block(f.upper[p] + 4);
            far -= z * block(f.upper[p] + 8);
        }
        block(x + 4 * b) = own * block(f.inverse_pivot);
        block(x + 4 * b + 4) = near;
        block(x + 4 * b + 8) = far;
    }
    substitute_back<active>(factor_, nodes, x,
                            [](double right, double inner, double inverse) { return right - inverse * inner; });
    std::copy_n(x, size_, rhs_to_x.begin());
}

template <int active>
bool BandMatrix::factor_lu_of()
{
    load_upper();
    load_lower();
    negative_pivots_ = 0;
    const int nodes = size_ / node_size;
    for (int b = 0; b < nodes; ++b) {
        NodeFactor& f = factor_[b];
        for (int p = 0; p < active; ++p) {
            const double pivot = f.upper[p][p];
            if (!(std::abs(pivot) > pivot_floor * row_scale(4 * b + p))) return false;
            negative_pivots_ += pivot < 0;
            const double inverse = 1.0 / pivot;
            f.inverse_pivot[p] = inverse;
            Vec4d own = block(f.upper[p]);
            for (int c = 0; c <= p; ++c) own[c] = 0.0;  // multipliers and the pivot itself
            for (int q = p + 1; q < active; ++q) {
                const double multiplier = f.upper[q][p] * inverse;
                block(f.upper[q]) -= multiplier * own;
                block(f.upper[q] + 4) -= multiplier * block(f.upper[p] + 4);
                block(f.upper[q] + 8) -= multiplier * block(f.upper[p] + 8);
                f.upper[q][p] = multiplier;
            }
            block(f.lower[p]) *= inverse;
            block(f.lower[p] + 4) *= inverse;
            for (int q = p + 1; q < active; ++q) {
                block(f.lower[q]) -= f.upper[p][q] * block(f.lower[p]);
                block(f.lower[q] + 4) -= f.upper[p][q] * block(f.lower[p] + 4);
            }
        }
        NodeFactor &f1 = factor_[b + 1], &f2 = factor_[b + 2];
        for (int t = 0; t < active; ++t)
            for (int p = 0; p < active; ++p) {
                block(f1.upper[t]) -= f.lower[p][t] * block(f.upper[p] + 4);
                block(f1.upper[t] + 4) -= f.lower[p][t] * block(f.upper[p] + 8);
                block(f1.lower[t]) -= f.upper[p][4 + t] * block(f.lower[p] + 4);
                block(f2.upper[t]) -= f.lower[p][4 + t] * block(f.upper[p] + 8);
            }
    }
    return true;
}

template <int active>
void BandMatrix::solve_lu_of(std::span<double> rhs_to_x)
{
    SEL_ASSERT(static_cast<int>(rhs_to_x.size()) >= size_);
    const int nodes = size_ / node_size;
    double* x = aligned(scratch_);
    std::copy_n(rhs_to_x.begin(), size_, x);
    std::fill_n(x + size_, 8, 0.0);
    Vec4d ahead = block(x), next = block(x + 4);  // of this node and the next one, less what those before took from them
    for (int b = 0; b < nodes; ++b) {
        const NodeFactor& f = factor_[b];
        double own[4] = {ahead[0], ahead[1], ahead[2], ahead[3]};
        Vec4d far = block(x + 4 * b + 8);
        for (int p = 0; p < active; ++p) {
            for (int q = p + 1; q < active; ++q) own[q] -= f.upper[q][p] * own[p];
            next -= own[p] * block(f.lower[p]);
            far -= own[p] * block(f.lower[p] + 4);
        }
        block(x + 4 * b) = Vec4d{own[0], own[1], own[2], own[3]};
        ahead = next;
        next = far;
    }
    substitute_back<active>(factor_, nodes, x,
                            [](double right, double inner, double inverse) { return (right - inner) * inverse; });
    std::copy_n(x, size_, rhs_to_x.begin());
}

template int BandMatrix::factor_ldlt_of<3>();
template int BandMatrix::factor_ldlt_of<4>();
template void BandMatrix::solve_ldlt_of<3>(std::span<double>);
template void BandMatrix::solve_ldlt_of<4>(std::span<double>);
template bool BandMatrix::factor_lu_of<3>();
template bool BandMatrix::factor_lu_of<4>();
template void BandMatrix::solve_lu_of<3>(std::span<double>);
template void BandMatrix::solve_lu_of<4>(std::span<double>);

}  // namespace seldinger
