#pragma once
// The linear solver of Newton's method: a banded matrix A, and columns U C V^T for the few unknowns that couple outside of its
// band. Without columns it is the band's factors and nothing else. Entries outside of the band over its whole length (`far`) are
// part of A, which then has its own factors (math/node_factors.h). With k columns, by Woodbury:
//
//   (A + U C V^T)^-1 b = y - Z S^-1 C V^T y,   y = A^-1 b,   Z = A^-1 U,   S = I + C V^T Z          (k x k)
//
// which asks nothing of C: it may be singular, indefinite or unsymmetric. If the band alone is nearly singular (a wire that only a
// column holds), y and Z S^-1 C V^T y are both large and cancel, to eps cond(A) of the solution. So the residual of the whole is
// checked, and if it is too large the solution is refined once.
//
// Unknowns beside the band that are eliminated (math/condensed.h) add a few more solutions for their remainder.
//
// Signs. With A positive definite and C symmetric, A + U C U^T has as many negative eigenvalues as S has:
// A^-1/2 (A + U C U^T) A^-1/2 = I + W C W^T, W = A^-1/2 U, and W C W^T has the eigenvalues of C W^T W = C U^T A^-1 U beside zeros.

#include "math/band_matrix.h"
#include "math/condensed.h"
#include "math/far_entries.h"
#include "math/low_rank.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace seldinger {

class NodeFactors;

class BandedSolver {
public:
    explicit BandedSolver(int max_size);
    ~BandedSolver();

    /// Zero band of `size` unknowns, nothing far from it, no columns.
    void reset(int size);
    /// In which order nodes are eliminated where there are far entries: [nodes] the first, the second, ...; empty: by minimum degree.
    /// Those that couple should be near each other.
    void set_order(std::span<const int> order) { order_.assign(order.begin(), order.end()); }
    /// See BandMatrix::set_fourth().
    void set_fourth(bool takes_part);
    /// Makes unknown i prescribed: row and column zero, unit diagonal.
    void fix(int i);
    /// y += x_j times column j of the whole
    void add_column(int j, double x_j, std::span<double> y) const;

    /// Symmetric: LDL^T with pivots raised to what a positive definite matrix could have (band_matrix.h); where columns make the
    /// whole indefinite, the negative part of C is left out. @return pivots and eigenvalues that were not positive
    [[nodiscard]] int factor_symmetric();
    /// The whole as it is, by LU. @return pivots and eigenvalues that are negative; size() where a pivot vanishes: no factors
    [[nodiscard]] int factor_unsymmetric();
    /// With the last factors.
    void solve(std::span<double> rhs_to_x);
    /// |b - A x|/|b| of the last solve with columns, after refinement.
    [[nodiscard]] double last_residual() const { return last_residual_; }

    BandMatrix band;
    FarEntries far;
    LowRank columns;
    Condensed condensed;

private:
    struct Woodbury;  // what is kept of the columns; made when there are any
    int factor_band_symmetric();
    bool factor_band_unsymmetric();
    [[nodiscard]] int negative_pivots() const;
    void factor_columns();
    void solve_with_columns(std::span<double> rhs_to_x);
    void solve_band(std::span<double> rhs_to_x);
    void solve_whole(std::span<double> rhs_to_x);
    [[nodiscard]] double residual_of(std::span<const double> b, std::span<const double> x);

    bool unsymmetric_ = false;
    bool fourth_ = true;
    bool with_far_ = false;            // factors are those of band and far entries
    std::vector<int> order_;
    std::unique_ptr<NodeFactors> node_factors_;
    bool exact_ = true;                // factors are those of the matrix, with no pivot raised and no part of C left out
    std::vector<std::uint8_t> fixed_;  // [max_size] prescribed unknowns
    std::unique_ptr<Woodbury> woodbury_;
    std::vector<double> b_, r_;
    double last_residual_ = 0;
};

}  // namespace seldinger
