// A wire that has no equilibrium: the settling says so, and the wire is where it was; its neighbour settles all the same.
#include "support/world_fixture.h"

namespace seldinger::test::test_without_equilibrium {

TEST_SUITE("step/settle")
{
    TEST_CASE(
        "property: a free wire under its weight has no equilibrium and is told so; one that is held sags as a cantilever does")
    {
        TestSetup setup;
        setup.wires = {placed_wire(steel_wire(0.05, 21), Vec3(0, 0, 0)), placed_wire(steel_wire(0.05, 21), Vec3(0, 0.1, 0))};
        HoldSpec hold{.at = {WirePoint::Kind::Base}, .position = true, .direction = true, .spin = true};
        setup.wires[1].holds = {hold};
        FedWorld world(std::move(setup));
        std::vector<Vec3> before;
        for (int i = 0; i < world.rod(0).n; ++i) before.push_back(world.rod(0).pos(i));
        const StepReport report = settle(world);
        CHECK(report.failed());
        CHECK(world.report(0).failed());
        CHECK_FALSE(world.report(1).failed());
        for (int i = 0; i < world.rod(0).n; ++i) CHECK(world.rod(0).pos(i) == before[static_cast<std::size_t>(i)]);
        // q L^4/(8 B); the droop of 3 mm in 50 is straight enough for 1 %
        const double q = 7900 * 9.81 * std::numbers::pi * 0.4445e-3 * 0.4445e-3, droop = q * std::pow(0.05, 4) / (8 * 1e-5);
        CHECK(-world.rod(1).pos(0).z() == about(droop).epsilon(0.02));
        // What is tried again for the one is no matter of the other's: it is where it is when it settles alone.
        TestSetup alone;
        alone.wires = {placed_wire(steel_wire(0.05, 21), Vec3(0, 0.1, 0))};
        alone.wires[0].holds = {hold};
        FedWorld other(std::move(alone));
        CHECK_FALSE(settle(other).failed());
        for (int i = 0; i < other.rod(0).n; ++i) CHECK(other.rod(0).pos(i) == world.rod(1).pos(i));
    }
}

}  // namespace seldinger::test::test_without_equilibrium
