// Energies of a static run beside an elastic wall.
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

#include <doctest/doctest.h>

namespace test_static_wall {

using namespace seldinger;

namespace {

/// A wire over a plate, whose base is pressed down by half a millimetre.
Scene pressed()
{
    return read_scene_text("[scene]\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n"
                           "[wire]\nlength_m = 0.04\nradius_m = 0.0005\ndensity = 7900.0\nbend_nm2 = 2e-5\ntwist_nm2 = 2e-5\nstretch_n = 1e4\n"
                           "nodes = 41\n"
                           "[wire.place]\nshape = \"straight\"\nbase = [-0.02, 0.0, 0.00055]\ndirection = [1.0, 0.0, 0.0]\n"
                           "[vessel]\nshape = \"plane\"\nsize_m = 0.08\ntriangles = 800\nwall = \"elastic\"\nyoungs_pa = 1e6\npoisson = 0.45\n"
                           "thickness_m = 0.0015\nsupport_pa_m = 1e6\nwall_edge_m = 0.003\n"
                           "[contact]\nfriction = \"none\"\n"
                           "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nmove = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -0.0005]]\n",
                           "pressed.toml");
}

}  // namespace

TEST_SUITE("step/static_wall")
{
    // Without friction all forces are elastic: what the hold does is stored. Means of the wall's forces at both ends of a part of the path are exact in linear
    // theory; what large displacements add is a few per cent of the force here, and a mean misses about 1/100 of that. The contact law's work is taken by the
    // force at the end of each part: more than the law stores, since the force rises.
    TEST_CASE("analytic: a hold that presses a wire on an elastic plate does the work that both store")
    {
        World world(make_setup(pressed()));
        const StepReport report = settle(world);
        REQUIRE_FALSE(report.failed());
        const WireReadings wire = world.readings(0);
        Output now;
        world.read(now, Output::Everything);
        const WallReadings& wall = now.walls.front().readings;
        REQUIRE(wall.energy > 1e-8);
        REQUIRE(wire.energy.outside > wall.energy);
        CHECK(wire.energy.wall == test::about(wall.energy).epsilon(1e-3));
        CHECK(std::abs(wall.loss) < 1e-3 * wall.energy);
        const double in_contact = wire.energy.outside - wire.energy.wire - wall.energy;
        CHECK(in_contact > 0);
        CHECK(in_contact < wire.energy.contact);
    }
}

}  // namespace test_static_wall
