// Scenes in which other simulators are known to lose a wire.

#include "failure/hard_vessels.h"
#include "failure/watched_run.h"

#include <doctest/doctest.h>

using namespace seldinger;
using namespace seldinger::test;

TEST_SUITE("failure/reproducers")
{
    // A known reproducer of tunnelling: two capsules of 1.2 mm in a channel of 8 x 8 mm, pushed hard at 240 steps a second. Wires do not
    // touch each other here, so it is each of them against the channel: tips held, bases driven in by 0.83 mm a step.
    TEST_CASE("property: two wires of 1.2 mm pushed hard in a channel of 8 x 8 mm at 1/240 s stay inside")
    {
        WorldSetup setup;
        use_mesh(setup, box_channel(0.16, -0.004, 0.004, -0.004, 0.004, 16));
        for (const double side : {-1.0, 1.0}) {
            WireSpec spec = steel_wire(0.1, 51);
            spec.shaft.radius = 0.6e-3;
            spec.shaft.bend_stiffness = 1e-4;
            spec.shaft.twist_stiffness = 7.7e-5;
            WireSetup wire = placed_wire(spec, {0.02, 1.5e-3 * side, 1e-3 * side});
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
            // samples keep r - depth_max = r / 2 from the wall; between two of them a bent edge bulges by less than a tenth
            CHECK(o.nearest > 0.4 * 0.6e-3);
        }
    }
}
