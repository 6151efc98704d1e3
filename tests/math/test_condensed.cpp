// Unknowns beside the band against the dense matrix of the same system.

#include "math/banded_solver.h"
#include "support/approx.h"

#include <Eigen/Dense>

#include <random>

namespace seldinger::test::test_condensed {

namespace {

/// A band of `size` unknowns with m others beside it, and the whole as a dense matrix of x and u.
struct Coupled {
    BandedSolver solver;
    std::vector<double> w;
    Eigen::MatrixXd whole, right;

    Coupled(int size, int m, bool symmetric, unsigned seed) : solver(size), w(static_cast<std::size_t>(m) * m)
    {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> number(-1, 1);
        solver.reset(size);
        Eigen::MatrixXd b = Eigen::MatrixXd::Zero(size, size);
        for (int i = 0; i < size; ++i)
            for (int j = std::max(0, i - 3); j <= i; ++j) {
                const double value = i == j ? 8 : number(random);
                b(i, j) = value;
                if (i != j) b(j, i) = symmetric ? value : number(random);
            }
        for (int i = 0; i < size; ++i)
            for (int j = std::max(0, i - 3); j <= std::min(size - 1, i + 3); ++j) solver.band.add(i, j, b(i, j));
        Eigen::MatrixXd root(m, m), e = Eigen::MatrixXd::Zero(size, m), f = Eigen::MatrixXd::Zero(m, size),
                                    d = Eigen::MatrixXd::Zero(m, m);
        for (int k = 0; k < m * m; ++k) root.data()[k] = number(random);
        const Eigen::MatrixXd compliance = root * root.transpose();
        for (int k = 0; k < m; ++k)
            for (int l = 0; l < m; ++l) w[static_cast<std::size_t>(k * m + l)] = compliance(k, l);
        Condensed& beside = solver.condensed;
        beside.reset(m, w);
        beside.accuracy = 1e-9;
        for (int k = 0; k < m; ++k) {
            beside.begin_row(k);
            for (int c = 0; c < 2; ++c) {
                const int at = (5 * k + 3 * c) % size;
                const double value = number(random), other = symmetric ? value : number(random);
                e(at, k) += value;
                f(k, at) += other;
                beside.e_transposed.add(at, value);
                beside.f.add(at, other);
            }
            d(k, k) = 1 + std::abs(number(random));
            beside.d.add(k, d(k, k));
        }
        beside.close();
        // W (D u - F x) + u = 0
        whole = Eigen::MatrixXd::Zero(size + m, size + m);
        whole << b, -e, -compliance * f, Eigen::MatrixXd::Identity(m, m) + compliance * d;
    }
};

}  // namespace

// GMRES stops at 1e-9 of its right side; the matrices' condition is below 1e3.
TEST_CASE("a band with unknowns beside it is solved as the dense whole is")
{
    for (const bool symmetric : {true, false})
        for (const int m : {1, 3, 9}) {
            CAPTURE(symmetric);
            CAPTURE(m);
            const int size = 24;
            Coupled c(size, m, symmetric, 7u + static_cast<unsigned>(m));
            Eigen::VectorXd rhs = Eigen::VectorXd::Zero(size + m);
            for (int i = 0; i < size; ++i) rhs[i] = std::sin(1.0 + i);
            const Eigen::VectorXd expected = c.whole.partialPivLu().solve(rhs);
            std::vector<double> x(rhs.data(), rhs.data() + size);
            CHECK((symmetric ? c.solver.factor_symmetric() : c.solver.factor_unsymmetric()) == 0);
            c.solver.solve(x);
            for (int i = 0; i < size; ++i)
                CHECK(x[static_cast<std::size_t>(i)] == test::about(expected[i]).epsilon(1e-6).scale(1));

            // and the product undoes it
            std::vector<double> back(static_cast<std::size_t>(size));
            c.solver.band.multiply(x, back);
            c.solver.condensed.add_product(x, back);
            for (int i = 0; i < size; ++i)
                CHECK(back[static_cast<std::size_t>(i)] == test::about(rhs[i]).epsilon(1e-6).scale(1));
        }
}

TEST_CASE("what is prescribed loads the others through the unknowns beside the band")
{
    const int size = 24, m = 6, held = 5;
    Coupled c(size, m, true, 3u);
    const double value = 0.7;
    std::vector<double> load(static_cast<std::size_t>(size), 0.0);
    c.solver.add_column(held, value, load);
    c.solver.fix(held);
    std::vector<double> x(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) x[static_cast<std::size_t>(i)] = std::cos(2.0 * i) - load[static_cast<std::size_t>(i)];
    x[held] = value;
    CHECK(c.solver.factor_symmetric() == 0);
    c.solver.solve(x);
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(size + m);
    for (int i = 0; i < size; ++i) rhs[i] = std::cos(2.0 * i);
    rhs -= value * c.whole.col(held);
    c.whole.row(held).setZero();
    c.whole.col(held).setZero();
    c.whole(held, held) = 1;
    rhs[held] = value;
    const Eigen::VectorXd expected = c.whole.partialPivLu().solve(rhs);
    for (int i = 0; i < size; ++i) CHECK(x[static_cast<std::size_t>(i)] == test::about(expected[i]).epsilon(1e-6).scale(1));
}

// A compliance of rank one: the two others beside the band say the same.
TEST_CASE("a singular compliance is no matter")
{
    BandedSolver solver(4);
    solver.reset(4);
    for (int i = 0; i < 4; ++i) solver.band.add(i, i, 2);
    const std::vector<double> w{1, 1, 1, 1};
    solver.condensed.reset(2, w);
    for (int k = 0; k < 2; ++k) {
        solver.condensed.begin_row(k);
        for (SparseRows* rows : {&solver.condensed.e_transposed, &solver.condensed.f, &solver.condensed.d}) rows->add(k, 1.0);
    }
    solver.condensed.close();
    CHECK(solver.factor_symmetric() == 0);
    std::vector<double> x{1, 0, 0, 1};
    solver.solve(x);
    // u0 = u1 = u, u + 2 u - (x0 + x1) = 0; 2 x0 - u = 1, 2 x1 - u = 0: u = 1/4
    CHECK(x[0] == test::about(0.625));
    CHECK(x[1] == test::about(0.125));
    CHECK(x[3] == test::about(0.5));
}

// Single precision has W to 6e-8, and with it what it does: 1e-6 of the right side with a condition below 1e3 and 150 rows.
TEST_CASE("W between many rows may be kept in single precision")
{
    const int size = 24, m = 150;
    Coupled c(size, m, true, 12u);
    Condensed rounded = c.solver.condensed;
    rounded.own_accuracy = 1e-8;
    rounded.close();
    rounded.own_accuracy = 1e-11;  // GMRES itself
    const Eigen::MatrixXd own = c.whole.bottomRightCorner(m, m);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(m, -1, 2);
    const auto left_of = [&](const Condensed& beside) {
        std::vector<double> u(b.data(), b.data() + m);
        beside.solve_rows(u);
        return (own * Eigen::Map<const Eigen::VectorXd>(u.data(), m) - b).norm() / b.norm();
    };
    CHECK(left_of(c.solver.condensed) < 1e-10);
    const double left = left_of(rounded);
    CHECK(left < 1e-6);
    CHECK(left > 1e-10);  // it is rounded
}

// So many rows are solved by GMRES, to 1e-11 of the right side, and what is known is used: sums of earlier right sides and one
// that a solve of the whole has met.
TEST_CASE("solutions with one matrix that follow each other are those of the dense matrix")
{
    const int size = 24, m = 150;
    Coupled c(size, m, false, 11u);
    const Eigen::MatrixXd own = c.whole.bottomRightCorner(m, m);
    const Condensed& beside = c.solver.condensed;
    const auto check = [&](const Eigen::VectorXd& b) {
        std::vector<double> u(b.data(), b.data() + m);
        beside.solve_rows(u);
        const Eigen::Map<const Eigen::VectorXd> found(u.data(), m);
        CHECK((own * found - b).norm() < 1e-10 * b.norm());
    };
    Eigen::VectorXd first(m), second(m);
    for (int k = 0; k < m; ++k) first[k] = std::sin(1.0 + k), second[k] = std::cos(3.0 * k);
    check(first);
    check(second);
    check(first + 2 * second);
    CHECK(c.solver.factor_unsymmetric() == 0);
    std::vector<double> x(static_cast<std::size_t>(size), 1.0);
    c.solver.solve(x);
    check(c.whole.bottomLeftCorner(m, size) * Eigen::Map<const Eigen::VectorXd>(x.data(), size));
    for (int k = 0; k < 20; ++k) check(first.cwiseProduct(Eigen::VectorXd::LinSpaced(m, k, 1)));  // more than are kept
}

// Solutions of the identity, of which the second one's new part, 1e-7 of it, is smaller than its error of 1e-6. Were it kept, the
// sum for that part would be ten times as large as it.
TEST_CASE("a known solution counts only if what it adds is more than its error")
{
    const std::vector<double> first = {1, 0}, b = {1, 1e-7}, u = {1, 1e-7 + 1e-6}, asked = {0, 1};
    std::vector<double> sum(2);
    KnownSolutions known;
    known.add(first, first, 0);
    known.add(u, b, 1e-6);
    known.combine(asked, sum);
    CHECK(sum == std::vector<double>{0, 0});
    known.add(b, b, 0);  // the same without an error
    known.combine(asked, sum);
    CHECK(sum[1] == test::about(1).epsilon(1e-8));  // rounding over the new part: 1e-16 / 1e-7
}

}  // namespace seldinger::test::test_condensed
