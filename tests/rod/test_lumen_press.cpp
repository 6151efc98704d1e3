// What presses between instruments at their clearance: couples of forces against closed forms, shares of the moment.

#include "rod/lumen_press.h"
#include "rod/coaxial_fixture.h"
#include "rod/coaxial_moment.h"

#include <cmath>
#include <random>

namespace seldinger::test::test_lumen_press {

using Complex = LumenPress::Complex;

namespace {

constexpr double bend = 1e-4, clearance = 1e-4, spacing = 0.25e-3;  // [N m^2], [m], [m]

LumenPress press_over(int places)
{
    LumenPress press;
    press.places.assign(static_cast<std::size_t>(places), {bend, 0.0, clearance});
    return press;
}

double in_all(const LumenPress& press)
{
    double sum = 0;
    for (const double force : press.force) sum += force;
    return sum;
}

}  // namespace

TEST_SUITE("rod/lumen press")
{
    // From one side of the lumen to the other over l, where B y'' falls from M to 0: M l^2/(6 B) = 2 c. The rim's node gives by
    // F/(K h), which adds to 2 c, and l is a whole number of nodes. F is less by a quarter of F/(K h c), and off by a place at
    // either end, 2 h/l.
    TEST_CASE("analytic: a moment that comes in at a mouth is a couple over sqrt(12 B c/M)")
    {
        for (const double moment : {2e-4, 5e-4, 1e-3})
            for (const double share : {1.0, 0.5}) {
                LumenPress press = press_over(400);
                for (LumenPress::Place& place : press.places) place.clearance *= share;
                press.end.moment = std::polar(moment, 0.7);
                REQUIRE(press.solve(spacing, 200) < 200);
                const double length = std::sqrt(12 * bend * share * clearance / moment), force = moment / length;
                CAPTURE(length);
                CHECK(in_all(press) ==
                      about(2 * force).epsilon(0.25 * force / (2e7 * spacing * share * clearance) + 2 * spacing / length));
                CHECK(std::abs(std::arg(press.off[0] / press.end.moment)) < 1e-6);  // its rim is on the side that it comes from
            }
    }

    // A jump inside is shared by both sides: M from -a to a, a^2 = 12 B c/M
    TEST_CASE("analytic: a jump within the lumen is a couple over twice that")
    {
        const double moment = 1e-3;
        LumenPress press = press_over(600);
        for (std::size_t i = 0; i < 300; ++i) press.places[i].moment = moment;
        press.end.moment = moment;  // as before the mouth, which is then none
        REQUIRE(press.solve(spacing, 200) < 200);
        CHECK(in_all(press) == about(2 * moment / (2 * std::sqrt(12 * bend * clearance / moment))).epsilon(0.05));
    }

    // Whatever the clearance: where it touches all along, force per length is -M''
    TEST_CASE("analytic: a moment that bends smoothly presses by its second derivative")
    {
        const double curved = 4.0;  // M'' [N/m]
        LumenPress press = press_over(600);
        for (std::size_t i = 0; i < 600; ++i)
            press.places[i].moment = 0.5 * curved * std::pow(static_cast<double>(i) * spacing, 2);
        REQUIRE(press.solve(spacing, 200) < 200);
        double middle = 0;
        for (std::size_t i = 200; i < 400; ++i) middle += press.force[i];
        CHECK(middle == about(curved * 200 * spacing).epsilon(0.02));
        // and by what else moves it sideways: against each other both leave nothing
        for (LumenPress::Place& place : press.places) place.lateral = curved;
        REQUIRE(press.solve(spacing, 200) < 200);
        middle = 0;
        for (std::size_t i = 200; i < 400; ++i) middle += press.force[i];
        CHECK(middle < 0.02 * curved * 200 * spacing);
    }

    TEST_CASE("property: the result does not depend on the first guess, and takes few steps from the last one")
    {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> any(-clearance, clearance);
        LumenPress press = press_over(300);
        for (std::size_t i = 60; i < 120; ++i) press.places[i].moment = {1e-3, 5e-4};
        press.end.shear = {0.02, 0};
        REQUIRE(press.solve(spacing, 300) < 300);
        const std::vector<double> force = press.force;
        for (Complex& off : press.off) off = {any(random), any(random)};
        REQUIRE(press.solve(spacing, 300) < 300);
        for (std::size_t i = 0; i < force.size(); ++i) CHECK(std::abs(press.force[i] - force[i]) < 0.02 * in_all(press));
        for (std::size_t i = 61; i < 121; ++i) press.places[i].moment *= 1.001;
        CHECK(press.solve(spacing, 10) <= 3);
    }

    // Bent as one: kappa = B_1 kappa_1/B, the line's moment is none, and both hold against each other with B_1 B_2/B kappa_1
    TEST_CASE("analytic: shares of the moment of a curved instrument and a straight one, however turned")
    {
        const double stiff = 2e-4, soft = 1e-4, curvature = 8;
        Coaxial pair({instrument_spec(0.2, stiff, stiff, 0.2, curvature), instrument_spec(0.2, soft, soft)}, {0.1, 0.1}, 50);
        for (const double angle : {0.0, 1.1}) {
            pair.roll(0, angle);
            pair.bend_to_rest();
            REQUIRE(pair.equilibrate() >= 0);
            REQUIRE(pair.update());
            CoaxialMoments moments;
            measure_moments({pair.rod, pair.line, pair.now(), pair.base, pair.frames}, moments);
            const double both = stiff * soft / (stiff + soft) * curvature;
            for (const int j : {5, 25, 45}) {
                CHECK(std::abs(moments.moment[static_cast<std::size_t>(j)]) < 1e-5 * both);
                const CoaxialShare outer = share_in(pair.rod, pair.rod.pieces.back(), pair.now(), moments, j, 0, 1);
                const CoaxialShare inner = share_in(pair.rod, pair.rod.pieces.back(), pair.now(), moments, j, 1, 2);
                CHECK(std::abs(inner.of(0.0)) == about(both).epsilon(1e-6));
                CHECK(std::abs(inner.of(0.0) + outer.of(0.0)) < 1e-12);
                CHECK(std::abs(inner.of(3e-4) + outer.of(3e-4) - 3e-4) < 1e-12);
            }
        }
    }
}

}  // namespace seldinger::test::test_lumen_press
