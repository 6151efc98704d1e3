// Scenes in which other simulators are known to lose a wire.

#include "failure/hard_vessels.h"
#include "failure/watched_run.h"

namespace seldinger::test::test_reproducers {

namespace {

WireSpec thick_wire()
{
    WireSpec wire = steel_wire(0.1, 51);
    wire.shaft.radius = 0.6e-3;
    wire.shaft.bend_stiffness = 1e-4;
    wire.shaft.twist_stiffness = 7.7e-5;
    return wire;
}

}  // namespace

// A known reproducer of tunnelling: two capsules of 1.2 mm in a channel of 8 x 8 mm, pushed hard at 240 steps a second. Wires do
// not touch each other here, so it is each of them against the channel.
TEST_SUITE("failure/reproducers")
{
    TEST_CASE(
        "property: two wires of 1.2 mm in a channel of 8 x 8 mm, tips held, bases driven in by 0.83 mm a step of 1/240 s, stay "
        "inside")
    {
        TestSetup setup;
        use_mesh(setup, box_channel(0.16, -0.004, 0.004, -0.004, 0.004, 16));
        for (const double side : {-1.0, 1.0}) {
            TestWire wire = placed_wire(thick_wire(), {0.02, 1.5e-3 * side, 1e-3 * side});
            HoldSpec base, tip;
            base.position = base.direction = true;
            base.velocity = {0.2, 0, 0};
            tip.at.kind = WirePoint::Kind::Tip;
            tip.position = true;
            wire.holds = {base, tip};
            setup.wires.push_back(wire);
        }
        for (const NormalLaw law : {NormalLaw::HuntCrossley, NormalLaw::Barrier}) {
            Method method = standard;
            method.normal = law;
            WatchedRun run(setup, method, 1.0 / 240);
            run.run(9);
            const Outcomes o = run.outcomes();
            MESSAGE("two wires, " << std::string(law == NormalLaw::Barrier ? "barrier" : "default") << ": " << tell(o));
            for (const Verdict& verdict : o.wires) {
                CHECK_FALSE(verdict.had(Outcome::Escape));
                CHECK_FALSE(verdict.had(Outcome::GaveUp));
                CHECK(verdict.readings.outside == 0);
                CHECK(verdict.readings.hand_force > 4);  // pushed hard: 4 pi^2 B / L^2 = 0.4 N would do to buckle it
                if (law == NormalLaw::Barrier) CHECK(verdict.readings.overlap == 0);
            }
            // samples keep r - depth_max = r / 2 from the wall; between two of them a bent edge bulges by less than 10 %
            CHECK(o.nearest > 0.4 * 0.6e-3);
        }
    }

    // The corners of the channel's end are where three walls meet at right angles: which of them are one side of the lumen and
    // which the other must not hang on rounding.
    TEST_CASE("regression: both are fed head on into the channel's closed end and pile up in its corners without a step given up")
    {
        TestSetup setup;
        WallMesh channel = box_channel(0.06, -0.004, 0.004, -0.004, 0.004, 12);
        const int end = static_cast<int>(channel.vertices.size()) - 4;
        channel.triangles.push_back({end, end + 2, end + 1});
        channel.triangles.push_back({end, end + 3, end + 2});
        use_mesh(setup, channel);
        for (const double side : {-1.0, 1.0}) {
            setup.wires.push_back(fed_wire(thick_wire(), {0.0005, 1.5e-3 * side, 1e-3 * side}, 0.2, side));
            setup.wires.back().feed.keys = {{0, 0, 0}, {0.275, 0.055, 0}, {0.475, 0.095, 0.5 * side}};
        }
        WatchedRun run(setup, standard, 1.0 / 240);
        run.run(88);  // 73 mm
        const Outcomes o = run.outcomes();
        MESSAGE("closed channel: " << tell(o));
        for (const Verdict& verdict : o.wires) {
            CHECK_FALSE(verdict.had(Outcome::Escape));
            CHECK_FALSE(verdict.had(Outcome::GaveUp));
            CHECK(verdict.readings.hand_force > 1);
            CHECK(verdict.readings.sub_steps <= 64);
        }
        CHECK(o.nearest > 0.4 * 0.6e-3);
    }
}

}  // namespace seldinger::test::test_reproducers
