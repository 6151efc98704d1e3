// A step that is ended from outside leaves the world as it was before, bit for bit.

#include "support/approx.h"
#include "support/world_fixture.h"

namespace seldinger::test::test_stopped_step {

namespace {

/// A wire that is pushed through a bend. @param parts  whether a step feeds several edges, and so goes in several sub-steps
TestSetup pushed(bool parts)
{
    TestSetup setup = in_bend(2e-3, 0.03);
    setup.wires.push_back(fed_wire(steel_wire(0.2, 81), {0.0001, 0, 0}, parts ? 3.0 : 0.2));
    return setup;
}

}  // namespace

TEST_SUITE("step/stopped_step")
{
    TEST_CASE("property: whenever a step is ended, the state is that before it, and the run goes on with the same bits")
    {
        for (const bool parts : {false, true}) {
            CAPTURE(parts);
            const double dt = 2e-3;
            const int steps = parts ? 12 : 60;
            FedWorld plain(pushed(parts)), stopped(pushed(parts));
            int asked = 0, end_at = -1, ended = 0, divided = 0, most_asked = 0;
            stopped.stop_when([&] { return ++asked == end_at; });
            for (int k = 0; k < steps; ++k) {
                const StepReport expected = step(plain, dt);
                REQUIRE_FALSE(expected.failed());
                divided += expected.sub_steps > 1;
                for (int at = 1;; at += at > 3 ? 5 : 1) {  // the first trials, and some later ones
                    const std::string before = stopped.state_hash();
                    const std::vector<std::uint8_t> bytes = stopped.save_state();
                    asked = 0;
                    end_at = at;
                    const StepReport report = step(stopped, dt);
                    most_asked = std::max(most_asked, asked);
                    if (!(report.flags & StepStopped)) break;
                    ++ended;
                    CHECK(stopped.state_hash() == before);
                    CHECK(stopped.save_state() == bytes);
                    CHECK(stopped.time() == about(k * dt));
                }
                CHECK(stopped.state_hash() == plain.state_hash());
            }
            REQUIRE(ended > steps);
            REQUIRE(most_asked > 2);
            REQUIRE((divided > 0) == parts);
        }
    }

    // What a step has looked up on an elastic wall before it was stopped must not be where the next attempt begins.
    TEST_CASE("property: on an elastic wall, too")
    {
        TestSetup setup = pushed(false);
        setup.vessel.elastic = true;
        setup.vessel.youngs = 4e5;
        setup.vessel.thickness = 5e-4;
        setup.vessel.wall_edge = 1.5e-3;
        FedWorld plain(setup), stopped(setup);
        int asked = 0, end_at = -1, ended = 0;
        stopped.stop_when([&] { return ++asked == end_at; });
        for (int k = 0; k < 150; ++k) {
            REQUIRE_FALSE(step(plain, 2e-3).failed());
            for (int at = 1;; at += at > 3 ? 5 : 1) {
                const std::vector<std::uint8_t> bytes = stopped.save_state();
                asked = 0;
                end_at = at;
                if (!(step(stopped, 2e-3).flags & StepStopped)) break;
                ++ended;
                CHECK(stopped.save_state() == bytes);
            }
            CHECK(stopped.state_hash() == plain.state_hash());
        }
        REQUIRE(plain.wall_readings().move_max > 0);
        REQUIRE(ended > 150);
    }

    TEST_CASE("property: with other systems in the world none of them advances")
    {
        TestSetup setup = pushed(false);
        setup.wires.push_back(fed_wire(steel_wire(0.2, 41), {0.0001, 0, 0}, 0.1));
        FedWorld world(setup);
        bool end = false;
        int asked = 0;
        world.stop_when([&] { return end && ++asked > 1; });
        for (int k = 0; k < 30; ++k) REQUIRE_FALSE(step(world, 2e-3).failed());
        const std::string before = world.state_hash();
        end = true;
        CHECK((step(world, 2e-3).flags & StepStopped) != 0);
        CHECK(world.state_hash() == before);
    }
}

}  // namespace seldinger::test::test_stopped_step
