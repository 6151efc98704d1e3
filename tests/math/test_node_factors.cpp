// Factors of a band with entries far from it, against dense matrices, and without them, against the band alone.
#include "math/banded_solver.h"
#include "math/node_factors.h"

#include <doctest/doctest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace seldinger::test::test_node_factors {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int rod_nodes = 15, nodes = 2 * rod_nodes, size = RodDofs::count(nodes);

struct Entries {
    std::mt19937 rng;
    bool symmetric;
    double operator()() { return std::uniform_real_distribution<double>(-1, 1)(rng); }
};

/// Two rods one after the other, symmetric and diagonally dominant by `margin` but for the upper half where not symmetric.
void fill_band(BandMatrix& band, Entries& entry, double margin)
{
    for (int i = 0; i < size; ++i) {
        band.add(i, i, 1 + margin);
        for (int j = i + 1; j <= std::min(size - 1, i + BandRows::half_bandwidth); ++j) {
            const int a = RodDofs::node(i), b = RodDofs::node(j);
            if (b - a > RodDofs::reach || a / rod_nodes != b / rod_nodes) continue;
            const double value = entry(), other = entry.symmetric ? value : entry();
            band.add(i, j, value), band.add(j, i, other);
            band.add(i, i, std::abs(value)), band.add(j, j, std::abs(value));
        }
    }
}

/// Each node of the first rod with two of the second one, and a crossing of the far ends.
void fill_far(BandedSolver& solver, Entries& entry, double scale = 1)
{
    const auto couple = [&](int a, int b) {
        for (int r = 0; r < RodDofs::per_node; ++r)
            for (int c = 0; c < RodDofs::per_node; ++c) {
                const int i = RodDofs::position(a) + r, j = RodDofs::position(b) + c;
                const double value = scale * entry(), other = entry.symmetric ? value : scale * entry();
                solver.far.add(i, j, value), solver.far.add(j, i, other);
                solver.band.add(i, i, std::abs(value)), solver.band.add(j, j, std::abs(other));
            }
    };
    for (int a = 0; a < rod_nodes; ++a)
        for (int b = a; b < std::min(a + 2, rod_nodes); ++b) couple(a, rod_nodes + b);
    couple(1, rod_nodes - 2);
}

MatrixXd dense(const BandedSolver& solver)
{
    MatrixXd a = MatrixXd::Zero(size, size);
    for (int i = 0; i < size; ++i)
        for (int j = std::max(0, i - BandRows::half_bandwidth); j <= std::min(size - 1, i + BandRows::half_bandwidth); ++j)
            a(i, j) = solver.band.at(i, j);
    for (const FarEntries::Block& block : solver.far.blocks())
        for (int r = 0; r < FarEntries::width; ++r)
            for (int c = 0; c < FarEntries::width; ++c) a(4 * block.row + r, 4 * block.col + c) += block.value[r][c];
    return a;
}

/// Row and column become the unit's.
void fix(MatrixXd& a, int i)
{
    a.row(i).setZero();
    a.col(i).setZero();
    a(i, i) = 1;
}

std::vector<int> in_turn()
{
    std::vector<int> order;
    for (int a = 0; a < rod_nodes; ++a) order.insert(order.end(), {a, rod_nodes + a});
    return order;
}

std::vector<int> any_order()
{
    std::vector<int> order(nodes);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    return order;
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

double miss(const VectorXd& x, const VectorXd& exact) { return (x - exact).norm() / exact.norm(); }

struct Filled : BandedSolver {
    Filled(Entries entry, double margin) : BandedSolver(size)
    {
        reset(size);
        fill_band(band, entry, margin);
        fill_far(*this, entry);
    }
};

// errors: eps times the condition of these matrices, at most a few hundred
constexpr double tolerance = 1e-12;

}  // namespace

TEST_SUITE("math/node_factors")
{
    TEST_CASE("analytic: two rods joined all along, in any order of elimination, against the dense matrix")
    {
        for (const std::vector<int>& order : {std::vector<int>{}, in_turn(), any_order()}) {
            Filled solver({std::mt19937(1), true}, 0.1);
            solver.set_order(order);
            const MatrixXd a = dense(solver);
            const VectorXd b = any_vector();
            CHECK(solver.factor_symmetric() == 0);
            CHECK(miss(solved(solver, b), a.ldlt().solve(b)) < tolerance);
            CHECK(solver.factor_unsymmetric() == 0);
            CHECK(miss(solved(solver, b), a.ldlt().solve(b)) < tolerance);
        }
    }

    TEST_CASE("analytic: the unsymmetric matrix by LU, and the number of its negative pivots")
    {
        for (const std::vector<int>& order : {in_turn(), any_order()}) {
            Filled solver({std::mt19937(2), false}, 1);
            solver.set_order(order);
            const MatrixXd a = dense(solver);
            const VectorXd b = any_vector();
            CHECK(solver.factor_unsymmetric() == 0);
            CHECK(miss(solved(solver, b), a.partialPivLu().solve(b)) < tolerance);
        }
        // symmetric: as many as there are negative eigenvalues (Sylvester); without pivoting growth may cost some digits
        Filled solver({std::mt19937(3), true}, 0.1);
        solver.set_order(in_turn());
        for (const int i : {4, 41, 42, 90}) solver.band.add(i, i, -60);
        const MatrixXd a = dense(solver);
        const int negative = static_cast<int>((Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues().array() < 0).count());
        REQUIRE(negative == 4);
        CHECK(solver.factor_unsymmetric() == negative);
        CHECK(miss(solved(solver, any_vector()), a.partialPivLu().solve(any_vector())) < 1e-10);
        // LDL^T raises as many at least, and its factor is positive definite
        CHECK(solver.factor_symmetric() >= negative);
        CHECK(any_vector().dot(solved(solver, any_vector())) > 0);
        // a zero row: no factors
        for (int j = 0; j < BandRows::row_width; ++j) solver.band.row(20)[j] = 0;
        solver.far.clear();
        solver.far.add(0, 60, 0.0);
        CHECK(solver.factor_unsymmetric() == size);
    }

    TEST_CASE("property: an unknown that is prescribed keeps its value, and far products know it")
    {
        Filled solver({std::mt19937(4), false}, 1);
        solver.set_order(in_turn());
        MatrixXd a = dense(solver);
        const VectorXd b = any_vector();
        VectorXd product = VectorXd::Zero(size), column = VectorXd::Zero(size);
        for (int j = 0; j < size; ++j) solver.add_column(j, b[j], {product.data(), size});
        CHECK(miss(product, a * b) < tolerance);
        solver.far.add_product({b.data(), size}, {column.data(), size});
        std::vector<double> of_band(size);
        solver.band.multiply({b.data(), size}, of_band);
        CHECK(miss(column + Eigen::Map<VectorXd>(of_band.data(), size), a * b) < tolerance);
        for (const int i : {0, 13, 64, 119}) solver.fix(i), fix(a, i);
        CHECK(solver.factor_unsymmetric() == 0);
        const VectorXd x = solved(solver, b);
        CHECK(miss(x, a.partialPivLu().solve(b)) < tolerance);
        for (const int i : {0, 13, 64, 119}) CHECK(x[i] == b[i]);
    }

    TEST_CASE("property: without the fourth unknowns")
    {
        for (const bool symmetric : {true, false}) {
            Filled solver({std::mt19937(5), symmetric}, 1);
            solver.set_order(any_order());
            solver.set_fourth(false);
            MatrixXd a = dense(solver);
            VectorXd b = any_vector();
            for (int node = 0; node < nodes; ++node) {
                fix(a, RodDofs::spin(node));
                b[RodDofs::spin(node)] = 0;
            }
            CHECK((symmetric ? solver.factor_symmetric() : solver.factor_unsymmetric()) == 0);
            CHECK(miss(solved(solver, any_vector()), a.partialPivLu().solve(b)) < tolerance);
        }
    }

    TEST_CASE("property: the pattern follows what is coupled, and the same entries give the same bits")
    {
        Filled solver({std::mt19937(8), true}, 0.1), again({std::mt19937(8), true}, 0.1);
        const std::vector<int> order = in_turn();
        solver.set_order(order), again.set_order(order);
        CHECK(again.factor_symmetric() == 0);
        const VectorXd x = solved(again, any_vector());
        // another pattern first, then the first one
        again.reset(size);
        Entries entry{std::mt19937(9), true};
        fill_band(again.band, entry, 0.1);
        again.far.add(0, 100, 0.1), again.far.add(100, 0, 0.1);
        MatrixXd a = dense(again);
        CHECK(again.factor_symmetric() == 0);
        CHECK(miss(solved(again, any_vector()), a.ldlt().solve(any_vector())) < tolerance);
        again.reset(size);
        entry = {std::mt19937(8), true};
        fill_band(again.band, entry, 0.1);
        fill_far(again, entry);
        CHECK(again.factor_symmetric() == 0);
        const VectorXd y = solved(again, any_vector());
        for (int i = 0; i < size; ++i) CHECK(x[i] == y[i]);
    }

    // two in turn reach four nodes ahead, and the eliminated ones fill no more than that; one after the other, the second rod's
    // nodes stay coupled with all that the first one has left
    TEST_CASE("property: nodes in turn fill a narrow strip, one rod after the other nearly everything")
    {
        NodeFactors turn, row;
        BandedSolver solver(size);
        solver.reset(size);
        Entries entry{std::mt19937(10), true};
        fill_band(solver.band, entry, 0.1);
        for (int a = 0; a < rod_nodes; ++a)
            for (const int b : {a, std::min(a + 1, rod_nodes - 1)})
                solver.far.add(4 * a, 4 * (rod_nodes + b), 0.01), solver.far.add(4 * (rod_nodes + b), 4 * a, 0.01);
        const std::vector<unsigned char> fixed(size, 0);
        CHECK(turn.factor_ldlt(solver.band, solver.far, fixed, in_turn(), true) == 0);
        std::vector<int> as_they_lie(nodes);
        std::iota(as_they_lie.begin(), as_they_lie.end(), 0);
        CHECK(row.factor_ldlt(solver.band, solver.far, fixed, as_they_lie, true) == 0);
        CHECK(turn.block_count() <= 4 * nodes);
        CHECK(row.block_count() > 1.5 * turn.block_count());
    }

    // a coil: each place where strands touch couples nodes 40 apart. As they lie, the nodes between keep a column of each such
    // place
    TEST_CASE("property: without a given order a rod that touches itself fills less than as its nodes lie, and is solved as well")
    {
        constexpr int coil = 120, count = RodDofs::count(coil);
        BandedSolver solver(count);
        solver.reset(count);
        Entries entry{std::mt19937(11), false};
        MatrixXd a = MatrixXd::Zero(count, count);
        const auto add = [&](auto& to, int i, int j, double value) { to.add(i, j, value), a(i, j) += value; };
        for (int i = 0; i < count; ++i) {
            add(solver.band, i, i, 20);  // 19 entries of up to 1 in a row
            for (int j = std::max(0, i - 8); j <= std::min(count - 1, i + 8); ++j)
                if (j != i) add(solver.band, i, j, entry());
        }
        for (int at = 5; at <= 75; at += 5)
            for (int r = 0; r < RodDofs::per_node; ++r) {
                const int i = RodDofs::position(at) + r, j = RodDofs::position(at + 40) + r;
                add(solver.far, i, j, entry()), add(solver.far, j, i, entry());
            }
        NodeFactors chosen, row;
        const std::vector<unsigned char> fixed(count, 0);
        std::vector<int> as_they_lie(coil);
        std::iota(as_they_lie.begin(), as_they_lie.end(), 0);
        REQUIRE(chosen.factor_lu(solver.band, solver.far, fixed, {}, true));
        REQUIRE(row.factor_lu(solver.band, solver.far, fixed, as_they_lie, true));
        CHECK(row.block_count() > 1.3 * chosen.block_count());
        const VectorXd b = VectorXd::LinSpaced(count, -1, 2), expected = a.partialPivLu().solve(b);
        VectorXd x = b;
        chosen.solve_lu({x.data(), static_cast<std::size_t>(count)});
        CHECK(miss(x, expected) < tolerance);
    }

    TEST_CASE("property: without far entries it is the band's own factors, bit for bit")
    {
        BandedSolver solver(size);
        solver.reset(size);
        Entries entry{std::mt19937(1), true};
        fill_band(solver.band, entry, 0.1);
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

}  // namespace seldinger::test::test_node_factors
