// Factors and solutions of a band with columns.

#include "math/banded_solver.h"

#include "math/node_factors.h"
#include "math/small_dense.h"

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double good_residual = 1e-13;  // of the right side: no refinement needed

double norm_of(std::span<const double> v)
{
    double squares = 0;
    for (const double x : v) squares += x * x;
    return std::sqrt(squares);
}

}  // namespace

struct BandedSolver::Woodbury {
    LowRank free;           // the columns with the rows of prescribed unknowns left out
    SmallMatrix c;          // as it is solved with
    std::vector<double> z;  // [rank][size] Z = A^-1 U
    SmallMatrix vz;         // V^T Z
    SmallLu lu;             // of S
    int size = 0;

    [[nodiscard]] int rank() const { return free.rank(); }
    [[nodiscard]] std::span<double> column(int k) { return std::span(z).subspan(std::size_t(k) * size, size); }
    void times_c(std::span<const double> in, std::span<double> out) const
    {
        for (int k = 0; k < rank(); ++k) {
            out[k] = 0;
            for (int l = 0; l < rank(); ++l) out[k] += c(k, l) * in[l];
        }
    }
    void factor_small();
    [[nodiscard]] int negative_eigenvalues() const;
    void project();
};

/// S = I + C V^T Z
void BandedSolver::Woodbury::factor_small()
{
    SmallMatrix s(rank());
    for (int k = 0; k < rank(); ++k)
        for (int l = 0; l < rank(); ++l) {
            s(k, l) = k == l;
            for (int m = 0; m < rank(); ++m) s(k, l) += c(k, m) * vz(m, l);
        }
    lu.factor(s);
}

/// Negative eigenvalues of the whole matrix, A being positive definite. U = V: with U^T A^-1 U = L L^T those of I + L^T C L
/// (symmetric parts, where they are not symmetric). Else the determinant tells whether their number is odd.
int BandedSolver::Woodbury::negative_eigenvalues() const
{
    if (!free.same_sides()) return lu.sign() < 0 ? 1 : 0;
    const int n = rank();
    SmallMatrix g(n), m(n);
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) g(k, l) = 0.5 * (vz(k, l) + vz(l, k));
    const SmallMatrix root = small_cholesky(g);
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) {
            m(k, l) = k == l;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) m(k, l) += root(i, k) * 0.5 * (c(i, j) + c(j, i)) * root(j, l);
        }
    const SmallModes modes(m);
    return static_cast<int>(std::count_if(modes.values.begin(), modes.values.end(), [](double value) { return value < 0; }));
}

/// A + U C U^T is positive definite where A is and C is positive semidefinite.
void BandedSolver::Woodbury::project()
{
    const int n = rank();
    SmallMatrix symmetric(n);
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) symmetric(k, l) = 0.5 * (c(k, l) + c(l, k));
    const SmallModes modes(symmetric);
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l) {
            c(k, l) = 0;
            for (int m = 0; m < n; ++m)
                c(k, l) += modes.vectors(k, m) * std::max(modes.values[m], 0.0) * modes.vectors(l, m);
        }
    factor_small();
}

BandedSolver::BandedSolver(int max_size) : band(max_size), fixed_(max_size) {}

BandedSolver::~BandedSolver() = default;

void BandedSolver::reset(int size)
{
    band.reset(size);
    far.clear();
    columns.clear();
    condensed.clear();
    std::fill_n(fixed_.begin(), size, std::uint8_t{0});
}

void BandedSolver::fix(int i)
{
    band.fix(i);
    fixed_[i] = 1;
}

void BandedSolver::add_column(int j, double x_j, std::span<double> y) const
{
    band.add_column(j, x_j, y);
    if (!far.empty()) far.add_column(j, x_j, y);
    if (!columns.empty()) columns.add_column(j, x_j, y);
    condensed.add_column(j, x_j, y);
}

void BandedSolver::set_fourth(bool takes_part)
{
    fourth_ = takes_part;
    band.set_fourth(takes_part);
}

/// LDL^T of band and far entries. @return pivots raised
int BandedSolver::factor_band_symmetric()
{
    with_far_ = !far.empty();
    if (!with_far_) return band.factor_ldlt();
    if (!node_factors_) node_factors_ = std::make_unique<NodeFactors>();
    return node_factors_->factor_ldlt(band, far, fixed_, order_, fourth_);
}

/// @return false where a pivot vanishes
bool BandedSolver::factor_band_unsymmetric()
{
    with_far_ = !far.empty();
    if (!with_far_) return band.factor_lu();
    if (!node_factors_) node_factors_ = std::make_unique<NodeFactors>();
    return node_factors_->factor_lu(band, far, fixed_, order_, fourth_);
}

int BandedSolver::negative_pivots() const { return with_far_ ? node_factors_->negative_pivots() : band.negative_pivots(); }

int BandedSolver::factor_symmetric()
{
    unsymmetric_ = false;
    const int raised = factor_band_symmetric();
    exact_ = raised == 0;
    if (columns.empty()) return raised;
    factor_columns();
    const int negative = woodbury_->negative_eigenvalues();
    if (negative > 0) {
        exact_ = false;
        woodbury_->project();
    }
    return raised + negative;
}

int BandedSolver::factor_unsymmetric()
{
    unsymmetric_ = exact_ = true;
    if (!factor_band_unsymmetric()) return band.size();
    if (columns.empty()) return negative_pivots();
    factor_columns();
    return negative_pivots() + woodbury_->negative_eigenvalues();
}

/// Z = A^-1 U and the factors of S.
void BandedSolver::factor_columns()
{
    if (!woodbury_) woodbury_ = std::make_unique<Woodbury>();
    Woodbury& w = *woodbury_;
    const int rank = columns.rank();
    w.size = band.size();
    w.free = columns;
    w.free.drop_rows({fixed_.data(), static_cast<std::size_t>(w.size)});
    w.c = w.vz = SmallMatrix(rank);
    w.z.assign(static_cast<std::size_t>(rank) * w.size, 0.0);
    std::vector<double> onto(static_cast<std::size_t>(rank));
    for (int l = 0; l < rank; ++l) {
        for (const auto& [unknown, value] : w.free.u(l)) w.column(l)[unknown] += value;
        solve_band(w.column(l));
        w.free.onto_v(w.column(l), onto);
        for (int k = 0; k < rank; ++k) {
            w.vz(k, l) = onto[k];
            w.c(k, l) = columns.c(k, l);
        }
    }
    w.factor_small();
}

void BandedSolver::solve_band(std::span<double> rhs_to_x)
{
    if (with_far_) unsymmetric_ ? node_factors_->solve_lu(rhs_to_x) : node_factors_->solve_ldlt(rhs_to_x);
    else unsymmetric_ ? band.solve_lu(rhs_to_x) : band.solve_ldlt(rhs_to_x);
}

void BandedSolver::solve_whole(std::span<double> rhs_to_x)
{
    solve_band(rhs_to_x);
    Woodbury& w = *woodbury_;
    std::vector<double> onto(static_cast<std::size_t>(w.rank())), share(onto.size());
    w.free.onto_v(rhs_to_x, onto);
    w.times_c(onto, share);
    w.lu.solve(share);
    for (int k = 0; k < w.rank(); ++k)
        for (int i = 0; i < w.size; ++i) rhs_to_x[i] -= w.column(k)[i] * share[k];
}

/// r = b - A x into r_. @return |r|/|b|
double BandedSolver::residual_of(std::span<const double> b, std::span<const double> x)
{
    r_.resize(b.size());
    band.multiply(x, r_);
    if (!far.empty()) far.add_product(x, r_, fixed_);
    woodbury_->free.add_product(x, r_);
    for (std::size_t i = 0; i < b.size(); ++i) r_[i] = b[i] - r_[i];
    const double size = norm_of(b);
    return size > 0 ? norm_of(r_) / size : 0.0;
}

void BandedSolver::solve(std::span<double> rhs_to_x)
{
    if (condensed.empty()) return solve_with_columns(rhs_to_x);
    const std::size_t size = static_cast<std::size_t>(band.size());
    (void)condensed.solve(rhs_to_x.first(size), {fixed_.data(), size}, [this](std::span<double> x) { solve_with_columns(x); });
}

void BandedSolver::solve_with_columns(std::span<double> rhs_to_x)
{
    if (columns.empty()) return solve_band(rhs_to_x);
    const std::span<double> x = rhs_to_x.first(static_cast<std::size_t>(band.size()));
    b_.assign(x.begin(), x.end());
    solve_whole(x);
    if (!exact_) return;  // factors of another matrix, whose residual says nothing
    last_residual_ = residual_of(b_, x);
    if (last_residual_ <= good_residual) return;
    std::vector<double> refined(x.begin(), x.end());
    solve_whole(r_);
    for (std::size_t i = 0; i < x.size(); ++i) refined[i] += r_[i];
    const double residual = residual_of(b_, refined);
    if (!(residual < last_residual_)) return;
    last_residual_ = residual;
    std::copy(refined.begin(), refined.end(), x.begin());
}

}  // namespace seldinger
