// A static run in contact with friction: its work, and its readings on the way.
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

namespace seldinger::test::test_static_drag {

namespace {

constexpr double mu = 0.2, distance = 0.01;  // [-], that the base is pulled by [m]

/// A wire that lies in a tube by its weight, pulled along.
Scene dragged()
{
    return read_scene_text(
        "[integrator]\nscheme = \"static\"\n"
        "[wire]\npreset = \"bentson-035\"\nlength_m = 0.1\nmu_sliding = 0.2\nmu_static = 0.2\nnodes = 81\n"
        "[wire.place]\nshape = \"straight\"\nbase = [0.105, 0.0, -0.0035]\ndirection = [-1.0, 0.0, 0.0]\n"
        "[vessel]\nshape = \"tube\"\nradius_m = 0.004\nlength_m = 0.2\naxis = [1.0, 0.0, 0.0]\ntriangles = 8000\n"
        "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nmove = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.01, 0.0, 0.0]]\n",
        "drag.toml");
}

}  // namespace

TEST_SUITE("step/static_drag")
{
    // A wire that slides all the way loses mu N d; less before it slides, over the stretch of its contacts, which is below a
    // percent of the way. The hold's work is that and what the wire stores; it is taken by the mean of the forces at both ends of
    // each of some twenty parts of the path, of which the first begins without friction: half a part.
    TEST_CASE(
        "analytic: friction takes mu N d of the work of a hold that drags a wire, and readings on the way belong to their own "
        "equilibrium")
    {
        World world(make_setup(dragged()));
        int seen = 0;
        Output now;
        const StepReport report = settle(world, [&](int, double) {
            world.read(now, Output::Loads);
            CHECK((now.wires[0].report.flags & StepContactSums) == 0);
            CHECK(now.wires[0].on_wall.patch_force > 0);
            ++seen;
        });
        REQUIRE_FALSE(report.failed());
        REQUIRE(seen > 0);
        const WireReadings readings = world.readings(0);
        const double lost = mu * readings.normal * distance;
        REQUIRE(lost > 1e-6);
        CHECK(readings.energy.friction == test::about(lost).epsilon(0.01));
        CHECK(readings.energy.outside == test::about(lost).epsilon(0.04));
    }
}

}  // namespace seldinger::test::test_static_drag
