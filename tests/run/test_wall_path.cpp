// The control mesh of an elastic wall along the path that a trial run with a rigid wall finds.

#include "run/wall_path.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/scenes.h"
#include "surface/control_mesh.h"
#include "wall/wall_model.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_wall_path {

namespace {

/// A wire of 5 cm that 20 mN press into a plane wall, whose dents decay over 2.67 mm.
Scene pressed_wire(double size, double wall_edge)
{
    return read_scene_text(static_scene + wire_text(0.05, 5e-4, 3.8e-4, 101, 0.0004445) +
                               "place = { shape = \"straight\", base = [-0.025, 0.0, 0.0004445] }\n" +
                               fmt::format("[vessel]\nshape = \"plane\"\nsize_m = {}\nwall = \"elastic\"\nyoungs_pa = 0.5e6\n"
                                           "thickness_m = 0.0009\nsupport_pa_m = 3e6\nwall_edge_m = {}\n",
                                           size, wall_edge) +
                               "[[load]]\nat = 0.025\nforce_n = [0.0, 0.0, -0.02]\n",
                           "pressed.toml");
}

/// The number in "... (4,500 vertices; ...".
double vertices_told(const std::string& why)
{
    const std::size_t end = why.find(" vertices"), begin = why.rfind('(', end) + 1;
    std::string digits = why.substr(begin, end - begin);
    std::erase(digits, ',');
    return std::stod(digits);
}

struct Dent {
    WallReadings readings;
    WallMechanics mechanics;
};

Dent dent_of(const Scene& scene, bool with_path)
{
    WorldSetup setup = make_setup(scene);
    if (with_path) find_wall_path(std::span(&scene, 1), setup);
    World world(std::move(setup));
    REQUIRE(!settle(world).failed());
    return {world.wall_readings(), world.wall_mechanics()};
}

}  // namespace

// The reference is a small plane with even edges of a quarter of the decay length. Its own errors are 0.026/16 of the
// displacement, and a few per cent of the stress (contact/test_elastic_contact). Along a path edges are half of the decay length:
// 0.026/4 and as much.
TEST_CASE(
    "property: on a plane of any size displacement and stress are those of a fine mesh, with less vertices than an even one")
{
    const Dent fine = dent_of(pressed_wire(0.06, 0.00066), true);
    for (const double size : {0.1, 0.5}) {
        CAPTURE(size);
        const Dent along = dent_of(pressed_wire(size, 0), true);
        CHECK(along.readings.move_max == test::about(fine.readings.move_max).epsilon(0.01));
        CHECK(along.readings.stress_max == test::about(fine.readings.stress_max).epsilon(0.05));
        CHECK(std::abs(along.readings.stress_max - fine.readings.stress_max) <
              along.readings.stress_band.sum() + fine.readings.stress_band.sum());
        CHECK(along.mechanics.edge_touched == test::about(0.5 * along.mechanics.decay));
        CHECK(along.mechanics.vertices < 2000);
    }
    // without the path the mesh is even, and 4 decay lengths long
    const Dent even = dent_of(pressed_wire(0.5, 0), false);
    CHECK(even.readings.move_max < 0.8 * fine.readings.move_max);
    CHECK(even.mechanics.edge_touched > 4 * even.mechanics.decay);
}

TEST_CASE("property: the path is the same each time, and none is looked for where the edge is given or the wall is rigid")
{
    const auto path_of = [](const Scene& scene, bool elastic) {
        WorldSetup setup = make_setup(scene);
        setup.vessel.elastic = elastic;
        find_wall_path(std::span(&scene, 1), setup);
        return setup.vessel.touched;
    };
    const std::vector<Vec3> once = path_of(pressed_wire(0.1, 0), true);
    REQUIRE(once.size() > 10);
    CHECK(path_of(pressed_wire(0.1, 0), true) == once);
    for (const Vec3& point : once) CHECK(std::abs(point.z()) < 1e-9);
    CHECK(path_of(pressed_wire(0.1, 0.002), true).empty());
    CHECK(path_of(pressed_wire(0.1, 0), false).empty());
}

// Touched along all of a plane of 1 m. Thick walls dent over so wide a strip that 3,000 vertices do, if with edges longer than
// half the decay length. With thin walls they would leave edges longer than 0.9 of it.
TEST_CASE("property: more than 3,000 vertices are spent only where edges would be longer than 0.9 decay lengths")
{
    for (const bool thin : {false, true}) {
        CAPTURE(thin);
        WorldSetup setup = make_setup(pressed_wire(1.0, 0));
        setup.vessel.thickness = thin ? 1.5e-3 : 3e-3;
        for (int k = 0; k <= 500; ++k) setup.vessel.touched.emplace_back(-0.45 + 0.9 * k / 500, 0, 0);
        const WallModel wall(setup.vessel, setup.mesh, setup.centreline);
        const WallEdge chosen = choose_wall_edge(wall);
        const double share = chosen.path.edge / decay_length(wall);
        CAPTURE(share);
        CHECK(chosen.vertices == test::about(thin ? 4500 : 3000).epsilon(thin ? 0.3 : 0.01));
        CHECK(share == test::about(thin ? 0.9 : 0.7).epsilon(thin ? 1e-9 : 0.2));
        CHECK(vertices_told(chosen.why) == test::about(chosen.vertices).epsilon(0.05));  // two digits
    }
}

TEST_CASE("the trial run can be ended")
{
    const Scene scene = pressed_wire(0.1, 0);
    WorldSetup setup = make_setup(scene);
    CHECK_THROWS_WITH((void)find_wall_path(std::span(&scene, 1), setup, [] { return true; }),
                      "interrupted in the trial run with a rigid wall, before the first step");
}

}  // namespace seldinger::test::test_wall_path
