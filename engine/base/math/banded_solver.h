#pragma once
// The linear solver of Newton's method: a banded matrix. Entries outside the band over its whole length (`far`) are part of it;
// it then has factors of its own (math/node_factors.h). Unknowns beside the band that are eliminated (math/condensed.h) add a few
// more solutions for their remainder.

#include "math/band_matrix.h"
#include "math/condensed.h"
#include "math/far_entries.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace seldinger {

class NodeFactors;

class BandedSolver {
public:
    explicit BandedSolver(int max_size);
    ~BandedSolver();

    /// Zero band of `size` unknowns, nothing far from it, nothing condensed.
    void reset(int size);
    /// In which order nodes are eliminated where there are far entries: [nodes] the first, the second, ...; empty: by minimum
    /// degree. Those that couple should be near each other.
    void set_order(std::span<const int> order) { order_.assign(order.begin(), order.end()); }
    /// See BandMatrix::set_fourth().
    void set_fourth(bool takes_part);
    /// Makes unknown i prescribed: row and column zero, unit diagonal.
    void fix(int i);
    /// y += x_j times column j of the matrix, with what is far and condensed
    void add_column(int j, double x_j, std::span<double> y) const;

    /// Symmetric: LDL^T with pivots raised to what a positive definite matrix could have (band_matrix.h). @return pivots raised
    [[nodiscard]] int factor_symmetric();
    /// The matrix as it is, by LU. @return pivots that are negative; size() where a pivot vanishes: no factors
    [[nodiscard]] int factor_unsymmetric();
    /// With the last factors.
    void solve(std::span<double> rhs_to_x);

    BandMatrix band;
    FarEntries far;
    Condensed condensed;

private:
    void solve_band(std::span<double> rhs_to_x);

    bool unsymmetric_ = false;
    bool fourth_ = true;
    bool with_far_ = false;            // factors are those of band and far entries
    std::vector<int> order_;
    std::unique_ptr<NodeFactors> node_factors_;
    std::vector<std::uint8_t> fixed_;  // [max_size] prescribed unknowns
};

}  // namespace seldinger
