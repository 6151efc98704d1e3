// The positive part of a small symmetric matrix.

#include "math/jacobi.h"

#include <Eigen/Eigenvalues>
#include <doctest/doctest.h>

#include <random>

namespace seldinger::test::test_jacobi {

namespace {

constexpr int n = 7;
using Matrix = Eigen::Matrix<double, n, n>;

FixedMatrix<n> fixed(const Matrix& from)
{
    FixedMatrix<n> to;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) to(i, j) = from(i, j);
    return to;
}

Matrix eigen_of(const FixedMatrix<n>& from)
{
    Matrix to;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) to(i, j) = from(i, j);
    return to;
}

Matrix random_symmetric(unsigned seed)
{
    std::mt19937 rng(seed);
    std::normal_distribution<double> normal;
    Matrix m;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) m(i, j) = m(j, i) = normal(rng);
    return m;
}

}  // namespace

// Rounding of n^2 products of numbers of the matrix' size, about 5: 1e-14 of each.
TEST_CASE("property: the positive part has the positive eigenvalues and no others")
{
    for (unsigned seed = 0; seed < 20; ++seed) {
        CAPTURE(seed);
        const Matrix m = random_symmetric(seed);
        const Matrix positive = eigen_of(positive_part(fixed(m)));
        const auto values = Eigen::SelfAdjointEigenSolver<Matrix>(m).eigenvalues();
        const auto kept = Eigen::SelfAdjointEigenSolver<Matrix>(positive).eigenvalues();
        for (int k = 0; k < n; ++k) CHECK(std::abs(kept[k] - std::max(values[k], 0.0)) < 1e-12);
        // what is left out is orthogonal to it
        CHECK((positive * (m - positive)).norm() < 1e-12);
    }
}

TEST_CASE("property: a matrix without negative eigenvalues is its own positive part")
{
    for (unsigned seed = 0; seed < 5; ++seed) {
        CAPTURE(seed);
        const Matrix m = random_symmetric(seed), square = m * m;
        CHECK((eigen_of(positive_part(fixed(square))) - square).norm() < 1e-13 * square.norm() * n);
    }
    CHECK(eigen_of(positive_part(FixedMatrix<n>())).norm() == 0);
}

}  // namespace seldinger::test::test_jacobi
