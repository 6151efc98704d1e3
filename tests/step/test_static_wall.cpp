// Energies of a static run beside an elastic wall, and equilibria after a saved state.
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"

#include <fmt/format.h>

namespace seldinger::test::test_static_wall {

namespace {

/// A wire over a plate, whose base is pressed down by half a millimetre and then moved along.
/// @param along  [m]  @param mu  of friction; 0: none
Scene pressed(double along = 0, double mu = 0)
{
    const std::string friction = mu > 0 ? fmt::format("mu_sliding = {0}\nmu_static = {0}\n", mu) : "";
    const std::string law = mu > 0 ? "" : "[contact]\nfriction = \"none\"\n";
    return read_scene_text(
        "[scene]\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n"
        "[wire]\nlength_m = 0.04\nradius_m = 0.0005\ndensity = 7900.0\nbend_nm2 = 2e-5\ntwist_nm2 = 2e-5\nstretch_n = 1e4\n"
        "nodes = 41\n" +
            friction +
            "[wire.place]\nshape = \"straight\"\nbase = [-0.02, 0.0, 0.00055]\ndirection = [1.0, 0.0, 0.0]\n"
            "[vessel]\nshape = \"plane\"\nsize_m = 0.08\ntriangles = 800\nwall = \"elastic\"\nyoungs_pa = 1e6\npoisson = 0.45\n"
            "thickness_m = 0.0015\nsupport_pa_m = 1e6\nwall_edge_m = 0.003\n" +
            law +
            "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\nmove = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -0.0005]" +
            (along > 0 ? fmt::format(", [2.0, {}, 0.0, -0.0005]", along) : "") + "]\n",
        "pressed.toml");
}

const WallReadings& wall_of(const World& world, Output& now)
{
    world.read(now, Output::Everything);
    return now.walls.front().readings;
}

}  // namespace

TEST_SUITE("step/static_wall")
{
    // Without friction all forces are elastic: what the hold does is stored. Means of the wall's forces at both ends of a part of
    // the path are exact in linear theory; what large displacements add is a few per cent of the force here, and a mean misses
    // about 1/100 of that. The contact law's work is taken by the force at the end of each part: more than the law stores, since
    // the force rises.
    TEST_CASE("analytic: a hold that presses a wire on an elastic plate does the work that both store")
    {
        World world(make_setup(pressed()));
        REQUIRE_FALSE(settle(world).failed());
        const WireReadings wire = world.readings(0);
        Output now;
        const WallReadings& wall = wall_of(world, now);
        REQUIRE(wall.energy > 1e-8);
        REQUIRE(wire.energy.outside > wall.energy);
        CHECK(wire.energy.wall == test::about(wall.energy).epsilon(1e-3));
        CHECK(std::abs(wall.loss) < 1e-3 * wall.energy);
        const double in_contact = wire.energy.outside - wire.energy.wire - wall.energy;
        CHECK(in_contact > 0);
        CHECK(in_contact < wire.energy.contact);
    }

    // Once it slides all along, a move of d along the plate takes mu N d of the hold's work; the rest is what the wire, the
    // contact law and the wall store. Until then it takes less, over the elastic slip and the wall's own shear, which are some
    // micrometres of 4 mm. The hold's work takes the mean of its forces at both ends of each part of the path; the first part
    // along the plate begins without friction, so half of this part's is missing.
    TEST_CASE("analytic: beside an elastic plate the work of a hold is what wire, contact and wall store and what friction takes")
    {
        constexpr double mu = 0.2, along = 0.004;
        World pressed_down(make_setup(pressed(0, mu))), dragged(make_setup(pressed(along, mu)));
        REQUIRE_FALSE(settle(pressed_down).failed());
        int parts = 1;  // the last one is not passed
        REQUIRE_FALSE(settle(dragged, [&](int, double time) { parts += time > 1; }).failed());
        const EnergyLedger before = pressed_down.readings(0).energy, after = dragged.readings(0).energy;
        Output now;
        const double stored = wall_of(dragged, now).energy;
        const double lost = after.friction - before.friction, expected = mu * dragged.readings(0).normal * along;
        const double gained =
            after.wire - before.wire + after.contact - before.contact + stored - wall_of(pressed_down, now).energy;
        CAPTURE(parts);
        REQUIRE(expected > 1e-6);
        CHECK(lost == test::about(expected).epsilon(0.01));
        CHECK(after.wall == test::about(stored).epsilon(1e-3));
        CHECK(std::abs(after.outside - before.outside - gained - lost) < 0.5 / parts * lost);
    }

    TEST_CASE("property: an equilibrium after a saved state does the same work on the wall, to the bit")
    {
        for (const bool moving : {false, true}) {
            CAPTURE(moving);
            Scene scene = pressed();
            if (moving) scene.integrator.scheme = Scheme::Newton;
            const WorldSetup setup = make_setup(scene);
            World whole(WorldSetup{setup}), resumed(WorldSetup{setup});
            if (!moving) REQUIRE_FALSE(settle(whole).failed());
            for (int k = 0; moving && k < 500; ++k) REQUIRE_FALSE(step(whole, 2e-3).failed());
            resumed.restore_state(whole.save_state());
            CHECK(resumed.state_hash() == whole.state_hash());
            for (World* world : {&whole, &resumed}) {
                REQUIRE_FALSE(settle(*world).failed());
                for (int k = 0; moving && k < 20; ++k) REQUIRE_FALSE(step(*world, 2e-3).failed());
            }
            CHECK(resumed.readings(0).energy.wall == whole.readings(0).energy.wall);
            CHECK(resumed.save_state() == whole.save_state());
        }
    }
}

}  // namespace seldinger::test::test_static_wall
