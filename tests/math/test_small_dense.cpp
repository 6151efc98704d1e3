// LU of small dense matrices against Eigen's.
#include "math/small_dense.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <Eigen/Dense>

#include <random>

namespace test_small_dense {

using namespace seldinger;

TEST_SUITE("math/small_dense")
{
    // Sizes around the four pivots that are taken at a time. Condition numbers of these matrices are below 1e4.
    TEST_CASE("LU solves with a matrix and with its transpose")
    {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> number(-1, 1);
        for (const int n : {1, 2, 3, 4, 5, 7, 8, 9, 30}) {
            CAPTURE(n);
            SmallMatrix matrix(n);
            Eigen::MatrixXd dense(n, n);
            Eigen::VectorXd right(n);
            for (int i = 0; i < n; ++i) {
                right[i] = number(random);
                for (int j = 0; j < n; ++j) dense(i, j) = matrix(i, j) = number(random);
            }
            SmallLu lu;
            lu.factor(matrix);
            std::vector<double> x(right.data(), right.data() + n), y = x;
            lu.solve(x);
            lu.solve_transposed(y);
            const Eigen::VectorXd of = dense.partialPivLu().solve(right), of_transposed = dense.transpose().partialPivLu().solve(right);
            for (int i = 0; i < n; ++i) {
                CHECK(x[i] == test::about(of[i]).epsilon(1e-10).scale(of.norm()));
                CHECK(y[i] == test::about(of_transposed[i]).epsilon(1e-10).scale(of_transposed.norm()));
            }
            CHECK(lu.sign() == (dense.determinant() > 0 ? 1 : -1));
        }
    }
}

}  // namespace test_small_dense
