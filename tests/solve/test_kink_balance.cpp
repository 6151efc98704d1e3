// engine/physics/newton/kink_balance: forces across kinks against a closed form, and against all combinations of bounds tried in
// turn.

#include "math/dof_map.h"
#include "math/small_dense.h"
#include "newton/kinks.h"
#include "support/approx.h"

#include <cmath>
#include <random>
#include <vector>

namespace seldinger::test::test_kink_balance {

namespace {

KinkBalance::Met met_with(double force, double rest, double width, double free_move)
{
    return {{0, 0.25, Vec3(0, 0.2, 0), force, rest, width}, 0, free_move, 0};
}

/// The forces by trying each kink at 0, between its facets and at f, in all combinations; the one that agrees with itself is
/// unique.
std::vector<double> by_enumeration(const KinkBalance& b)
{
    const int n = b.count;
    int all = 1;
    for (int k = 0; k < n; ++k) all *= 3;
    for (int code = 0; code < all; ++code) {
        std::vector<int> state;
        for (int k = 0, left = code; k < n; ++k, left /= 3) state.push_back(left % 3);
        SmallMatrix transposed(n);
        std::vector<double> p(static_cast<std::size_t>(n));
        for (int k = 0; k < n; ++k) {
            const Kink& kink = b.met[k].kink;
            p[k] = state[k] == 0 ? 0 : state[k] == 2 ? kink.force : kink.rest + b.met[k].free_move;
            for (int l = 0; l < n; ++l)
                transposed(l, k) = (state[k] == 1 ? b.compliance[KinkBalance::most * k + l] : 0.0) +
                          (k == l ? (state[k] == 1 ? kink.width / kink.force : 1.0) : 0.0);
        }
        SmallLu lu;
        lu.factor(transposed);
        lu.solve_transposed(p);
        bool agrees = true;
        for (int k = 0; k < n; ++k) {
            double y = b.met[k].free_move;
            for (int l = 0; l < n; ++l) y -= b.compliance[KinkBalance::most * k + l] * p[l];
            const double z = (b.met[k].kink.rest + y) / b.met[k].kink.width;
            agrees = agrees && (state[k] == 0 ? z <= 0 : state[k] == 2 ? z >= 1 : z > 0 && z < 1);
        }
        if (agrees) return p;
    }
    FAIL("no combination agrees with itself");
    return {};
}

}  // namespace

TEST_SUITE("solve/kink_balance")
{
    // p = f (rest + y - c p) / width where that is within 0 ... f
    TEST_CASE("analytic: one kink ends before, within or beyond its valley")
    {
        constexpr double f = 0.02, rest = -1e-6, width = 4e-6, c = 1e-3;
        const auto force = [&](double move) {
            KinkBalance balance;
            balance.count = 1;
            balance.met[0] = met_with(f, rest, width, move);
            balance.compliance[0] = c;
            balance.solve();
            return balance.met[0].force;
        };
        CHECK(force(0.5e-6) == 0);
        CHECK(force(10e-6) == about(f * 9e-6 / (width + f * c)).epsilon(1e-12));
        CHECK(force(30e-6) == f);
    }

    // Compliances fall off by half from kink to neighbouring kink, as on a wire: each sweep leaves less than 0.9 of the error,
    // and stops at a change of 1e-9.
    TEST_CASE("oracle: several kinks have the forces of the only combination that agrees with itself")
    {
        std::mt19937 dice(3);
        std::uniform_real_distribution<double> one(0, 1);
        int within = 0, beyond = 0;
        for (int run = 0; run < 50; ++run) {
            KinkBalance balance;
            balance.count = 5;
            for (int k = 0; k < 5; ++k) {
                balance.met[k] = met_with(0.01 + 0.02 * one(dice), -2e-6 * one(dice), 4e-6, 30e-6 * one(dice));
                for (int l = 0; l < 5; ++l) balance.compliance[KinkBalance::most * k + l] = 5e-4 * std::pow(0.5, std::abs(k - l));
            }
            balance.solve();
            const std::vector<double> expected = by_enumeration(balance);
            for (int k = 0; k < 5; ++k) {
                CAPTURE(run);
                CAPTURE(k);
                const double f = balance.met[k].kink.force;
                CHECK(std::abs(balance.met[k].force - expected[k]) <= 1e-8 * f);
                within += expected[k] > 0 && expected[k] < f;
                beyond += expected[k] == f;
            }
        }
        CHECK(within > 20);  // both have been seen
        CHECK(beyond > 20);
    }

    TEST_CASE("property: rows act on the nodes beside the contact, as a lever does")
    {
        const KinkBalance::Met met = met_with(0.02, 0, 1e-6, 0);
        std::vector<double> x(RodDofs::count(2));
        KinkBalance::add(met, 3, x);
        CHECK(x[RodDofs::position(0, 1)] == about(3 * 0.75 * 0.2));
        CHECK(x[RodDofs::position(1, 1)] == about(3 * 0.25 * 0.2));
        CHECK(KinkBalance::along(met, x) == about(3 * 0.2 * 0.2 * (0.75 * 0.75 + 0.25 * 0.25)));
    }
}

}  // namespace seldinger::test::test_kink_balance
