// The published first experiment, shortened: a wire fed level into a cylinder droops to its floor, then slides along it.

#include "support/world_fixture.h"

namespace seldinger::test::test_experiment1 {

TEST_SUITE("step/experiment1")
{
    TEST_CASE("analytic: first touch at 3.0 cm, then friction grows by mu rho g A per metre")
    {
        TestSetup setup;
        const VesselSpec spec = tube(0.018, 0.30, 35000);
        add_tube(setup, spec);
        WireSpec wire = steel_wire(0.30, 61);
        wire.shaft.radius = 1e-3;
        wire.shaft.stretch_stiffness = 5e4;
        // 2.452 mm above where the axis comes to rest: w L^4 / (8 B) of 3.0 cm
        TestWire fed = fed_wire(wire, {0.0005, 0, -0.014548}, 0.02, 0, 12);
        fed.contact.rolling = true;
        setup.wires = {fed};
        FedWorld world(std::move(setup));
        double first = 0, at_8 = 0, at_10 = 0;
        for (int k = 1; k <= 5000; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            const WireReadings now = world.readings(0);
            if (first == 0 && now.contacts > 0) first = now.inserted;
            if (k > 3900 && k <= 4100) at_8 += now.friction / 200;
            if (k > 4800 && k <= 5000) at_10 += now.friction / 200;
        }
        CHECK(std::abs(first - 0.030) <= 0.001);
        // mu_sliding rho g A = 0.0487 N/m, and 1.2 % more because friction's own push unloads the base
        const double slope = (at_10 - at_8) / (0.098 - 0.080);
        CHECK(slope == about(0.0493).epsilon(0.04));
        MESSAGE("first touch at " << 1e3 * first << " mm, friction slope " << slope << " N/m");
    }
}

}  // namespace seldinger::test::test_experiment1
