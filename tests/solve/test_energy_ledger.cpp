// Where a wire's energy comes from and goes: each entry of the ledger is computed apart, so that the residual tests all of
// them.

#include "support/approx.h"
#include "support/fed_world.h"

#include <cmath>

namespace seldinger::test::test_energy_ledger {

namespace {

/// A floppy wire pushed and turned into a bent tube, which it has to slide along.
TestSetup pushed_wire(bool elastic)
{
    TestSetup setup;
    setup.gravity = Vec3(0, 0, -9.81);
    setup.vessel.shape = VesselShape::Arc;
    setup.vessel.radius = 0.004;
    setup.vessel.bend_radius = 0.03;
    setup.vessel.lead_in = setup.vessel.lead_out = 0.02;
    setup.vessel.angle = 1.5;
    setup.vessel.triangles = 4000;
    setup.vessel.elastic = elastic;
    setup.vessel.youngs = 0.3e6;
    setup.vessel.thickness = 0.8e-3;
    setup.vessel.wall_edge = 0.004;
    TestWire wire;
    wire.wire.length = 0.12;
    wire.wire.shaft.radius = 0.0004;
    wire.wire.shaft.density = 7900;
    wire.wire.shaft.bend_stiffness = wire.wire.shaft.twist_stiffness = 5e-4;
    wire.wire.shaft.stretch_stiffness = 1e4;
    wire.wire.nodes = 41;
    wire.feed.on = true;
    wire.feed.point = Vec3(0.001, 0, 0);
    wire.feed.keys = {{0, 0.03, 0}, {1, 0.05, 0.5}};
    setup.wires.push_back(wire);
    WorldSetup made = setup;
    load_vessel(made);
    setup.mesh = made.mesh;
    setup.centreline = made.centreline;
    return setup;
}

}  // namespace

// Equations hold at the ends of steps to the solver's tolerance of 1e-6 of the force scale. Contacts' own moves differ from
// those of the nodes by the square of an edge's turn in a step (1e-3 of a radian): below 0.1 %. The promise is 1 %.
TEST_CASE("what the hand puts in is what wire, contact and scheme have")
{
    for (const bool elastic : {false, true}) {
        CAPTURE(elastic);
        const TestSetup setup = pushed_wire(elastic);
        FedWorld world(setup);
        for (int k = 0; k < 600; ++k) REQUIRE(!step(world, 1e-3).failed());
        const EnergyLedger e = world.readings(0).energy;
        MESSAGE("hand " << 1e6 * e.hand << " uJ, wire " << 1e6 * e.wire << ", friction " << 1e6 * e.friction << ", contact "
                        << 1e6 * e.contact << ", wall " << 1e6 * e.wall << ", scheme " << 1e6 * e.scheme << ", open "
                        << 1e6 * e.open());
        CHECK(e.hand > 0);
        CHECK(e.friction > 0);
        CHECK(std::abs(e.open()) < 0.01 * e.hand);
        // the wall's own account is kept apart, of forces that agree with the wire's to the solver's tolerance
        if (!elastic) CHECK(e.wall == 0);
        const WallReadings wall = world.wall_readings(0);
        if (elastic) CHECK(wall.energy + wall.loss == about(e.wall).epsilon(1e-6));
        if (elastic) CHECK(wall.energy > 0);
    }
}

// Nothing but backward Euler takes from a wire that swings: its loss is the scheme's entry.
TEST_CASE("the ledger of a free swing has one loss, the scheme's, which falls with the step")
{
    double last = 0;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
        TestSetup setup;
        TestWire wire;
        wire.wire.length = 0.2;
        wire.wire.shaft.radius = 0.0005;
        wire.wire.shaft.density = 7900;
        wire.wire.shaft.bend_stiffness = wire.wire.shaft.twist_stiffness = 1e-3;
        wire.wire.shaft.stretch_stiffness = 1e4;
        wire.wire.nodes = 21;
        wire.wire.place.shape = PlaceShape::Straight;
        wire.wire.place.direction = Vec3(1, 0, 0);
        wire.holds.push_back({.at = {WirePoint::Kind::Base}, .position = true, .direction = true, .spin = true});
        setup.wires.push_back(wire);
        FedWorld world(setup);
        for (int k = 0; k < static_cast<int>(std::lround(0.1 / h)); ++k) REQUIRE(!step(world, h).failed());
        const EnergyLedger e = world.readings(0).energy;
        CAPTURE(h);
        CHECK(e.friction == 0);
        CHECK(e.contact == 0);
        CHECK(e.scheme > 0);
        CHECK(std::abs(e.open()) < 1e-4 * e.scheme);
        // a first-order scheme: half the step, half the loss, to the next order (omega h of the lowest mode is 0.1 to 0.02, the
        // fast ones are damped out whole at any of these steps)
        if (last > 0) CHECK(e.scheme < 0.8 * last);
        last = e.scheme;
    }
}

}  // namespace seldinger::test::test_energy_ledger
