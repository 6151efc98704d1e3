// Sparse Cholesky of 3 x 3 blocks: against a dense solve, blocks left out, separate pieces, matrices that have no factor.
#include "algebra/block_cholesky.h"
#include "algebra/elimination.h"

#include <doctest/doctest.h>
#include <Eigen/Cholesky>
#include <random>
#include <tuple>

namespace seldinger::test::test_block_cholesky {

namespace {

/// Blocks on a grid of nx by ny, each joined with those up to two away, diagonally dominant; no joint across column `cut`.
Eigen::SparseMatrix<double> grid_matrix(int nx, int ny, int cut = -1)
{
    std::mt19937 random(5);
    const int n = nx * ny;
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < a; ++b) {
            const int dx = a % nx - b % nx, dy = a / nx - b / nx;
            if (dx * dx + dy * dy > 5 || (a % nx < cut) != (b % nx < cut)) continue;
            for (int i = 0; i < 9; ++i)
                dense(3 * a + i / 3, 3 * b + i % 3) = dense(3 * b + i % 3, 3 * a + i / 3) = random() % 200 / 100.0 - 1;
        }
    for (int i = 0; i < 3 * n; ++i) dense(i, i) = dense.row(i).cwiseAbs().sum() + 1;
    return dense.sparseView();
}

}  // namespace

TEST_SUITE("math/block_cholesky")
{
    TEST_CASE("property: Eigen's blocks are the same on every processor, and so the rounding of sums")
    {
        CHECK(Eigen::l1CacheSize() == 32 << 10);
        CHECK(Eigen::l2CacheSize() == 512 << 10);
        CHECK(Eigen::l3CacheSize() == 32 << 20);
    }

    // The matrices' condition is below 30, so that L rounded to 6e-8 leaves less than 1e-6.
    TEST_CASE("twin: a dense solve, with blocks left out, in one piece and in two, stored in double and in single precision")
    {
        for (const auto& [cut, from, tolerance] : {std::tuple(-1, BlockCholesky::single_from, 1e-13),
                                                   {4, BlockCholesky::single_from, 1e-13},
                                                   {-1, std::size_t{0}, 1e-6}}) {
            const Eigen::SparseMatrix<double> m = grid_matrix(9, 14, cut);
            const Eigen::Index n = m.rows();
            std::vector<unsigned char> skip(std::size_t(n / 3), 0);
            skip[0] = skip[17] = skip[60] = 1;
            std::vector<double> along(skip.size()), work;
            for (std::size_t b = 0; b < along.size(); ++b) along[b] = double(b / 9);
            Eigen::MatrixXd dense(m);
            Eigen::VectorXd rhs = Eigen::VectorXd::LinSpaced(n, -1, 2), known = rhs;
            for (Eigen::Index i = 0; i < n; ++i)
                if (skip[std::size_t(i / 3)]) dense.row(i).setZero(), dense.col(i).setZero(), dense(i, i) = 1, known[i] = 0;
            const Eigen::VectorXd expected = dense.llt().solve(known);
            for (const bool hint : {false, true}) {
                BlockCholesky cholesky;
                REQUIRE(cholesky.factor(m, skip, hint ? std::span<const double>(along) : std::span<const double>(), from));
                REQUIRE(cholesky.single() == (from == 0));
                CHECK((cholesky.bytes() < 6 * cholesky.entries()) == cholesky.single());
                std::vector<double> x(rhs.data(), rhs.data() + n), y = x, z = x;
                cholesky.solve(x, work);
                CHECK((Eigen::Map<Eigen::VectorXd>(x.data(), n) - expected).norm() < tolerance * expected.norm());
                CHECK(cholesky.single() ==
                      ((Eigen::Map<Eigen::VectorXd>(x.data(), n) - expected).norm() > 1e-13 * expected.norm()));
                cholesky.solve(y, z, work);
                CHECK(x == y);
                CHECK(x == z);
                BlockCholesky::Partial partial;  // block by block, where it is asked for, to the same bits
                cholesky.begin(std::span(rhs.data(), std::size_t(n)), partial);
                for (const std::int32_t block : {60, 3, 125, 17, 64, 3, 0}) {
                    double at[3];
                    cholesky.read(block, partial, at);
                    CHECK(std::equal(at, at + 3, &x[std::size_t(3 * block)]));
                }
            }
        }
    }

    TEST_CASE("bad input: singular and indefinite matrices have no factor")
    {
        Eigen::SparseMatrix<double> m = grid_matrix(5, 5);
        BlockCholesky cholesky;
        m.coeffRef(40, 40) = -1;
        CHECK(!cholesky.factor(m));
        // a chain of springs without a hold
        Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(30, 30);
        for (int b = 0; b + 1 < 10; ++b)
            for (int a = 0; a < 3; ++a) {
                const int i = 3 * b + a, j = i + 3;
                chain(i, i) += 1, chain(j, j) += 1, chain(i, j) -= 1, chain(j, i) -= 1;
            }
        CHECK(!cholesky.factor(chain.sparseView()));
        chain.topLeftCorner<3, 3>() += Eigen::Matrix3d::Identity();
        CHECK(cholesky.factor(chain.sparseView()));
    }

    // A beam of 600 places on springs. On stiff ones rounding of L is not felt; on springs of 1e-10 its softest answer would be
    // off by 2e-4.
    TEST_CASE("property: a factor is stored in single precision only if the softest answers stay accurate")
    {
        constexpr Eigen::Index n = 600;
        Eigen::MatrixXd bent = Eigen::MatrixXd::Zero(n - 2, n);
        for (Eigen::Index i = 0; i < n - 2; ++i) bent(i, i) = bent(i, i + 2) = 1, bent(i, i + 1) = -2;
        for (const auto& [spring, single] : {std::pair(1e-2, true), {1e-10, false}}) {
            const Eigen::MatrixXd m = bent.transpose() * bent + spring * Eigen::MatrixXd::Identity(n, n);
            BlockCholesky cholesky;
            REQUIRE(cholesky.factor(m.sparseView(), {}, {}, 0));
            CHECK(cholesky.single() == single);
            if (!single) continue;
            std::vector<double> x(n, 1.0), work;  // a load that does not bend it
            cholesky.solve(x, work);
            for (const double u : x) CHECK(std::abs(u * spring - 1) < BlockCholesky::single_error);
        }
    }

    TEST_CASE("property: elimination from an end fills a strip's band, and orders are permutations")
    {
        // a path of 50 with neighbours two away: two entries a column, whatever the panels are
        Graph path{{0}, {}};
        for (int v = 0; v < 50; ++v) {
            for (const int w : {v - 2, v - 1, v + 1, v + 2})
                if (w >= 0 && w < 50) path.adjacent.push_back(w);
            path.first.push_back(int(path.adjacent.size()));
        }
        std::vector<std::int32_t> plain(50);
        for (int k = 0; k < 50; ++k) plain[std::size_t(k)] = k;
        CHECK(eliminate(path, plain).entries == 2 * 48 + 1);
        for (std::vector<std::int32_t> order : {nested_dissection(path, 8), minimum_degree(path), eliminate(path, plain).order}) {
            std::sort(order.begin(), order.end());
            CHECK(order == plain);
        }
    }
}

}  // namespace seldinger::test::test_block_cholesky
