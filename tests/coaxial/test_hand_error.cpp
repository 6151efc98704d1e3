// What edges do to the hands of instruments that share one centreline, against beam theory.
#include "coaxial/straight_pair.h"
#include "world/node_errors.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_hand_error {

namespace {

struct Held {
    double off, estimated;  // of the outer one's hand, relative to its force
};

/// A force across the inner one's tip, which is that far beyond the end of the outer one. Nodes count from the tip.
/// @param natural  curvature of the outer one, in the sense of the force [1/m]
Held held(double lever, double edge, double natural = 0)
{
    const double outer = 0.05, force = 5e-3;
    WorldSetup setup = straight_pair(outer, outer + lever, Scheme::Static, edge);
    setup.wires[0].wire.sections[0].section.rest_curvature = {natural, 0};
    setup.wires[1].loads.push_back({.at = {WirePoint::Kind::Distance}, .force = {0, 0, force}});
    World world(setup);
    for (int k = 0; k < 3; ++k) advance(world, outer, outer + lever);
    // natural curvature of both together is natural/1.5, and the inner one's 0 beyond; what both store by that is natural^2 B_1
    // B_2/(2 (B_1 + B_2))
    const double moment = force * lever, exact = 0.5 * moment * moment * (1 / (0.5 * bend) - 1 / (1.5 * bend)) -
                                                 moment * natural / 1.5 + natural * natural * bend * 0.5 / (2 * 1.5);
    return {std::abs(world.readings(0).hand_force / exact - 1), hand_error(world, 0) / exact};
}

}  // namespace

TEST_SUITE("coaxial/hand_error")
{
    // A push of the outer one stiffens the line where its end is: F = M^2/2 (1/B_inner - 1/(B_inner + B_outer)), M the load times
    // its lever. The deflection of 0.04 rad turns the load by that, so that M differs by 0.1 %. Where the end lies in its cell
    // decides on the error: of eleven places in two edges the worst is compared. The estimate is the bound of that, so the worst
    // of finely spaced ends comes near to it.
    TEST_CASE(
        "analytic: the hand of an instrument that ends in another's bend is off by at most the estimate, which is of first order")
    {
        double estimates[2] = {};
        for (int half = 0; half < 2; ++half) {
            const double edge = half ? 2.5e-3 : 5e-3;
            double most = 0;
            for (int k = 0; k <= 10; ++k) {
                const Held now = held(0.02 + 0.2 * edge * k, edge);
                CAPTURE(edge);
                CAPTURE(k);
                CHECK(now.off < now.estimated + 2e-3);
                most = std::max(most, now.off);
                estimates[half] = std::max(estimates[half], now.estimated);
            }
            CHECK(most > 0.3 * estimates[half]);
        }
        CHECK(estimates[0] > 0.1);  // 5 mm of 20: it matters
        CHECK(estimates[0] / estimates[1] == about(2).epsilon(0.25));
    }

    TEST_CASE("analytic: so is that of a preformed instrument, whose end takes its natural curvature along")
    {
        const double edge = 5e-3, natural = -4;
        double most = 0, estimate = 0;
        for (int k = 0; k <= 10; ++k) {
            const Held now = held(0.02 + 0.2 * edge * k, edge, natural);
            CAPTURE(k);
            CAPTURE(now.off);
            CHECK(now.off < now.estimated + 2e-3);
            most = std::max(most, now.off);
            estimate = std::max(estimate, now.estimated);
        }
        CAPTURE(most);
        CHECK(most > 0.3 * estimate);
    }

    TEST_CASE("property: a wire alone has no such error")
    {
        WorldSetup setup = straight_pair(0.05, 0.07);
        setup.coaxial.clear();
        setup.wires.resize(1);
        setup.systems = {1};
        World world(setup);
        CHECK(hand_error(world, 0) == 0);
    }
}

}  // namespace seldinger::test::test_hand_error
