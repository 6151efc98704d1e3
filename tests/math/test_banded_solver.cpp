// Band and columns against dense matrices.
#include "math/banded_solver.h"
#include "support/approx.h"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace test_banded_solver {

using namespace seldinger;
using Eigen::MatrixXd;
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

MatrixXd dense(const BandMatrix& band)
{
    MatrixXd a = MatrixXd::Zero(size, size);
    for (int i = 0; i < size; ++i)
        for (int j = std::max(0, i - BandRows::half_bandwidth); j <= std::min(size - 1, i + BandRows::half_bandwidth); ++j)
            a(i, j) = band.at(i, j);
    return a;
}

using Columns = std::vector<LowRank::Column>;

/// A spring between nodes a and b: one column for each coordinate.
Columns between(int a, int b)
{
    Columns columns;
    for (int c = 0; c < RodDofs::coordinates; ++c)
        columns.push_back({{RodDofs::position(a, c), 1.0}, {RodDofs::position(b, c), -1.0}});
    return columns;
}

/// For a symmetric or unsymmetric C, row by row.
std::vector<double> rows_of(const MatrixXd& c)
{
    std::vector<double> rows;
    for (int k = 0; k < c.rows(); ++k)
        for (int l = 0; l < c.cols(); ++l) rows.push_back(c(k, l));
    return rows;
}

MatrixXd dense(const Columns& columns)
{
    MatrixXd u = MatrixXd::Zero(size, static_cast<int>(columns.size()));
    for (std::size_t k = 0; k < columns.size(); ++k)
        for (const auto& [unknown, value] : columns[k]) u(unknown, static_cast<int>(k)) += value;
    return u;
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

int negative_eigenvalues(const MatrixXd& a)
{
    return static_cast<int>((Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues().array() < 0).count());
}

}  // namespace

TEST_SUITE("math/banded_solver")
{
    TEST_CASE("property: without columns it is the band's own factors, bit for bit")
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

    // errors: eps times the condition of the system, at most a few hundred here
    TEST_CASE("analytic: far nodes joined by springs, against the dense matrix")
    {
        std::mt19937 rng(2);
        BandedSolver solver(size);
        solver.reset(size);
        fill_band(solver.band, rng, 0.1);
        MatrixXd stiffness(3, 3);
        stiffness << 50, 3, 1, 3, 40, 2, 1, 2, 70;
        const Columns near = between(0, 13), far = between(2, 9);
        solver.columns.add(near, rows_of(stiffness));
        solver.columns.add(far, rows_of(1e4 * stiffness));
        CHECK(solver.factor_symmetric() == 0);
        const MatrixXd a = dense(solver.band) + dense(near) * stiffness * dense(near).transpose() +
                           1e4 * dense(far) * stiffness * dense(far).transpose();
        const VectorXd b = any_vector();
        const VectorXd exact = a.ldlt().solve(b);
        CHECK((solved(solver, b) - exact).norm() < 1e-11 * exact.norm());
    }

    TEST_CASE("analytic: unsymmetric columns and band, against the dense matrix")
    {
        std::mt19937 rng(3);
        BandedSolver solver(size);
        solver.reset(size);
        fill_band(solver.band, rng, 2, false);
        MatrixXd c(3, 3);
        c << 0, 5, 1, -4, 0, 2, 7, 1, 0;  // neither symmetric nor definite
        const Columns u = between(1, 12), v = between(3, 8);
        solver.columns.add(u, rows_of(c), v);
        CHECK(solver.factor_unsymmetric() < size);
        const MatrixXd a = dense(solver.band) + dense(u) * c * dense(v).transpose();
        const VectorXd b = any_vector();
        const VectorXd exact = a.partialPivLu().solve(b);
        CHECK((solved(solver, b) - exact).norm() < 1e-11 * exact.norm());
    }

    TEST_CASE("analytic: an indefinite C is solved with as it is while the whole is positive definite, and counted where it is not")
    {
        for (const double weakest : {-0.2, -30.0}) {
            CAPTURE(weakest);
            std::mt19937 rng(4);
            BandedSolver solver(size);
            solver.reset(size);
            fill_band(solver.band, rng, 0.1);
            MatrixXd c = MatrixXd::Zero(3, 3);
            c.diagonal() << weakest, 20, 1.5 * weakest;
            const Columns u = between(0, 11);
            solver.columns.add(u, rows_of(c));
            const MatrixXd a = dense(solver.band), low = dense(u);
            const int negative = negative_eigenvalues(a + low * c * low.transpose());
            REQUIRE(negative == (weakest < -1 ? 2 : 0));
            CHECK(solver.factor_symmetric() == negative);
            if (negative > 0) c = c.cwiseMax(0);  // what is solved with is positive definite
            const VectorXd b = any_vector();
            const VectorXd exact = (a + low * c * low.transpose()).ldlt().solve(b);
            CHECK((solved(solver, b) - exact).norm() < 1e-11 * exact.norm());
            if (negative == 0) continue;
            c(0, 0) = weakest, c(2, 2) = 1.5 * weakest;
            CHECK(solver.factor_unsymmetric() == negative);  // the whole, by LU
            const VectorXd whole = (a + low * c * low.transpose()).partialPivLu().solve(b);
            CHECK((solved(solver, b) - whole).norm() < 1e-11 * whole.norm());
        }
    }

    // The band is a chain that nothing but 1e-10 holds: its inverse is 1e10 large, and eps times that, 1e-6 of the solution, is what
    // Woodbury alone leaves. One refinement squares it.
    TEST_CASE("regression: a nearly singular band that a column holds is solved to the precision of the whole")
    {
        BandedSolver solver(size);
        solver.reset(size);
        for (int i = 0; i < size; ++i) {
            solver.band.add(i, i, 1e-10);
            const int j = i + RodDofs::per_node;
            if (j >= size) continue;
            solver.band.add(i, i, 1), solver.band.add(j, j, 1);
            solver.band.add(i, j, -1), solver.band.add(j, i, -1);
        }
        Columns anchors;
        for (int c = 0; c < RodDofs::per_node; ++c) anchors.push_back({{c, 1.0}});
        const MatrixXd stiffness = 2 * MatrixXd::Identity(RodDofs::per_node, RodDofs::per_node);
        solver.columns.add(anchors, rows_of(stiffness));
        REQUIRE(solver.factor_symmetric() == 0);
        const MatrixXd a = dense(solver.band) + dense(anchors) * stiffness * dense(anchors).transpose();
        const VectorXd b = any_vector();
        const VectorXd exact = a.ldlt().solve(b);
        CHECK((solved(solver, b) - exact).norm() < 1e-10 * exact.norm());
        CHECK(solver.last_residual() < 1e-11);
    }

    TEST_CASE("property: a prescribed unknown keeps its value, and loads the others through columns too")
    {
        std::mt19937 rng(5);
        BandedSolver solver(size);
        solver.reset(size);
        fill_band(solver.band, rng, 0.1);
        const MatrixXd stiffness = 30 * MatrixXd::Identity(3, 3);
        const Columns u = between(0, 13);
        solver.columns.add(u, rows_of(stiffness));
        const MatrixXd a = dense(solver.band) + dense(u) * stiffness * dense(u).transpose();
        const int held = RodDofs::position(13, 1);
        const double value = 0.7;
        VectorXd b = any_vector();
        std::vector<double> load(size, 0.0);
        solver.add_column(held, value, load);
        for (int i = 0; i < size; ++i) CHECK(load[i] == test::about(a(i, held) * value).epsilon(1e-13));
        solver.fix(held);
        CHECK(solver.factor_symmetric() == 0);
        VectorXd rhs = b;
        for (int i = 0; i < size; ++i) rhs[i] = i == held ? value : b[i] - load[i];
        const VectorXd x = solved(solver, rhs);
        CHECK(x[held] == value);
        VectorXd left = a * x - b;
        left[held] = 0;
        CHECK(left.norm() < 1e-12 * (a.norm() * x.norm()));
    }
}

}  // namespace test_banded_solver
