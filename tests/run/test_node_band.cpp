// The estimate of what the length of edges does to the tip, against a run with finer nodes.

#include "run/bent_feed.h"
#include "setup/key_frames.h"
#include "setup/scene_setup.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_node_band {

namespace {

struct Fed {
    Vec3 tip;
    double error;
};

Fed feed(int nodes)
{
    const Scene scene = test::fed_round_a_bend(nodes);
    World world(make_setup(scene));
    const KeyFrames keys(scene);
    for (long k = 0; k < scene.steps(); ++k) REQUIRE(!step(world, keys.control(), scene.step_length(k)).failed());
    return {world.rod(0).pos(0), world.node_error(0)};
}

}  // namespace

// e(h) is an estimate and its sum takes all edges to err alike: the difference to fine nodes lies within it, and it is not a
// hundred times as large. It is of second order: 4 times as many nodes have 1/16 of it, by a factor of two.
TEST_CASE("property: the tip of coarse nodes lies within their own estimate of that of fine ones")
{
    const Fed fine = feed(401);
    for (const int nodes : {21, 41}) {
        CAPTURE(nodes);
        const Fed coarse = feed(nodes);
        const double off = (coarse.tip - fine.tip).norm();
        CAPTURE(off);
        CHECK(off > 1e-6);
        CHECK(off < coarse.error + fine.error);
        CHECK(coarse.error < 30 * off);
    }
    const double ratio = feed(26).error / feed(101).error;
    CHECK(ratio > 8);
    CHECK(ratio < 32);
}

// A bend of 1 rad over 10 mm, 10 mm behind the tip, in a wire of 0.1 m that nothing bends: its nodes turn by the natural angles
// of their cells. The tip of a wire that is straight but for an arc of radius R and angle a lies, from where the arc begins, R
// sin a + l cos a along and R (1 - cos a) + l sin a across. Cells of 4 and 5 mm have the arc begin at a cell's middle or between;
// a kink there is up to J h^2/8 from its place.
TEST_CASE(
    "analytic: the tip of a wire with a preformed bend lies within its estimate of the closed form, which is not ten times as "
    "large")
{
    const double radius = 0.01, angle = 1.0, free = 0.01, held = 0.08;
    for (const int nodes : {21, 26, 101}) {
        CAPTURE(nodes);
        const Scene scene = read_scene_text(
            fmt::format(
                "[scene]\ngravity = [0.0, 0.0, 0.0]\n[integrator]\nscheme = \"static\"\n[wire]\nlength_m = 0.1\nradius_m = "
                "0.0004\n"
                "density = 6500.0\nbend_nm2 = 1.0e-4\ntwist_nm2 = 8.0e-5\nstretch_n = 1.0e5\nnodes = {}\n[[wire.section]]\n"
                "from_tip_m = [0.01, 0.02]\nrest_curvature_1_m = [100.0, 0.0]\n[[hold]]\nat = \"base\"\nposition = "
                "true\ndirection = true\n",
                nodes),
            "bend.toml");
        World world(make_setup(scene));
        REQUIRE(!settle(world).failed());
        const ConstRodView rod = world.rod(0);
        const Vec3 from = rod.pos(rod.n - 1), along = (rod.pos(rod.n - 2) - from).normalized(), off = rod.pos(0) - from;
        const double x = held + radius * std::sin(angle) + free * std::cos(angle),
                     y = radius * (1 - std::cos(angle)) + free * std::sin(angle);
        const double wrong = std::hypot(off.dot(along) - x, (off - off.dot(along) * along).norm() - y);
        CAPTURE(wrong);
        CHECK(wrong < world.node_error(0));
        CHECK(world.node_error(0) < 10 * wrong);
    }
}

}  // namespace seldinger::test::test_node_band
