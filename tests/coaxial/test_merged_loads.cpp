// Loads and links on instruments that share one centreline: each acts on a place of its instrument's material.

#include "coaxial/straight_pair.h"

#include <algorithm>
#include <cmath>

namespace seldinger::test::test_merged_loads {

namespace {

LoadSpec load_at(double from_tip, const Vec3& force, const Vec3& moment = Vec3::Zero())
{
    return {.at = {WirePoint::Kind::Distance, from_tip}, .force = force, .moment = moment};
}

/// Height of an instrument's material so far from its own tip.
double height(const World& world, int wire, double s) { return material_at(world, wire, s).z(); }

}  // namespace

TEST_SUITE("coaxial/merged loads")
{
    // A cantilever of B over `a` and of B/3 beyond it, to `x`: F x^3/3 by parts. A load between nodes and a change inside an edge
    // are exact to (edge/length)^2; gone on with, the line is as long as its births leave it, to 0.1 %.
    TEST_CASE("analytic: a force on an instrument's material bends the line where that is, as it goes on")
    {
        const double a = 0.05, force = 2e-4;
        const auto expected = [&](double inner) {  // 10 mm behind the inner one's tip
            const double x = inner - 0.01, both = 1.5 * bend, alone = 0.5 * bend, beyond = std::pow(std::max(0.0, x - a), 3);
            return force * ((x * x * x - beyond) / (3 * both) + beyond / (3 * alone));
        };
        for (int k = -10; k <= 20; k += 3) {
            const double inner = 0.05 + 1e-3 * k;
            WorldSetup setup = straight_pair(a, inner);
            setup.wires[1].loads.push_back(load_at(0.01, {0, 0, force}));
            World world(setup);
            advance(world, a, inner);
            CHECK(height(world, 1, 0.01) == about(expected(inner)).epsilon(3e-3));  // 30 mm: (2/30)^2 / 2
        }
        WorldSetup setup = straight_pair(a, 0.045, Scheme::Newton);
        setup.integrator.damping_mass = 200;  // [1/s], the slowest mode's 2 pi 60 Hz: at rest within 50 ms
        setup.wires[1].loads.push_back(load_at(0.01, {0, 0, force}));
        World world(setup);
        for (int k = 1; k <= 3000; ++k) {
            const double inner = 0.045 + 1e-5 * std::min(k, 2500);
            advance(world, a, inner);
            if (k % 500 == 0) CHECK(height(world, 1, 0.01) == about(expected(inner)).epsilon(0.01));
        }
    }

    // The outer one's hand holds what pulls at the outer one; the inner one's what pulls at that, wherever the line's tip is.
    TEST_CASE("analytic: hands hold what pulls at their own instrument, and turn what twists it")
    {
        for (const double inner : {0.03, 0.07}) {
            WorldSetup setup = straight_pair(0.05, inner);
            setup.wires[0].loads.push_back(load_at(0.02, {3e-3, 0, 0}, {4e-6, 0, 0}));
            setup.wires[1].loads.push_back(load_at(0.01, {-5e-3, 0, 0}, {-1e-6, 0, 0}));
            World world(setup);
            for (int k = 0; k < 3; ++k) advance(world, 0.05, inner);
            CHECK(world.readings(0).hand_force == about(-3e-3).epsilon(1e-4));
            CHECK(world.readings(1).hand_force == about(5e-3).epsilon(1e-4));
            CHECK(world.readings(0).hand_torque == about(-4e-6).epsilon(1e-4));
            CHECK(world.readings(1).hand_torque == about(1e-6).epsilon(1e-4));
            // twisted over the way from its hub, theta being against turns
            CHECK(-world.rod(1).theta[0] == about(-1e-6 * (inner - 0.01) / (0.5 * twist)).epsilon(0.06));  // half an edge
        }
    }

    // A cantilever of B under F across its tip feels -F^2 L^2/(2 B) at its hand: the slope there takes F along. What goes on from
    // there is a thread, which holds nothing and whose hand feels nothing, wherever the tip is between two nodes. Slopes are
    // right to their square, 0.4 %, and a spring instead of the force pulls 0.5 % more along than across.
    TEST_CASE("analytic: what pulls across the tip of a catheter is the catheter's alone, though a thread goes on from there")
    {
        const double stiffness = 1e-2, force = 0.5;
        for (const bool spring : {false, true})
            for (int k = 0; k < 8; ++k) {
                const double length = 0.05 + 2.5e-4 * k, height_of_tip = force * std::pow(length, 3) / (3 * stiffness);
                CAPTURE(k);
                CAPTURE(spring);
                WorldSetup setup = merged_setup({instrument_of({{0.4, stiffness, 0}}, 1), instrument_of({{0.6, 1e-8, 0}}, 1)},
                                                {length, 0.06}, 2e-3, Scheme::Static);
                for (WireSectionRange& range : setup.wires[1].wire.sections) range.section.stretch_stiffness = 2e4;
                setup.wires[1].wire.shaft.stretch_stiffness = 2e4;
                setup.integrator.tolerance = 1e-9;
                LinkSpec link{.at = {WirePoint::Kind::Tip}, .stiffness = 5};
                link.anchor = {length, 0, height_of_tip + force / link.stiffness};
                if (spring) setup.wires[0].links.push_back(link);
                else setup.wires[0].loads.push_back(load_at(0, {0, 0, force}));
                World world(setup);
                for (int i = 0; i < 3; ++i) advance(world, length, 0.06);
                CHECK(world.readings(0).hand_force == about(-force * force * length * length / (2 * stiffness)).epsilon(0.02));
                CHECK(std::abs(world.readings(1).hand_force) < 1e-3 * force);
            }
    }

    TEST_CASE("analytic: a dead moment bends by m L^2/(2 B) wherever it acts, and a link is a spring")
    {
        const double length = 0.06, moment = 1e-5, both = 1.5 * bend;
        WorldSetup setup = straight_pair(length, length);
        setup.wires[1].loads.push_back({.at = {WirePoint::Kind::Tip}, .moment = {0, -moment, 0}});
        World bent(setup);
        for (int k = 0; k < 3; ++k) advance(bent, length, length);
        // on the last edge, of 2 mm: that is bent half an edge less
        CHECK(bent.rod(1).z[0] == about(moment * (length * length - 1e-6) / (2 * both)).epsilon(2e-3));

        setup.wires[1].loads.clear();
        LinkSpec link;
        link.at.kind = WirePoint::Kind::Tip;
        link.stiffness = 3 * both / std::pow(length, 3);  // as stiff as the pair
        link.anchor = {length, 0, 2e-3};
        setup.wires[1].links.push_back(link);
        World tied(setup);
        for (int k = 0; k < 3; ++k) advance(tied, length, length);
        CHECK(tied.rod(1).z[0] == about(1e-3).epsilon(2e-3));
        CHECK(tied.readings(0).momentum.loads.z() == about(1e-3 * link.stiffness).epsilon(2e-3));
        CHECK(tied.readings(0).momentum.error().norm() < 1e-8);
    }

    // Both advance and turn while the one is pulled at, twisted and tied: works and energies add up.
    TEST_CASE("property: energies and momentum are closed under loads and links that go along")
    {
        WorldSetup setup = straight_pair(0.05, 0.06, Scheme::Newton);
        setup.integrator.damping_mass = 20;
        setup.wires[0].loads.push_back(load_at(0.005, {0, 2e-4, 1e-4}, {2e-6, 1e-6, 0}));
        setup.wires[1].loads.push_back(load_at(0.015, {2e-3, 0, 3e-4}, {-2e-6, 0, 1e-6}));
        setup.wires[1].links.push_back({.at = {WirePoint::Kind::Tip}, .anchor = {0.08, 0.01, 0.005}, .stiffness = 0.2});
        World world(setup);
        CHECK(swing_through_each_other(world, 1000, 500, 0.01) < 1e-6);
        const EnergyLedger& ledger = world.readings(0).energy;
        const double turned_over =
            std::max({std::abs(ledger.hand), std::abs(ledger.outside), std::abs(ledger.wire), ledger.damping});
        CHECK(std::abs(ledger.outside) > 1e-6);
        // most of it in the first step: half an edge in the inlet is set moving by no force that shows
        CHECK(std::abs(ledger.open()) < 0.004 * turned_over);
    }

    TEST_CASE("property: a load beyond the instrument is refused")
    {
        WorldSetup setup = straight_pair(0.05, 0.06);
        setup.wires[1].loads.push_back(load_at(0.7, {0, 0, 1}));
        CHECK_THROWS_AS(World{setup}, Error);
    }
}

}  // namespace seldinger::test::test_merged_loads
