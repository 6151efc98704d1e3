// A solver without far entries (test_node_factors.cpp has those with) is its band.
#include "math/banded_solver.h"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace seldinger::test::test_banded_solver {

using Eigen::VectorXd;

namespace {

constexpr int nodes = 14, size = RodDofs::count(nodes);

/// Random symmetric band, diagonally dominant by `margin`.
void fill_band(BandMatrix& band, std::mt19937& rng, double margin, bool symmetric = true)
{
    std::uniform_real_distribution<double> entry(-1, 1);
    for (int i = 0; i < size; ++i)
        for (int j = i; j <= std::min(size - 1, i + BandRows::half_bandwidth); ++j) {
            if (RodDofs::node(j) - RodDofs::node(i) > RodDofs::reach) continue;
            const double value = entry(rng);
            band.add(i, j, value);
            if (j > i) band.add(j, i, symmetric ? value : entry(rng));
            if (j > i) band.add(i, i, std::abs(value)), band.add(j, j, std::abs(value));
            if (j == i) band.add(i, i, 1 + margin);
        }
}

VectorXd any_vector()
{
    VectorXd b(size);
    for (int i = 0; i < size; ++i) b[i] = std::sin(1.3 * i + 0.2);
    return b;
}

VectorXd solved(BandedSolver& solver, const VectorXd& b)
{
    std::vector<double> x(b.data(), b.data() + size);
    solver.solve(x);
    return Eigen::Map<VectorXd>(x.data(), size);
}

}  // namespace

TEST_SUITE("math/banded_solver")
{
    TEST_CASE("property: without far entries it is the band's own factors, bit for bit")
    {
        std::mt19937 rng(1);
        BandedSolver solver(size);
        solver.reset(size);
        fill_band(solver.band, rng, 0.1);
        BandMatrix alone(size);
        alone.reset(size);
        alone.add_scaled(solver.band, 1);
        CHECK(solver.factor_symmetric() == alone.factor_ldlt());
        const VectorXd b = any_vector(), x = solved(solver, b);
        std::vector<double> y(b.data(), b.data() + size);
        alone.solve_ldlt(y);
        for (int i = 0; i < size; ++i) CHECK(x[i] == y[i]);
    }
}

}  // namespace seldinger::test::test_banded_solver
