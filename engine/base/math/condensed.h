#pragma once
// Unknowns u beside a banded matrix B that are eliminated where it is solved with: points of a compliant foundation, say, that
// everything which touches it shares.
//
//     B x - E u = r                            x: the unknowns of the band [n]
//     (W^-1 + D) u - F x = 0                   u: the others [m]; W: a dense symmetric compliance, D: a sparse stiffness
//
// so that the whole is A = B - E (W^-1 + D)^-1 F. W may be singular: only (I + W D) is ever solved with, by its LU; beyond
// `most_direct` rows, and with the band, by GMRES [Saad86], whose matrix is the identity and a compact rest, which takes few
// iterations. E = F^T where B and D are symmetric. Some of the m are only there because they may come to be touched: E, F and D
// have rows for the others, "the rows", and equations are solved for these.
//
// A Newton iteration solves with the same I + W D many times, and mostly for sums of what it has solved for before: residual,
// direction, corrections, the next trial. So solutions are kept, and only what is left of a right side is solved for anew
// [Fischer98].
//
// [Saad86] Saad, Schultz: GMRES. SIAM J. Sci. Stat. Comput. 7(3), 1986. doi:10.1137/0907058
// [Fischer98] Fischer: Projection techniques for iterative solution of Ax = b with successive right-hand sides. Comput. Methods
// Appl. Mech. Eng. 163, 1998. doi:10.1016/S0045-7825(98)00012-7

#include "math/small_dense.h"
#include "math/sparse_rows.h"

#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace seldinger {

/// Solutions of equations with one matrix, A u_k = b_k with orthonormal b_k.
class KnownSolutions {
public:
    void clear() { count_ = 0; }
    [[nodiscard]] bool empty() const { return count_ == 0; }
    /// Of all their sums the u whose A u is nearest to b.
    void combine(std::span<const double> b, std::span<double> u) const;
    /// One more, A u = b, unless there is no room or it says nothing new.
    /// @param error  |A u - b| / |b|. What is new of b is divided by its size, and with it the error: a tenth of it at most may
    /// be error, else sums with it would have to be solved for again
    void add(std::span<const double> u, std::span<const double> b, double error);

private:
    static constexpr std::size_t most = 16;
    [[nodiscard]] std::span<double> one(std::vector<double>& list, std::size_t k, std::size_t size)
    {
        return std::span(list).subspan(k * size, size);
    }
    [[nodiscard]] std::span<const double> one(const std::vector<double>& list, std::size_t k, std::size_t size) const
    {
        return std::span(list).subspan(k * size, size);
    }

    std::size_t count_ = 0;
    std::vector<double> u_, b_;  // [count][size]
};

class Condensed {
public:
    void clear() { reset(0, {}); }
    /// Whether nothing joins the m with x.
    [[nodiscard]] bool empty() const { return places_.empty(); }
    [[nodiscard]] std::size_t row_count() const { return places_.size(); }

    // ---- made row by row ----
    /// m unknowns; no rows yet. @param compliance  W [m][m], row by row; kept as a view
    void reset(int size, std::span<const double> compliance);
    /// The next row of E^T, F and D, empty, of this one of the m; in rising order.
    void begin_row(int place);
    /// @param e_transposed, f  unknowns of the band  @param d  unknowns: places among the m that have rows of their own
    SparseRows e_transposed, f, d;
    [[nodiscard]] int place(std::size_t row) const { return places_[row]; }
    /// All rows are there.
    void close();

    /// The same with the band's unknowns counted from another place.
    void take(const Condensed& other, int shift);

    // ---- the whole, by x alone ----
    /// y -= E (I + W D)^-1 W F x: what the m unknowns take off a product with B.
    void add_product(std::span<const double> x, std::span<double> y) const;
    /// y -= x_j times column j of E (I + W D)^-1 W F
    void add_column(int j, double x_j, std::span<double> y) const;
    /// x = A^-1 r in place. @param band  x <- B^-1 x in place  @param fixed  [n] unknowns that are prescribed: E and F have
    /// nothing there. @return iterations of GMRES
    int solve(std::span<double> r_to_x, std::span<const unsigned char> fixed,
              const std::function<void(std::span<double>)>& band) const;
    double accuracy = 1e-5;  // of x: |what is left of the others' equations| over their right side
    /// Likewise of solve_rows() and add_product(). From 1e-8 on, W between many rows is kept in single precision for them:
    /// products take as long as it takes to be read.
    double own_accuracy = 1e-11;

    // ---- parts, for those who keep u ----
    /// W v, [m]; v is mostly zeros.
    void times_w(std::span<const double> v, std::span<double> wv) const;
    /// W of something at the rows, [rows] -> [m].
    void times_w_of_rows(std::span<const double> at_rows, std::span<double> wv) const;
    /// What of [m] belongs to the rows.
    void at_rows(std::span<const double> all, std::span<double> rows) const;
    /// u = (I + W D)^-1 b in place, [rows].
    void solve_rows(std::span<double> u) const { solve_rows(u, own_accuracy); }
    /// The same for all [m], to 1e-6: where u may be, for those who then ask what is left.
    void guess_own(std::span<double> u) const;

private:
    static constexpr std::size_t most_direct = 120;
    void factor_own() const;
    /// out = W between rows times v
    void times_w_rows(std::span<const double> v, std::span<double> out) const;
    void solve_rows(std::span<double> u, double to) const;
    void own_product(std::span<const double> u, std::span<double> out) const;
    void take_off(std::span<double> fx_to_u, std::span<double> y) const;

    int size_ = 0;
    std::span<const double> w_;
    std::vector<int> places_;     // [rows] among the m
    std::vector<int> row_of_;     // [m] or -1
    std::vector<double> w_rows_;  // W between rows
    std::vector<float> w_single_;  // in its place
    mutable SmallLu own_;         // of (I + W D)^T
    mutable bool factored_ = false;
    std::shared_ptr<KnownSolutions> known_;  // beyond most_direct; shared with those that have taken this
};

}  // namespace seldinger
