#pragma once
// Cholesky factor of a sparse symmetric positive definite matrix of 3 x 3 blocks, in dense panels (supernodes), for many solves.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

namespace seldinger {

struct Elimination;

/// P A P^T = L L^T. Order: whichever fills least of nested dissection of the graph of blocks, minimum degree, and the caller's.
/// The bits of a solution depend on the matrix and that order alone, and are the same one right-hand side at a time or several.
///
/// A solve takes as long as L takes to be read. So L is stored in single precision, and computed with in double, if it would not
/// fit a core's own cache and solutions change by less than single_error: that is measured on one that consists of the softest
/// modes, which rounding changes most. A mode v has the stiffness |L^T v|^2. Rounding of L to e = 6e-8 changes it by 2 (dL^T
/// v).(L^T v), or by e sqrt(c) of itself at most, where c is the stiffness of the stiffest mode over its own. (Rounding of A
/// would change it by e c.)
class BlockCholesky {
public:
    static constexpr std::size_t single_from = std::size_t{1} << 17;  // entries: 1 MB in double precision
    static constexpr double single_error = 1e-5;                      // of the largest number of a solution

    /// @param matrix  [3B][3B], both triangles stored, rows of a column in increasing order
    /// @param skip    [B] 1: rows and columns of this block are left out, solutions are 0 there; may be empty
    /// @param along   [B] blocks with greater values are eliminated first: on a tube or a tree of them, distance from an end
    /// makes
    ///                fronts of a few rings, which nested dissection fills twice; may be empty
    /// @param from    entries of L from which it may be stored in single precision
    /// @return false when the matrix is not positive definite, as far as rounding can tell (a pivot below 1e-11 of its diagonal)
    [[nodiscard]] bool factor(const Eigen::SparseMatrix<double>& matrix, std::span<const unsigned char> skip = {},
                              std::span<const double> along = {}, std::size_t from = single_from);
    /// Whether L is stored in single precision.
    [[nodiscard]] bool single() const { return !singles_.empty(); }

    /// x = A^-1 x in place. @param x  [3B] each  @param work  scratch
    void solve(std::span<double> x, std::vector<double>& work) const;
    /// Two at once: L is read once for both.
    void solve(std::span<double> x, std::span<double> y, std::vector<double>& work) const;
    /// Three at once.
    void solve(std::span<double> x, std::span<double> y, std::span<double> z, std::vector<double>& work) const;

    /// A solution of which only some blocks are asked for: each takes the panels on the way from the root to it that no other has
    /// taken.
    struct Partial {
        std::vector<double> x;            // in the new order
        std::vector<unsigned char> known;  // [panels]
        std::vector<double> work;
    };
    /// The way down: y = L^-1 b. @param b  [3B]
    void begin(std::span<const double> b, Partial& partial) const;
    /// The solution's three numbers of a block; the bits are those of solve().
    void read(std::int32_t block, Partial& partial, double* to) const;

    /// Numbers that a solve reads, once down and once up.
    [[nodiscard]] std::size_t entries() const { return values_.size() + singles_.size() + inverse_.size(); }
    [[nodiscard]] std::size_t bytes() const
    {
        return sizeof(double) * (values_.size() + inverse_.size()) + sizeof(float) * singles_.size();
    }

private:
    /// Columns of L with the same rows below. Three columns (a block) after each other, each in groups of 8 rows by 3 columns,
    /// from the diagonal's group on. Entries above, inside or past the diagonal blocks' rows are 0.
    struct Panel {
        std::int32_t first, columns;   // blocks in the new order
        std::int32_t first_row, rows;  // in rows_: blocks below the panel's own square
        std::int32_t stride;           // unknowns of both, rounded up to eights
        std::int64_t first_value;      // in values_
    };
    /// Sorts blocks into free and skipped ones. @return place of each among the free, -1
    std::vector<std::int32_t> take(Eigen::Index unknowns, std::span<const unsigned char> skip);
    [[nodiscard]] bool factor_panels(const Eigen::SparseMatrix<double>& matrix, const Elimination& symbolic,
                                     std::span<const std::int32_t> place);
    void keep(const Eigen::MatrixXd& front, std::int32_t first, std::int32_t columns, std::span<const std::int32_t> below);
    void round_if_accurate();
    [[nodiscard]] double error_of_singles() const;
    /// f with the values, in whichever precision.
    template <class F>
    void with_values(const F& f) const
    {
        if (singles_.empty()) f(values_.data(), values_.size());
        else f(singles_.data(), singles_.size());
    }
    /// @param values  of L
    template <int sides, class Value>
    void down(const Panel& panel, const Value* values, double* const* y, double* const* t) const;
    template <int sides, class Value>
    void up(const Panel& panel, const Value* end, double* const* y, double* const* t) const;
    template <int sides, class Value>
    void run(const Value* values, std::size_t count, double* const* x, std::vector<double>& work) const;
    template <int sides>
    void solve_sides(double* const* x, std::vector<double>& work) const
    {
        with_values([&](const auto* values, std::size_t count) { run<sides>(values, count, x, work); });
    }

    std::int32_t blocks_ = 0;
    std::int32_t widest_ = 0;          // greatest stride
    std::vector<std::int32_t> order_;  // [free blocks] old block of each new one
    std::vector<std::int32_t> skipped_;
    std::vector<std::int32_t> place_;     // [B] new block of each old one; -1: skipped
    std::vector<std::int32_t> panel_of_;  // [free blocks] in the new order
    std::vector<Panel> panels_;       // children before parents
    std::vector<std::int32_t> rows_;  // new blocks
    std::vector<double> values_;
    std::vector<float> singles_;  // in their place
    std::vector<double> inverse_;  // [free blocks][9] inverses of the diagonal 3 x 3 blocks of L, column by column
};

}  // namespace seldinger
