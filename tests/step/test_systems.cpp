// Systems of several instruments: fed in the same parts, halved, put back, retired and hashed as one.

#include "support/approx.h"
#include "support/world_fixture.h"

namespace seldinger::test::test_systems {

namespace {

/// Two wires beside each other in a wide tube, which have nothing to do with each other but the system that they are in.
TestSetup pair_in_a_tube(bool one_system)
{
    TestSetup setup = in_tube(0.005, 0.3, 6000);
    setup.wires = {fed_wire(steel_wire(0.1, 21), {0.0005, 1e-3, -0.0042}, 0.1, 1.0),
                   fed_wire(steel_wire(0.1, 21), {0.0005, -1e-3, -0.0042}, 0.07)};
    if (one_system) setup.systems = {2};
    return setup;
}

}  // namespace

TEST_SUITE("step/systems")
{
    // Newton's method ends when the larger of the two residuals meets the tolerance. So the other is solved at least as well as
    // alone: forces of both runs differ by the residuals, 1e-6 of the force scale a step.
    TEST_CASE("property: instruments of one system that do not touch move as they do apart")
    {
        FedWorld apart(pair_in_a_tube(false)), together(pair_in_a_tube(true));
        CHECK(apart.system_count() == 2);
        CHECK(together.system_count() == 1);
        CHECK(together.system_of(1) == 0);
        for (int k = 0; k < 400; ++k) {
            REQUIRE_FALSE(step(apart, 1e-3).failed());
            REQUIRE_FALSE(step(together, 1e-3).failed());
        }
        for (int w = 0; w < 2; ++w) {
            REQUIRE(apart.readings(w).contacts > 0);
            CHECK(together.readings(w).nodes == apart.readings(w).nodes);
            CHECK((together.rod(w).pos(0) - apart.rod(w).pos(0)).norm() < 1e-6);
            CHECK(together.readings(w).normal == about(apart.readings(w).normal).epsilon(1e-2));
        }
    }

    TEST_CASE("property: what asks for parts of one instrument asks for parts of its system")
    {
        FedWorld apart(pair_in_a_tube(false)), together(pair_in_a_tube(true));
        Control jump;
        jump.move_to(0, 0.02, 0).move_to(1, 0.001, 0);
        REQUIRE_FALSE(seldinger::step(apart, jump, 0.1).failed());
        REQUIRE_FALSE(seldinger::step(together, jump, 0.1).failed());
        REQUIRE(apart.report(0).sub_steps > 1);
        CHECK(apart.report(1).sub_steps == 1);
        CHECK(together.report(1).sub_steps == together.report(0).sub_steps);
        CHECK(together.readings(1).inserted == about(0.001).epsilon(1e-12));
    }

    TEST_CASE("property: a system is retired and hashed as a whole, and saved with the rest")
    {
        FedWorld world(pair_in_a_tube(true));
        TestSetup with_another = pair_in_a_tube(true);
        with_another.wires.push_back(fed_wire(steel_wire(0.1, 21), {0.0005, 0, 0.002}, 0.09));
        with_another.systems = {2, 1};
        FedWorld crowd(with_another);
        for (int k = 0; k < 100; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            REQUIRE_FALSE(step(crowd, 1e-3).failed());
        }
        CHECK(crowd.state_hash(0) == world.state_hash(0));  // whoever else is there
        CHECK(crowd.state_hash(1) != world.state_hash(0));
        const auto saved = world.save_state();
        const std::string then = world.state_hash();
        for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        const std::string later = world.state_hash();
        world.restore_state(saved);
        CHECK(world.state_hash() == then);
        for (int k = 0; k < 20; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        CHECK(world.state_hash() == later);
        world.retire(0);
        CHECK(world.retired(0));
        const Vec3 tips[] = {world.rod(0).pos(0), world.rod(1).pos(0)};
        REQUIRE_FALSE(step(world, 1e-3).failed());
        for (int w = 0; w < 2; ++w) CHECK(world.rod(w).pos(0) == tips[w]);
    }
}

}  // namespace seldinger::test::test_systems
