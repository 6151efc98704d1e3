// Factors and solutions of a band with entries far from it, and of what is condensed beside it.
#include "math/banded_solver.h"

#include "math/node_factors.h"

#include <algorithm>

namespace seldinger {

BandedSolver::BandedSolver(int max_size) : band(max_size), fixed_(max_size) {}

BandedSolver::~BandedSolver() = default;

void BandedSolver::reset(int size)
{
    band.reset(size);
    far.clear();
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
    condensed.add_column(j, x_j, y);
}

void BandedSolver::set_fourth(bool takes_part)
{
    fourth_ = takes_part;
    band.set_fourth(takes_part);
}

int BandedSolver::factor_symmetric()
{
    unsymmetric_ = false;
    with_far_ = !far.empty();
    if (!with_far_) return band.factor_ldlt();
    if (!node_factors_) node_factors_ = std::make_unique<NodeFactors>();
    return node_factors_->factor_ldlt(band, far, fixed_, order_, fourth_);
}

int BandedSolver::factor_unsymmetric()
{
    unsymmetric_ = true;
    with_far_ = !far.empty();
    if (with_far_ && !node_factors_) node_factors_ = std::make_unique<NodeFactors>();
    if (!(with_far_ ? node_factors_->factor_lu(band, far, fixed_, order_, fourth_) : band.factor_lu())) return band.size();
    return with_far_ ? node_factors_->negative_pivots() : band.negative_pivots();
}

void BandedSolver::solve_band(std::span<double> rhs_to_x)
{
    if (with_far_) unsymmetric_ ? node_factors_->solve_lu(rhs_to_x) : node_factors_->solve_ldlt(rhs_to_x);
    else unsymmetric_ ? band.solve_lu(rhs_to_x) : band.solve_ldlt(rhs_to_x);
}

void BandedSolver::solve(std::span<double> rhs_to_x)
{
    if (condensed.empty()) return solve_band(rhs_to_x);
    const std::size_t size = static_cast<std::size_t>(band.size());
    (void)condensed.solve(rhs_to_x.first(size), {fixed_.data(), size}, [this](std::span<double> x) { solve_band(x); });
}

}  // namespace seldinger
