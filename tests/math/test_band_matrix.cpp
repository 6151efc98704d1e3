// The banded factorisations against Eigen's dense ones, on matrices of the pattern that a wire gives.
#include "math/band_matrix.h"
#include "support/approx.h"

#include <Eigen/Dense>

#include <limits>
#include <random>

namespace seldinger::test::test_band_matrix {

namespace {

constexpr int half = BandMatrix::half_bandwidth;

bool in_pattern(int i, int j) { return std::abs(i - j) <= half && std::abs(i / 4 - j / 4) <= 2; }

/// Random matrix in the pattern; `diagonal` is added on the diagonal, so that large values make it definite.
Eigen::MatrixXd fill(BandMatrix& band, int size, bool symmetric, double diagonal, unsigned seed)
{
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
    for (int i = 0; i < size; ++i)
        for (int j = symmetric ? i : 0; j < size; ++j) {
            if (!in_pattern(i, j)) continue;
            dense(i, j) = uniform(generator) + (i == j ? diagonal : 0);
            if (symmetric) dense(j, i) = dense(i, j);
        }
    band.reset(size);
    for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
            if (in_pattern(i, j)) band.add(i, j, dense(i, j));
    return dense;
}

double solve_error(const Eigen::MatrixXd& dense, const Eigen::VectorXd& x, const Eigen::VectorXd& rhs)
{
    return (dense * x - rhs).lpNorm<Eigen::Infinity>() / (dense.lpNorm<Eigen::Infinity>() * x.lpNorm<Eigen::Infinity>());
}

}  // namespace

TEST_SUITE("solve/band_matrix")
{
    // backward error of a stable banded elimination is a small multiple of the bandwidth times 1.1e-16
    TEST_CASE("property: LDL^T solves definite band systems of every small size to rounding")
    {
        BandMatrix band(400);
        for (int size : {4, 8, 12, 16, 20, 64, 400}) {
            CAPTURE(size);
            const Eigen::MatrixXd dense = fill(band, size, true, 12.0, size);
            const Eigen::VectorXd rhs = Eigen::VectorXd::Random(size);
            Eigen::VectorXd x = rhs;
            CHECK(band.factor_ldlt() == 0);
            band.solve_ldlt({x.data(), static_cast<std::size_t>(size)});
            CHECK(solve_error(dense, x, rhs) < 1e-14);
            CHECK((x - dense.ldlt().solve(rhs)).norm() < 1e-12 * x.norm());
        }
    }

    TEST_CASE("property: LU solves unsymmetric band systems of every small size to rounding")
    {
        BandMatrix band(400);
        for (int size : {4, 8, 12, 16, 20, 64, 400}) {
            CAPTURE(size);
            const Eigen::MatrixXd dense = fill(band, size, false, 15.0, 100 + size);
            const Eigen::VectorXd rhs = Eigen::VectorXd::Random(size);
            Eigen::VectorXd x = rhs;
            REQUIRE(band.factor_lu());
            band.solve_lu({x.data(), static_cast<std::size_t>(size)});
            CHECK(solve_error(dense, x, rhs) < 1e-14);
            CHECK((x - dense.partialPivLu().solve(rhs)).norm() < 1e-12 * x.norm());
        }
    }

    TEST_CASE("property: a fixed unknown keeps its right-hand side and leaves the others' equations alone")
    {
        BandMatrix band(40);
        Eigen::MatrixXd dense = fill(band, 40, true, 12.0, 7);
        for (int i : {0, 17, 39}) {
            band.fix(i);
            dense.row(i).setZero();
            dense.col(i).setZero();
            dense(i, i) = 1;
        }
        Eigen::VectorXd x = Eigen::VectorXd::Random(40);
        const Eigen::VectorXd rhs = x;
        CHECK(band.factor_ldlt() == 0);
        band.solve_ldlt({x.data(), 40});
        CHECK(x(17) == rhs(17));
        CHECK(solve_error(dense, x, rhs) < 1e-14);
    }

    TEST_CASE("property: multiply is the dense product")
    {
        BandMatrix band(40);
        const Eigen::MatrixXd dense = fill(band, 40, false, 0.0, 3);
        const Eigen::VectorXd x = Eigen::VectorXd::Random(40);
        Eigen::VectorXd y(40);
        band.multiply({x.data(), 40}, {y.data(), 40});
        CHECK((y - dense * x).norm() < 1e-14 * y.norm());
    }

    TEST_CASE("property: columns add up to the product")
    {
        BandMatrix band(40);
        (void)fill(band, 40, false, 0.0, 4);
        const Eigen::VectorXd x = Eigen::VectorXd::Random(40);
        Eigen::VectorXd y(40), sum = Eigen::VectorXd::Zero(40);
        band.multiply({x.data(), 40}, {y.data(), 40});
        for (int j = 0; j < 40; ++j) band.add_column(j, x[j], {sum.data(), 40});
        CHECK(sum == y);
    }

    TEST_CASE("property: matrices that use the same memory in turn give the bits that each gives in its own")
    {
        BandMatrix::Storage shared(64), factors(64);
        for (const bool symmetric : {true, false})
            for (const int size : {64, 24, 40}) {
                CAPTURE(size);
                BandMatrix own(64), guest(64);
                guest.use_rows(&shared);
                guest.use_factor(&factors);
                (void)fill(own, size, symmetric, 15, 9);
                (void)fill(guest, size, symmetric, 15, 9);
                Eigen::VectorXd x = Eigen::VectorXd::Random(size), y = x;
                for (auto& [band, v] : {std::pair{&own, &x}, std::pair{&guest, &y}}) {
                    const std::span<double> part(v->data(), size);
                    REQUIRE((symmetric ? band->factor_ldlt() == 0 : band->factor_lu()));
                    symmetric ? band->solve_ldlt(part) : band->solve_lu(part);
                }
                CHECK(x == y);
            }
    }

    // Sylvester: an indefinite matrix has a pivot that is not positive. The raised factorisation is that of a definite matrix,
    // so that the direction it gives always goes downhill: x . rhs > 0.
    TEST_CASE("property: an indefinite matrix has its pivots raised and still gives descent")
    {
        BandMatrix band(80);
        int raised_in_all = 0;
        for (unsigned seed = 0; seed < 20; ++seed) {
            CAPTURE(seed);
            const Eigen::MatrixXd dense = fill(band, 80, true, 1.0, seed);
            REQUIRE(dense.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() < 0);
            const int raised = band.factor_ldlt();
            raised_in_all += raised;
            CHECK(raised > 0);
            const Eigen::VectorXd rhs = Eigen::VectorXd::Random(80);
            Eigen::VectorXd x = rhs;
            band.solve_ldlt({x.data(), 80});
            CHECK(x.dot(rhs) > 0);
            CHECK(x.allFinite());
        }
        CHECK(raised_in_all > 20);
    }

    TEST_CASE("property: singular matrices are reported by LU, and made regular by LDL^T")
    {
        BandMatrix band(24);
        // a chain of springs between neighbouring nodes, held nowhere: constant vectors are in its kernel
        band.reset(24);
        for (int i = 0; i + 4 < 24; ++i) {
            band.add(i, i, 1);
            band.add(i + 4, i + 4, 1);
            band.add(i, i + 4, -1);
            band.add(i + 4, i, -1);
        }
        CHECK_FALSE(band.factor_lu());
        CHECK(band.factor_ldlt() == 4);
        Eigen::VectorXd x = Eigen::VectorXd::Ones(24);
        band.solve_ldlt({x.data(), 24});
        CHECK(x.allFinite());
        CHECK(x.lpNorm<Eigen::Infinity>() < 100);

        band.reset(24);  // nothing at all
        CHECK_FALSE(band.factor_lu());
        CHECK(band.factor_ldlt() == 24);
    }

    TEST_CASE("property: not-a-number is seen, not hidden")
    {
        BandMatrix band(24);
        fill(band, 24, true, 12.0, 5);
        band.add(9, 9, std::numeric_limits<double>::quiet_NaN());
        CHECK(band.factor_ldlt() > 0);
        CHECK_FALSE(band.factor_lu());
    }

    // the weakest honest pivot: a free chain of stiff springs with a little inertia on each node
    TEST_CASE("analytic: inertia 1e-11 of the stiffness still gives the rigid motion")
    {
        const int nodes = 100;
        const double stiffness = 1, inertia = 1e-11;
        BandMatrix band(4 * nodes);
        band.reset(4 * nodes);
        for (int i = 0; i < 4 * nodes; ++i) {
            band.add(i, i, inertia);
            if (i + 4 >= 4 * nodes) continue;
            band.add(i, i, stiffness);
            band.add(i + 4, i + 4, stiffness);
            band.add(i, i + 4, -stiffness);
            band.add(i + 4, i, -stiffness);
        }
        Eigen::VectorXd x = Eigen::VectorXd::Constant(4 * nodes, inertia);  // every node accelerates by 1
        CHECK(band.factor_ldlt() == 0);
        band.solve_ldlt({x.data(), static_cast<std::size_t>(x.size())});
        // rounding of the stiffness, 1e-16, against the whole chain's inertia, 1e-9, after 100 accumulations
        CHECK(x.minCoeff() == test::about(1).epsilon(1e-4));
        CHECK(x.maxCoeff() == test::about(1).epsilon(1e-4));
    }
}

}  // namespace seldinger::test::test_band_matrix
