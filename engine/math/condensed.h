#pragma once
// Unknowns u beside a banded matrix B that are eliminated where it is solved with: points of a compliant foundation, say, that
// everything which touches it shares.
//
//     B x - E u = r                            x: the unknowns of the band [n]
//     (W^-1 + D) u - F x = 0                   u: the others [m]; W: a dense symmetric compliance, D: a sparse stiffness
//
// so that the whole is A = B - E (W^-1 + D)^-1 F. W may be singular: only (I + W D) is ever solved with, by GMRES [Saad86], whose
// matrix is the identity and a compact rest, which takes few iterations; m of them at most. E = F^T where B and D are symmetric.
//
// [Saad86] Saad, Schultz: GMRES. SIAM J. Sci. Stat. Comput. 7(3), 1986. doi:10.1137/0907058

#include "math/low_rank.h"

#include <functional>
#include <span>
#include <vector>

namespace seldinger {

/// Solves M u = b by GMRES without restarts; u holds b on entry. @param product  (v, M v)
/// @param accuracy  of the residual, relative to b. @return iterations taken
int solve_gmres(std::span<double> u, double accuracy,
                const std::function<void(std::span<const double>, std::span<double>)>& product);

class Condensed {
public:
    using Column = LowRank::Column;

    void clear() { size_ = 0; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] int size() const { return size_; }
    /// m unknowns; nothing joins them with x yet. @param compliance  W [m][m], row by row; kept as a view
    void reset(int size, std::span<const double> compliance);

    std::vector<Column> e, f, d;  // [m] columns of E, rows of F (unknowns of the band), rows of D (of the m)

    /// y -= E (I + W D)^-1 W F x: what the m unknowns take off a product with B.
    void add_product(std::span<const double> x, std::span<double> y) const;
    /// y -= x_j times column j of E (I + W D)^-1 W F
    void add_column(int j, double x_j, std::span<double> y) const;
    /// u = (I + W D)^-1 b in place
    void solve_own(std::span<double> u) const;

    /// x = A^-1 r in place. @param band  x <- B^-1 x in place  @param fixed  [n] unknowns that are prescribed: E and F have
    /// nothing there. @return iterations of GMRES
    int solve(std::span<double> r_to_x, std::span<const unsigned char> fixed,
              const std::function<void(std::span<double>)>& band) const;

    // parts, for those who keep the unknowns u
    void times_w(std::span<const double> v, std::span<double> wv) const;
    static void onto(const std::vector<Column>& rows, std::span<const double> x, std::span<double> out);

private:
    void take_off(std::span<double> wfx_to_u, std::span<double> y) const;
    int size_ = 0;
    std::span<const double> w_;
};

}  // namespace seldinger
