// The estimate of what the length of edges does to the tip, against a run with finer nodes.

#include "run/bent_feed.h"
#include "run/key_frames.h"

#include <doctest/doctest.h>

namespace test_node_band {

using namespace seldinger;

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

// e(h) is an estimate and its sum takes all edges to err alike: the difference to fine nodes lies within it, and it is not a hundred times as large. It is of
// second order: 4 times as many nodes have 1/16 of it, by a factor of two.
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

}  // namespace test_node_band
