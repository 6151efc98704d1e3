// F4: a fast wire at dt = 1/60 s must not tunnel.

#include "support/world_fixture.h"

#include "vessel/inside.h"
#include "vessel/repair.h"

#include <doctest/doctest.h>

using namespace seldinger;
using namespace seldinger::test;

TEST_SUITE("failure/fast_tip")
{
    TEST_CASE("property: a wire shot at the wall at up to 20 m/s, dt = 1/60 s, is never outside")
    {
        for (const double speed : {0.1, 1.0, 5.0, 20.0})
            for (const int aim : {0, 1}) {
                CAPTURE(speed);
                CAPTURE(aim);
                WorldSetup setup;
                setup.dt = 1.0 / 60;
                add_tube(setup, tube(0.005, 0.3, 6000));
                WireSetup wire = placed_wire(steel_wire(0.1, 21), {0.08, 0, 0});
                // across the lumen, and nose first into the wall
                wire.wire.place.direction = aim == 0 ? Vec3(1, 0, 0) : Vec3(1, 0, 0.02).normalized();
                wire.wire.place.velocity = aim == 0 ? Vec3(0, 0.6 * speed, -0.8 * speed) : speed * Vec3(0.6, 0, 0.8);
                setup.wires = {wire};
                const LumenQuery lumen(setup.mesh, describe(setup.mesh).loops);
                const double r = wire.wire.shaft.radius;
                World world(std::move(setup));
                double nearest = 1, mass = 0;
                for (const double m : world.rod(0).mass.first(21)) mass += m;
                const double energy = 0.5 * mass * speed * speed;
                bool touched = false;  // or has lost speed in a touch within a step
                for (int k = 0; k < 40; ++k) {
                    const StepReport report = step(world, 1.0 / 60);
                    CHECK_FALSE(report.failed());
                    CHECK_FALSE((report.flags & StepWallPenetration) != 0);
                    const RodView rod = world.rod(0);
                    for (int j = 0; j + 1 < rod.n; ++j)
                        for (int part = 0; part <= 8; ++part) {
                            const LumenPlace place = lumen.locate(rod.pos(j) + part / 8.0 * (rod.pos(j + 1) - rod.pos(j)));
                            if (place.opening < 0) nearest = std::min(nearest, place.signed_distance);
                        }
                    const WireReadings now = world.readings(0);
                    touched = touched || now.contacts > 0 || now.kinetic < 0.9 * energy;
                    CHECK(world.readings(0).outside == 0);
                }
                // samples stay r - 0.95 depth_max = r - 0.475 r off; between two, one radius apart, the chord of a bent edge adds
                // nothing
                CHECK(nearest >= r / 2);
                REQUIRE(touched);
            }
    }
}
