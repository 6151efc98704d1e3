// Instruments that share one centreline by Newmark's steps: what vibrates, while one slides along the other and without.

#include "coaxial/straight_pair.h"
#include "support/steps.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_merged_newmark {

namespace {

WorldSetup pair_of(double outer, double inner, double edge = 2e-3)
{
    WorldSetup setup = straight_pair(outer, inner, Scheme::Newton, edge);
    setup.integrator.newmark = true;
    return setup;
}

LoadSpec at_tip(const Vec3& force, double ramp = 0) { return {.at = {WirePoint::Kind::Tip}, .force = force, .ramp = ramp}; }

double mass_rate(int instruments) { return instruments * 6500 * pi * 0.25e-6; }  // [kg/m], section_of()

/// First frequency of a cantilever of 3/2 `bend` and two instruments' mass over `a`, and of `bend`/2 and one's beyond, to
/// `length`: the root of the determinant of Euler and Bernoulli's beam [Hz]. Its w = sums of cos, sin, cosh, sinh of k x in each
/// part.
double stepped_frequency(double a, double length)
{
    const double both = 1.5 * bend, alone = 0.5 * bend;
    const auto determinant = [&](double omega) {
        const double k = std::pow(omega * omega * mass_rate(2) / both, 0.25),
                     q = std::pow(omega * omega * mass_rate(1) / alone, 0.25);
        const auto row = [](double k_, double x, int order) {  // derivative of cos, sin, cosh, sinh
            const double c = std::cos(k_ * x), s = std::sin(k_ * x), ch = std::cosh(k_ * x), sh = std::sinh(k_ * x);
            const Eigen::RowVector4d of[4] = {{c, s, ch, sh}, {-s, c, sh, ch}, {-c, -s, ch, sh}, {s, -c, sh, ch}};
            return Eigen::RowVector4d(std::pow(k_, order) * of[order]);
        };
        Eigen::Matrix<double, 8, 8> m = Eigen::Matrix<double, 8, 8>::Zero();
        for (int order = 0; order < 2; ++order) m.block<1, 4>(order, 0) = row(k, 0, order) / std::pow(k, order);
        for (int order = 0; order < 4; ++order) {
            const double of_left = order < 2 ? 1 : both / alone;
            m.block<1, 4>(2 + order, 0) = of_left * row(k, a, order) / std::pow(k, order);
            m.block<1, 4>(2 + order, 4) = -row(q, 0, order) / std::pow(k, order);
        }
        for (int order = 2; order < 4; ++order) m.block<1, 4>(4 + order, 4) = row(q, length - a, order) / std::pow(q, order);
        return m.determinant();
    };
    double low = 1, high = 2;
    while (determinant(low) * determinant(high) > 0) low = high, high *= 1.05;
    for (int k = 0; k < 100; ++k) {
        const double middle = 0.5 * (low + high);
        (determinant(low) * determinant(middle) > 0 ? low : high) = middle;
    }
    return low / (2 * pi);
}

}  // namespace

TEST_SUITE("coaxial/merged newmark")
{
    // One beam of uniform stiffness to check the determinant by, then the stepped one. Released under a load, it swings about
    // where that holds it; ten periods from upward crossings of the mean. Trapezoid: (omega h)^2/12 = 2e-4 longer; edges of 2 mm:
    // (edge/L)^2.
    TEST_CASE("analytic: a stepped cantilever of two instruments has its first frequency")
    {
        const double length = 0.1;
        const double uniform = 1.8751040687 * 1.8751040687 / (2 * pi * length * length) * std::sqrt(0.5 * bend / mass_rate(1));
        REQUIRE(stepped_frequency(1e-9, length) == about(uniform).epsilon(1e-6));
        for (const double outer : {0.03, 0.0611, 0.0985}) {
            const double frequency = stepped_frequency(outer, length), dt = 1 / (128 * frequency);
            WorldSetup setup = pair_of(outer, length);
            setup.wires[1].loads.push_back(at_tip({0, 0, 1e-4}));
            World world(setup);
            std::vector<double> height;
            for (int k = 0; k < 128 * 12; ++k) {
                advance(world, outer, length, dt);
                height.push_back(world.rod(1).pos(0).z());
            }
            double mean = 0;
            for (const double z : height) mean += z / static_cast<double>(height.size());
            std::vector<double> up;
            for (std::size_t k = 1; k < height.size(); ++k)
                if (height[k - 1] < mean && height[k] >= mean)
                    up.push_back(dt * (static_cast<double>(k) + (mean - height[k - 1]) / (height[k] - height[k - 1])));
            REQUIRE(up.size() >= 11);
            CHECK(10 / (up[10] - up[0]) == about(frequency).epsilon(2e-3));
        }
    }

    // Inserted equally far, they are one wire with both stiffnesses and masses, in every step and to the solver's tolerance.
    // Fed on together as well, except for rounding.
    TEST_CASE("twin: a pair that swings is one wire of both")
    {
        const double length = 0.08;
        WorldSetup pair = pair_of(length, length);
        pair.gravity = {0, 0, -9.81};
        WorldSetup one = pair;
        one.wires.resize(1);
        one.systems = {1};
        one.coaxial.clear();
        WireSection sum = section_of(1.5 * bend, 1.5 * twist, 0);
        sum.density *= 2;
        one.wires[0].wire.shaft = sum;
        one.wires[0].wire.sections.clear();
        World merged(pair), single(one);
        double most = 0, widest = 0;
        for (int k = 1; k <= 400; ++k) {
            const double on = length + 1e-5 * std::max(0, k - 200);
            advance(merged, on, on, 2e-4);
            step_to(single, 2e-4, {{on}});
            REQUIRE(merged.rod(0).n == single.rod(0).n);
            most = std::max(most, (merged.rod(0).pos(0) - single.rod(0).pos(0)).norm());
            widest = std::max(widest, -single.rod(0).pos(0).z());
            CHECK(merged.readings(0).momentum.error().norm() < 1e-7);
        }
        REQUIRE(widest > 1e-4);
        CHECK(most < 1e-4 * widest);
    }

    // One slides along the other as the line is bent: the root of the mean square of the tip's error on its way, by steps that
    // are halved twice. Sixteen for second order (the highest modes that the load shakes are not resolved by the longest steps:
    // within 15 %); backward Euler's four as a check. Where the end of a section moves from cell to cell, a force's slope jumps.
    // Newmark's error depends on where in the step that is: at 0.8 m/s over seven cells the rest is between the two.
    TEST_CASE("analytic: second order in the step while one slides along the other")
    {
        const double time = 0.04;
        constexpr int seen = 20;
        const auto way_of_tip = [&](int steps, bool newmark, double from, double slide) {
            WorldSetup setup = pair_of(from, 0.09, 3e-3);  // cells from 49.5 to 52.5 mm, and so on
            setup.integrator.newmark = newmark;
            setup.wires[1].loads.push_back(at_tip({0, 0.04, 0.02}, time));
            World world(setup);
            std::vector<Vec3> way;
            for (int k = 1; k <= steps; ++k) {
                advance(world, from + slide * 0.5 * (1 - std::cos(pi * k / steps)), 0.09, time / steps);
                if (k % (steps / seen) == 0) way.push_back(world.rod(1).pos(0));
            }
            return way;
        };
        const auto order = [&](bool newmark, double from, double slide) {  // how many times less at a quarter of the step
            const std::vector<Vec3> exact = way_of_tip(6400, true, from, slide);
            const auto error = [&](int steps) {
                const std::vector<Vec3> way = way_of_tip(steps, newmark, from, slide);
                double squares = 0;
                for (int k = 0; k < seen; ++k) squares += (way[k] - exact[k]).squaredNorm() / seen;
                return std::sqrt(squares);
            };
            const double coarse = error(200), fine = error(800);
            CHECK(coarse > 1e-6);
            return coarse / fine;
        };
        CHECK(order(true, 0.0497, 0.0025) == about(16).epsilon(0.15));
        CHECK(order(false, 0.0497, 0.0025) == about(4).epsilon(0.05));
        CHECK(order(true, 0.05, 0.021) > 5);
    }

    // Left alone, it swings on; while hands push, their work and its energy add up. The leading part sends waves along the
    // line, of which a hand's mean force over a step leaves out a share: no dashpot takes them.
    TEST_CASE("property: energy is kept, and closed while one slides along the other")
    {
        WorldSetup setup = pair_of(0.05, 0.09);
        setup.wires[1].loads.push_back(at_tip({0, 1e-3, 2e-3}));
        World world(setup);
        const auto energy = [&] { return world.readings(0).energy; };
        for (int k = 0; k < 1000; ++k) advance(world, 0.05, 0.09, 1e-4);
        const EnergyLedger alone = energy();
        REQUIRE(alone.outside > 1e-7);
        CHECK(std::abs(alone.scheme) < 1e-6 * alone.outside);
        for (int k = 0; k < 2000; ++k) advance(world, 0.05 + 0.012 * (1 - std::cos(2 * pi * k / 1000)), 0.09, 1e-4);
        CHECK(std::abs(energy().scheme - alone.scheme) < 1e-4 * alone.outside);  // forces by their means over a step: (omega h)^2
        double turned_over = 0;
        for (int k = 0; k < 2000; ++k) {
            const double phase = 2 * pi * k / 1000;
            advance(world, 0.05 + 0.012 * (1 - std::cos(phase)), 0.09 + 0.006 * (1 - std::cos(phase)), 1e-4);
            turned_over = std::max({turned_over, std::abs(energy().hand), energy().outside, std::abs(energy().wire)});
        }
        CHECK(std::abs(energy().hand) > 1e-9);
        CHECK(std::abs(energy().scheme) < 0.01 * turned_over);
    }

    TEST_CASE("property: a run goes on with the same bits from a saved state")
    {
        WorldSetup setup = pair_of(0.05, 0.09);
        setup.wires[1].loads.push_back(at_tip({0, 1e-3, 2e-3}));
        const auto on = [](World& world, int from, int to) {
            for (int k = from; k < to; ++k) advance(world, 0.05 + 3e-5 * k, 0.09 + 2e-5 * k, 2e-4);
        };
        const TakenUp runs(setup, on, 90, 160);
        CHECK(runs.second.readings(0).energy.hand == runs.whole.readings(0).energy.hand);
    }

    TEST_CASE("property: energy-momentum and explicit steps are refused, holds with Newmark's are")
    {
        WorldSetup setup = pair_of(0.05, 0.09);
        setup.integrator.newmark = false;
        setup.integrator.conserve = true;
        CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("newton (backward Euler or Newmark's) or static"), Error);
        setup.integrator.conserve = false;
        setup.integrator.scheme = Scheme::Explicit;
        CHECK_THROWS_AS(World{setup}, Error);
        setup = pair_of(0.05, 0.09);
        setup.wires[1].holds.push_back({});
        setup.wires[1].holds.back().at.kind = WirePoint::Kind::Tip;
        setup.wires[1].holds.back().position = true;
        CHECK_THROWS_WITH_AS(World{setup}, doctest::Contains("wires[1].holds: got holds; expected none"), Error);
    }
}

}  // namespace seldinger::test::test_merged_newmark
