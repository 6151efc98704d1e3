// Work of hands that turn curved instruments against each other: it is what they store, whichever of them is turned.
#include "coaxial/merged_fixture.h"

namespace seldinger::test::test_turning_work {

TEST_SUITE("coaxial/turning work")
{
    // Curved alike, both lie unstressed. Turned against each other by the angle a they store, where they hardly twist,
    // B_r |k - k exp(i a)|^2/2 per length, B_r = B B'/(B + B'): for a right angle B_r k^2.
    TEST_CASE("analytic: a right angle between two instruments curved alike costs B_r k^2 per length, turned by either hand")
    {
        constexpr double curved = 0.03, curvature = 10, outer = 2e-4, inner = 1e-4, twists = 50;
        const double expected = outer * inner / (outer + inner) * curvature * curvature * curved;
        for (const int turned : {0, 1})
            for (const double angle : {pi / 2, -pi / 2}) {
                CAPTURE(turned);
                CAPTURE(angle);
                WorldSetup setup = merged_setup({instrument_of(0.1, outer, twists * outer, curved, curvature),
                                                 instrument_of(0.1, inner, twists * inner, curved, curvature)},
                                                {0.05, 0.05}, 2.5e-3, Scheme::Newton);
                setup.start_settled = true;
                World world(setup);
                REQUIRE_FALSE(settle(world).failed());
                CHECK(world.readings(0).elastic < 1e-3 * expected);
                turn_slowly(world, turned, 0.05, 0, angle, 100);
                const WireReadings now = world.readings(0);
                // they twist by some (k L)^2/(2 twists) of a radian, 1 %
                CHECK(now.elastic == about(expected).epsilon(0.03));
                // what is moving takes energy along that backward Euler loses
                CHECK(now.energy.hand == about(now.elastic + now.kinetic + now.energy.scheme).epsilon(0.01));
                CHECK(now.energy.scheme < 0.1 * expected);
                CHECK(world.readings(turned).turned == about(angle).epsilon(1e-12));
                CHECK(world.readings(1 - turned).turned == 0);
                // what one hand turns with the other holds against
                CHECK(world.readings(0).hand_torque == about(-world.readings(1).hand_torque).epsilon(1e-4));
            }
    }
}

}  // namespace seldinger::test::test_turning_work
