// Rods that start under tension, slide in a clamp, or are let go, from scene files, against closed forms.

#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_held_rods {

namespace {

constexpr double length = 0.2, radius = 1e-3, density = 2000, bend = 1e-4, stretch = 5000;
constexpr double mass = density * 3.14159265358979323846 * radius * radius * length;

/// @param wire  further keys of [wire]   @param rest  further tables
World world_of(const std::string& wire, const std::string& rest, const std::string& gravity = "[0.0, 0.0, 0.0]")
{
    static const TemporaryFolder folder;
    const std::string text = scene_text(1, 1e-3, "gravity = " + gravity + "\n") +
                             wire_text(length, bend, bend, 41, radius, density, stretch) + wire + "\n" + rest;
    return World(make_setup(read_scene_text(text, folder.path() / "held.toml", {})));
}

Vec3 momentum(const World& world)
{
    const ConstRodView rod = world.rod(0);
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < rod.n; ++i) sum += rod.mass[i] * rod.vel(i);
    return sum;
}

}  // namespace

TEST_SUITE("scene/held_rods")
{
    TEST_CASE("analytic: a rod placed under tension pulls with EA times its strain, straight or round a corner")
    {
        // both ends held: nothing can move, and the strain is that of the points. Round a corner, one edge in 40 cuts it (by 0.29
        // of an edge), so the mean strain of all edges is 0.0074 less
        for (const double strain : {-0.02, 0.05, 0.3}) {
            CAPTURE(strain);
            const double placed = length * (1 + strain);
            World world = world_of(
                fmt::format(
                    "place = {{ shape = \"points\", points = [[0.0, 0.0, 0.0], [{}, 0.0, 0.0]], stretch = \"as-placed\" }}",
                    placed),
                held_base + "[[hold]]\nat = \"tip\"\nposition = true\ndirection = true\n");
            REQUIRE_FALSE(step(world, 1e-3).failed());
            CHECK(world.readings(0).elastic == test::about(0.5 * stretch * strain * strain * length).epsilon(1e-9));
            CHECK(std::abs(world.readings(0).base_force.x()) == test::about(std::abs(stretch * strain)).epsilon(1e-9));
        }
        World bent = world_of(
            "place = { shape = \"points\", points = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.12, 0.0]], stretch = "
            "\"as-placed\" }",
            held_base + "[[hold]]\nat = \"tip\"\nposition = true\n");
        const ConstRodView rod = bent.rod(0);
        CHECK(rod.pos(0).y() == test::about(0.12));
        CHECK(rod.rest_length[0] == test::about(length / 40));
        CHECK((rod.pos(0) - rod.pos(1)).norm() == test::about(0.22 / 40));
    }

    TEST_CASE("analytic: a rod that is let go from tension springs back to its own length")
    {
        // 5 % stretched, free at the tip: at rest it is as long as without stress
        World world =
            world_of("place = { shape = \"points\", points = [[0.0, 0.0, 0.0], [0.21, 0.0, 0.0]], stretch = \"as-placed\" }",
                     held_base + "[integrator]\ndamping_mass_1_s = 200.0\n");
        for (int k = 0; k < 400; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        CHECK(world.rod(0).pos(0).x() == test::about(length).epsilon(1e-6));
    }

    TEST_CASE("analytic: a clamp that slides along x carries 12 EI d/L^3 and no tension")
    {
        // Deflection d = L/100 of a beam clamped at both ends: terms of second order are (d/L)^2 = 1e-4, those of 40 edges
        // 1/1600. Held in x too, the rod is longer: by (d/L)^2/2 as a straight line, by 0.6 (d/L)^2 as a beam without tension.
        const double d = length / 100, shear = 12 * bend * d / std::pow(length, 3);
        const auto settled = [&](const std::string& position) {
            World world = world_of(
                "", "[integrator]\nscheme = \"static\"\n" + held_base + "[[hold]]\nat = \"tip\"\nposition = " + position +
                        fmt::format("\ndirection = true\nspin = true\nmove = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, {}]]\n", d));
            REQUIRE_FALSE(settle(world).failed());
            return world.readings(0).base_force;
        };
        const Vec3 sliding = settled("[\"y\", \"z\"]"), fixed = settled("true");
        CHECK(std::abs(sliding.z()) == test::about(shear).epsilon(2e-3));
        CHECK(std::abs(sliding.x()) < 1e-4 * shear);
        CHECK(std::abs(fixed.x()) > stretch * 0.5e-4);
        CHECK(std::abs(fixed.x()) < stretch * 0.6e-4);
    }

    TEST_CASE("analytic: a load that ends at 0.1 s leaves the momentum F t of that time")
    {
        World world = world_of("", "[[load]]\nat = 0.1\nforce_n = [0.0, 0.002, 0.0]\nuntil_s = 0.1\n");
        for (int k = 0; k < 150; ++k) {
            REQUIRE_FALSE(step(world, 1e-3).failed());
            CAPTURE(world.time());
            // the residual may leave 1e-6 of the force scale, in each step
            CHECK(momentum(world).y() == test::about(0.002 * std::min(world.time(), 0.1)).epsilon(1e-5));
        }
    }

    TEST_CASE("analytic: a hold that ends lets the rod fall")
    {
        // hung up by its end and at rest: after the release the momentum grows by m g t
        World world = world_of("place = { direction = [0.0, 0.0, -1.0], normal = [1.0, 0.0, 0.0] }",
                               "[[hold]]\nat = \"base\"\nposition = true\nuntil_s = 0.05\n", "[0.0, 0.0, -9.81]");
        for (int k = 0; k < 50; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        CHECK(world.rod(0).pos(40).z() == 0);
        const double held = momentum(world).z();
        CHECK(std::abs(held) < 1e-3 * mass * 9.81 * 0.05);
        for (int k = 0; k < 50; ++k) REQUIRE_FALSE(step(world, 1e-3).failed());
        CHECK(momentum(world).z() - held == test::about(-mass * 9.81 * 0.05).epsilon(1e-5));
    }

    TEST_CASE("errors: what a sliding clamp, a stretched start and an end cannot be")
    {
        const auto message = [](const std::string& wire, const std::string& rest) {
            return refusal([&] { return world_of(wire, rest); });
        };
        CHECK(says(message("", "[[hold]]\nposition = [\"w\"]\n"), "hold.0.position"));
        CHECK(says(message("", "[[hold]]\nposition = []\n"), "holds no coordinate"));
        CHECK(says(message("", "[[hold]]\nposition = [\"x\", \"x\"]\n"), "twice"));
        CHECK(says(message("", "[[hold]]\nposition = [\"y\"]\nmove = [[0.0, 0.1, 0.0, 0.0]]\n"),
                   "moves x, which position leaves free"));
        CHECK(says(message("", "[[hold]]\nposition = [\"y\"]\nvelocity_m_s = [0.0, 0.0, 1.0]\n"), "moves z"));
        CHECK(says(message("", "[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\nuntil_s = 0.0\n"), "until_s"));
        CHECK(says(
            message("", "[integrator]\nscheme = \"static\"\n[[load]]\nat = \"tip\"\nforce_n = [0.0, 0.0, 1.0]\nuntil_s = 1.0\n"),
            "needs a run in time"));
        CHECK(says(message("place = { stretch = \"as-placed\" }", ""), "is not used by shape"));
        CHECK(says(
            message("place = { shape = \"points\", points = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0]], stretch = \"as-placed\" }", ""),
            "a strain of 1.5"));
        CHECK(says(message("place = { shape = \"points\", points = [[0.0, 0.0, 0.0], [0.22, 0.0, 0.0]] }", ""),
                   "stretch = \"as-placed\""));
    }
}

}  // namespace seldinger::test::test_held_rods
