// LU of small dense matrices against Eigen's.
#include "math/small_dense.h"
#include "support/approx.h"

#include <Eigen/Dense>

#include <random>

namespace seldinger::test::test_small_dense {

TEST_SUITE("math/small_dense")
{
    // Sizes around the four pivots that are taken at a time. Condition numbers of these matrices are below 1e4.
    TEST_CASE("LU solves with the transpose of a matrix")
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
            std::vector<double> y(right.data(), right.data() + n);
            lu.solve_transposed(y);
            const Eigen::VectorXd of_transposed = dense.transpose().partialPivLu().solve(right);
            for (int i = 0; i < n; ++i)
                CHECK(y[i] == test::about(of_transposed[i]).epsilon(1e-10).scale(of_transposed.norm()));
        }
    }
}

}  // namespace seldinger::test::test_small_dense
