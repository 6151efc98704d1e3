// energy_audit.h through step(): runs that make energy end, runs that do not are left alone, and feeding makes none.

#include "support/world_fixture.h"

#include <algorithm>

namespace seldinger::test::test_energy_audit {

namespace {

/// The wire of the published experiments, fed at 2 cm/s.
TestWire published_wire(double advance)
{
    WireSpec spec = steel_wire(0.3, 61);
    spec.shaft.radius = 1e-3;
    spec.shaft.stretch_stiffness = 5e4;
    TestWire wire = fed_wire(spec, {0.0005, 0, -0.014548}, 0.02);
    for (FeedKey& key : wire.feed.keys) key.advance += advance;
    return wire;
}

/// It lies on the floor of a cylinder when `advance` is 10 cm.
TestSetup in_the_cylinder(double advance)
{
    TestSetup setup;
    VesselSpec cylinder = tube(0.018, 0.3, 8000);
    cylinder.youngs = 1e6;
    add_tube(setup, cylinder);
    setup.wires = {published_wire(advance)};
    return setup;
}

struct Ran {
    int steps = 0;
    unsigned flags = 0;
    double kinetic = 0, made = 0, hand_force = 0;  // most
};

Ran run(FedWorld& world, int steps, double dt = 1e-3)
{
    Ran ran;
    for (; ran.steps < steps; ++ran.steps) {
        const StepReport report = step(world, dt);
        ran.flags |= report.flags;
        if (report.failed()) break;
        const WireReadings now = world.readings(0);
        ran.kinetic = std::max(ran.kinetic, now.kinetic);
        ran.made = std::max(ran.made, now.energy_made);
        ran.hand_force = std::max(ran.hand_force, std::abs(now.hand_force));
    }
    MESSAGE(ran.steps << " steps, flags " << ran.flags << ", kinetic " << ran.kinetic << " J, made " << ran.made << " J, |hand| "
                      << ran.hand_force << " N");
    return ran;
}

}  // namespace

TEST_SUITE("step/energy_audit")
{
    // Every node goes at the feed's speed and nothing is strained: no force. A base edge whose length at the start of the step is
    // measured against the rest length at its end is pressed by EA v h/l = 400 N.
    TEST_CASE("regression: energy-momentum steps feed a wire in free air without force")
    {
        TestSetup setup;
        setup.gravity = Vec3::Zero();
        setup.wires = {published_wire(0)};
        setup.integrator.conserve = true;
        FedWorld world(setup);
        const Ran ran = run(world, 1000);
        CHECK(ran.steps == 1000);
        CHECK(world.readings(0).nodes > 3);  // splits included
        CHECK(ran.hand_force < 1e-6);
        CHECK(ran.made < 1e-9);
    }

    TEST_CASE("regression: the trapezoid in contact makes energy, which ends the run; backward Euler makes none")
    {
        TestSetup setup = in_the_cylinder(0.1);
        FedWorld backward(setup);
        const Ran right = run(backward, 500);
        CHECK(right.steps == 500);
        CHECK((right.flags & (StepEnergy | StepHalved)) == 0);
        setup.integrator.newmark = true;
        FedWorld trapezoid(setup);
        const Ran wrong = run(trapezoid, 3000);
        CHECK(wrong.steps < 3000);
        CHECK((wrong.flags & StepEnergy) != 0);
        CHECK(trapezoid.report(0).failed());
        // held against 10 % of the energy turned over, and the wire's weight
        CHECK(wrong.kinetic < 1e-2);
        for (int i = 0; i < trapezoid.rod(0).n; ++i) CHECK(trapezoid.rod(0).pos(i).allFinite());
    }

    TEST_CASE("property: the audit goes on over a saved state, and has no say in what moves")
    {
        const TestSetup setup = in_the_cylinder(0.1);
        FedWorld whole(setup), begun(setup);
        (void)run(whole, 120);
        (void)run(begun, 60);
        FedWorld resumed(setup);
        resumed.restore_state(begun.save_state());
        CHECK(resumed.state_hash() == begun.state_hash());
        (void)run(resumed, 60);
        CHECK(resumed.state_hash() == whole.state_hash());
        CHECK(resumed.save_state() == whole.save_state());
    }
}

}  // namespace seldinger::test::test_energy_audit
