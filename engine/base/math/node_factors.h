#pragma once
// Sparse factors of a band and of distant entries (FarEntries), by blocks of four unknowns (nodes) that are eliminated in a given
// order. Two rods in contact over their length stay cheap if their nodes are taken in turn, however distant they are in the
// vector of unknowns. A rod that touches itself is eliminated by minimum degree: in the order in which its nodes lie, a place
// where strands touch fills a column all along the wire between them. A coil of 247 nodes with 23 such places took 6 x the
// products.
//
// Which blocks fill is found first (elimination tree: what a node's row leaves to the next one of its columns) and kept while the
// pattern stays. Then node by node as in BandMatrix, by the same rules for pivots. If s blocks beside the diagonal one remain
// in its row, a node costs s (s + 1)/2 products of 4x4 blocks (twice that in an LU). This number is 2 for a single rod, 4 to 6
// for two rods in contact over their length, 7 to 10 for three. Two rods of 100 nodes took 70 us, their bands alone 17 us. A
// crossing of rods far apart fills only the columns that it joins.

#include "math/band_matrix.h"
#include "math/far_entries.h"

#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

class NodeFactors {
public:
    static constexpr int width = FarEntries::width;

    /// LDL^T of the symmetric matrix band + far (reads the upper half in elimination order), pivots raised as in BandMatrix.
    /// @param fixed  [unknowns] whose far entries are left out: prescribed  @param order  [nodes] which node is
    /// eliminated first, second, ...; empty: by minimum degree
    /// @param fourth  whether every node's fourth unknown takes part, see BandMatrix::set_fourth()  @return pivots raised
    int factor_ldlt(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed, std::span<const int> order,
                    bool fourth);
    /// LU of the whole without pivoting. @return false when a pivot vanishes against its row's scale
    [[nodiscard]] bool factor_lu(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed,
                                 std::span<const int> order, bool fourth);
    /// Negative pivots of the last factor_lu().
    [[nodiscard]] int negative_pivots() const { return negative_pivots_; }
    /// With the last factors.
    void solve_ldlt(std::span<double> rhs_to_x);
    void solve_lu(std::span<double> rhs_to_x);

    /// Blocks beside the diagonal in the factor's upper half, after the last factorisation.
    [[nodiscard]] std::size_t block_count() const { return cols_.size(); }

private:
    struct alignas(32) Block {
        double v[width][width];
    };
    struct alignas(32) Diagonal {
        double v[width][width];  // U, and (LU) multipliers below
        double inverse_pivot[width];
        double inverse_diagonal[width];  // 1 / |a_kk| of the matrix itself
    };

    [[nodiscard]] std::vector<int> chosen_order(const FarEntries& far) const;
    void lay_out(const BandRows& band, const FarEntries& far, std::span<const int> order);
    [[nodiscard]] bool is_known(const FarEntries& far, std::span<const int> order) const;
    void find_joined(const BandRows& band);
    void find_pattern();
    void find_targets();
    [[nodiscard]] int place_of(int row, int col) const;
    void load(const BandRows& band, const FarEntries& far, std::span<const unsigned char> fixed, bool lower, bool fourth);
    void load_band(const BandRows& band, bool lower);
    void load_far(const FarEntries& far, std::span<const unsigned char> fixed, bool lower);
    void find_scales(bool lower);
    void load_block(int row, int col, const double (&value)[width][width], bool lower);
    void drop_fourth();
    int eliminate_ldlt(int node);
    [[nodiscard]] bool eliminate_lu(int node);
    template <bool lower>
    void update_following(int node);
    void gather(std::span<const double> from);
    void scatter(std::span<double> to) const;
    [[nodiscard]] int nodes() const { return static_cast<int>(order_.size()); }

    // the pattern: rows and columns are places in the elimination order
    std::vector<int> order_, place_;                   // [nodes] node at a place, place of a node
    bool chosen_ = false;                              // whether the order is chosen_order()'s
    std::vector<std::uint64_t> known_;                 // far blocks that the pattern was made for
    std::vector<std::uint8_t> joined_, known_joined_;  // [nodes][reach] whether the band joins a node with those ahead; as it was
    std::vector<std::size_t> begin_;                   // [nodes + 1] in cols_
    std::vector<int> cols_;                            // [blocks] rising within a row
    std::vector<int> targets_;                         // [pairs of a row's columns] block that the pair changes
    std::vector<std::size_t> target_begin_;            // [nodes]
    std::vector<std::vector<int>> structure_;          // scratch of find_pattern
    // the numbers
    std::vector<Diagonal> diagonal_;             // [nodes]
    std::vector<Block> upper_, lower_, scaled_;  // [blocks]; lower_ transposed, LU only; scaled_: of one row
    std::vector<double> scale_;                  // [unknowns] largest magnitude in a row
    std::vector<Block> x_;                       // scratch of solves, 4 nodes to a block
    int negative_pivots_ = 0;
    bool fourth_ = true;
};

}  // namespace seldinger
