// Factors and solutions of a band with columns.

#include "math/banded_solver.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace seldinger {

namespace {

constexpr double good_residual = 1e-13;  // of the right side: no refinement needed

double norm_of(std::span<const double> v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), v.size()).norm(); }

}  // namespace

void BandedSolver::reset(int size)
{
    band.reset(size);
    columns.clear();
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
    if (!columns.empty()) columns.add_column(j, x_j, y);
}

int BandedSolver::factor_symmetric()
{
    unsymmetric_ = false;
    const int raised = band.factor_ldlt();
    exact_ = raised == 0;
    if (columns.empty()) return raised;
    factor_columns();
    const int negative = negative_eigenvalues();
    if (negative > 0) project_columns();
    return raised + negative;
}

int BandedSolver::factor_unsymmetric()
{
    unsymmetric_ = exact_ = true;
    if (!band.factor_lu()) return band.size();
    if (columns.empty()) return band.negative_pivots();
    factor_columns();
    return band.negative_pivots() + negative_eigenvalues();
}

/// Z = A^-1 U and the factors of S.
void BandedSolver::factor_columns()
{
    const int size = band.size(), rank = columns.rank();
    free_ = columns;
    free_.drop_rows({fixed_.data(), static_cast<std::size_t>(size)});
    c_ = free_.c();
    z_ = Eigen::MatrixXd::Zero(size, rank);
    for (int k = 0; k < rank; ++k) {
        const std::span<double> column(z_.col(k).data(), size);
        free_.from_u(Eigen::VectorXd::Unit(rank, k), column);
        solve_band(column);
    }
    Eigen::MatrixXd s = Eigen::MatrixXd::Identity(rank, rank);
    for (int k = 0; k < rank; ++k) s.col(k) += c_ * free_.onto_v({z_.col(k).data(), static_cast<std::size_t>(size)});
    small_.compute(s);
}

int BandedSolver::negative_eigenvalues() const
{
    const auto values = Eigen::EigenSolver<Eigen::MatrixXd>(small_.reconstructedMatrix(), false).eigenvalues();
    int count = 0;
    for (int k = 0; k < values.size(); ++k) count += values[k].real() < 0;
    return count;
}

/// A + U C U^T is positive definite where A and C are.
void BandedSolver::project_columns()
{
    exact_ = false;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(0.5 * (c_ + c_.transpose()));
    c_ = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() * modes.eigenvectors().transpose();
    Eigen::MatrixXd s = Eigen::MatrixXd::Identity(c_.rows(), c_.cols());
    for (int k = 0; k < c_.cols(); ++k) s.col(k) += c_ * free_.onto_v({z_.col(k).data(), static_cast<std::size_t>(z_.rows())});
    small_.compute(s);
}

void BandedSolver::solve_band(std::span<double> rhs_to_x)
{
    if (unsymmetric_) band.solve_lu(rhs_to_x);
    else band.solve_ldlt(rhs_to_x);
}

void BandedSolver::solve_whole(std::span<double> rhs_to_x)
{
    solve_band(rhs_to_x);
    const Eigen::VectorXd z = small_.solve(c_ * free_.onto_v(rhs_to_x));
    Eigen::Map<Eigen::VectorXd>(rhs_to_x.data(), band.size()) -= z_ * z;
}

/// r = b - A x into r_. @return |r|/|b|
double BandedSolver::residual_of(std::span<const double> b, std::span<const double> x)
{
    r_.resize(b.size());
    band.multiply(x, r_);
    free_.add_product(x, r_);
    for (std::size_t i = 0; i < b.size(); ++i) r_[i] = b[i] - r_[i];
    const double size = norm_of(b);
    return size > 0 ? norm_of(r_) / size : 0.0;
}

void BandedSolver::solve(std::span<double> rhs_to_x)
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
