// The estimate of what the length of edges does to the tip, against a run with finer nodes.

#include "scene/key_frames.h"
#include "scene/scene.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace test_node_band {

using namespace seldinger;

namespace {

struct Fed {
    Vec3 tip;
    double error;
};

/// A wire fed 10 cm round an arc of 100 degrees.
Fed fed_round_a_bend(int nodes)
{
    const Scene scene = read_scene_text(fmt::format(R"([scene]
gravity = [0.0, 0.0, 0.0]
duration_s = 1.0
dt_s = 0.004
[wire]
length_m = 0.3
radius_m = 0.0004445
density = 6500.0
bend_nm2 = 5.0e-4
twist_nm2 = 3.8e-4
stretch_n = 1.0e4
nodes = {}
[vessel]
shape = "arc"
radius_m = 0.004
bend_radius_m = 0.05
angle_deg = 100.0
lead_in_m = 0.03
lead_out_m = 0.05
[contact]
mu_static = 0.0
mu_sliding = 0.0
[feed]
inlet = "auto"
keys = [ {{t_s = 0.0, advance_m = 0.0}}, {{t_s = 1.0, advance_m = 0.1}} ]
)",
                                                    nodes),
                                        "arc.toml");
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
    const Fed fine = fed_round_a_bend(401);
    for (const int nodes : {21, 41}) {
        CAPTURE(nodes);
        const Fed coarse = fed_round_a_bend(nodes);
        const double off = (coarse.tip - fine.tip).norm();
        CAPTURE(off);
        CHECK(off > 1e-6);
        CHECK(off < coarse.error + fine.error);
        CHECK(coarse.error < 30 * off);
    }
    const double ratio = fed_round_a_bend(26).error / fed_round_a_bend(101).error;
    CHECK(ratio > 8);
    CHECK(ratio < 32);
}

}  // namespace test_node_band
