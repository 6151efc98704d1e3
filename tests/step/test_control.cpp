// control.h through step(): a hand that is asked step by step against a path that is known beforehand, and its readings.

#include "support/approx.h"
#include "support/world_fixture.h"

#include <cmath>

namespace seldinger::test::test_control {

namespace {

constexpr double speed = 0.1, rate = 2.0;  // [m/s], [rad/s]

TestSetup in_a_bend()
{
    TestSetup setup = in_bend(0.005, 0.04);
    setup.wires = {fed_wire(steel_wire(0.12, 25), {0.0005, 0, -0.0024}, speed, rate)};
    return setup;
}

}  // namespace

TEST_SUITE("step/control")
{
    // The keys say where the hub is at t; the hand is sent there step by step. Both know as much of the next step as the engine
    // wants to know: the speed is steady. What differs is the rounding of sums, 1e-16 m of a rest length of millimetres against
    // EA = 1e4 N, and what 700 steps make of it.
    TEST_CASE("property: a hand that asks for each step's end does what key frames do")
    {
        FedWorld keyed(in_a_bend());
        World handled{WorldSetup(in_a_bend())};
        Control control;
        for (int k = 1; k <= 700; ++k) {
            REQUIRE_FALSE(step(keyed, 1e-3).failed());
            control.move_to(0, speed * k * 1e-3, rate * k * 1e-3);
            REQUIRE_FALSE(step(handled, control, 1e-3).failed());
        }
        REQUIRE(keyed.readings(0).contacts > 0);
        CHECK(handled.readings(0).inserted == about(speed * 0.7).epsilon(1e-12));
        CHECK(handled.readings(0).turned == about(rate * 0.7).epsilon(1e-12));
        CHECK(handled.readings(0).nodes == keyed.readings(0).nodes);
        CHECK((handled.rod(0).pos(0) - keyed.rod(0).pos(0)).norm() < 1e-7);
        CHECK(handled.readings(0).hand_force == about(keyed.readings(0).hand_force).epsilon(1e-3));
    }

    TEST_CASE("property: asked for nothing, a hub stays where it is to the last bit")
    {
        FedWorld world(in_a_bend());
        for (int k = 0; k < 300; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const double inserted = world.readings(0).inserted, turned = world.readings(0).turned;
        for (int k = 0; k < 50; ++k) REQUIRE_FALSE(seldinger::step(world, 1e-3).failed());
        CHECK(world.readings(0).inserted == inserted);
        CHECK(world.readings(0).turned == turned);
    }

    TEST_CASE("property: a jump by many edges goes in parts and ends where it was asked to")
    {
        World world{WorldSetup(in_a_bend())};
        Control control;
        control.move_to(0, 0.03, 0);  // six edges of 5 mm in one step
        const StepReport report = step(world, control, 0.1);
        REQUIRE_FALSE(report.failed());
        CHECK(report.sub_steps >= 6);
        CHECK(world.readings(0).inserted == about(0.03).epsilon(1e-12));
        control.move_to(0, 0.012, 0);
        REQUIRE_FALSE(step(world, control, 0.1).failed());
        CHECK(world.readings(0).inserted == about(0.012).epsilon(1e-12));
    }

    TEST_CASE("property: an output is a copy of what the views show, and later steps leave it alone")
    {
        FedWorld world(in_a_bend());
        for (int k = 0; k < 500; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const Output out = world.output();
        const ConstRodView rod = world.rod(0);
        REQUIRE(out.wires.size() == 1);
        const WireOutput& wire = out.wires[0];
        REQUIRE(static_cast<int>(wire.position.size()) == rod.n);
        REQUIRE(out.contacts.size() > 0);
        CHECK(out.contacts.size() == world.contacts().size());
        CHECK(out.step == 500);
        CHECK(out.time == world.time());
        CHECK(wire.readings.hand_force == world.readings(0).hand_force);
        for (int i = 0; i < rod.n; ++i) {
            CHECK(wire.position[i] == rod.pos(i));
            CHECK(wire.contact_force[i] == world.nodal_contact_force(0)[i]);
        }
        const Vec3 tip = wire.tip;
        REQUIRE_FALSE(step(world, 1e-3).failed());
        CHECK(wire.position[0] == tip);
        CHECK(world.rod(0).pos(0) != tip);
        Output numbers;
        world.read(numbers, Output::Numbers);
        CHECK(numbers.wires[0].position.empty());
        CHECK(numbers.contacts.empty());
        CHECK(numbers.wires[0].readings.nodes == world.readings(0).nodes);
    }
}

}  // namespace seldinger::test::test_control
