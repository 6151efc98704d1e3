// A placed wire whose axis begins beyond the wall: moved into the lumen where it is clear on which side it belongs, else refused.

#include "setup/start_inside.h"

#include "core/error.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "support/world_fixture.h"

#include <fmt/format.h>

namespace seldinger::test::test_start_inside {

namespace {

constexpr double radius = 0.5e-3;

/// Two half planes that meet in the line x = z = 0 and fall (or rise) by 45 degrees, the lumen above them: a ridge (or a valley).
WallMesh folded_plane(double rise)
{
    WallMesh mesh;
    for (const double x : {-0.05, 0.0, 0.05})
        for (const double y : {-0.05, 0.05}) mesh.vertices.emplace_back(x, y, rise * std::abs(x));
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}};
    return mesh;
}

/// A ridge that sags like the one between two branches: its line falls by 2.7 to y = 0 from either side and is level for 0.4 mm
/// there.
WallMesh saddle()
{
    WallMesh mesh;
    for (const double x : {-0.05, 0.0, 0.05})
        for (const double y : {-0.05, -0.0002, 0.0002, 0.05})
            mesh.vertices.emplace_back(x, y, (x < 0 ? -1.5 : -1.9) * std::abs(x) + 2.7 * std::max(std::abs(y) - 0.0002, 0.0));
    for (const int i : {0, 4})
        for (int j = i; j < i + 3; ++j) {
            mesh.triangles.push_back({j, j + 4, j + 1});
            mesh.triangles.push_back({j + 1, j + 4, j + 5});
        }
    return mesh;
}

/// A wire of 24 mm with edges of 3.43 mm on the folded plane, let go with its base held.
std::string scene_of(const std::string& place)
{
    return scene_text(0.1) + wire_text(0.024, 1e-4, 8e-5, 8, radius, 5000) + "place = " + place +
           "\n[integrator]\ndamping_mass_1_s = 20.0\n[vessel]\nshape = \"plane\"\nsize_m = 0.1\n[contact]\nfriction = \"none\"\n"
           "[[hold]]\nat = \"base\"\nposition = true\ndirection = true\n";
}

WorldSetup setup_of(const std::string& place, WallMesh mesh)
{
    const Scene scene = read_scene_text(scene_of(place), "/tmp/case.toml");
    LoadedVessel vessel = load_vessel(scene.vessel);
    vessel.mesh = std::move(mesh);
    return make_setup(std::span(&scene, 1), std::move(vessel), -1);
}

std::string message_of(const std::string& place, double rise)
{
    return refusal([&] { return setup_of(place, folded_plane(rise)); }, ErrorKind::BadScene);
}

/// Over the ridge by its middle edge, 0.85 mm below its line: 0.6 mm, 1.2 radii, from either face, with nodes on either side.
const char* const through_the_ridge = "{ shape = \"straight\", base = [-0.012, 0.0, -0.00085], direction = [1.0, 0.0, 0.0] }";

/// The same through the saddle, slanting: the one face pushes back what the other lets go.
const char* const through_the_saddle =
    "{ shape = \"points\", points = [[-0.012, 0.0, -0.0018], [-0.001, 0.0, -0.0013], [0.0028, -0.0008, -0.0004], [0.0125, "
    "0.0013, -0.0002]] }";

double least_clearance(const World& world, const LumenQuery& lumen)
{
    const ConstRodView rod = world.rod(0);
    double least = 1;
    for (int j = 0; j + 1 < rod.n; ++j)
        for (int part = 0; part <= 8; ++part)
            least = std::min(least, lumen.signed_distance(rod.pos(j) + part / 8.0 * (rod.pos(j + 1) - rod.pos(j))));
    return least;
}

}  // namespace

TEST_SUITE("setup/start_inside")
{
    TEST_CASE("property: a wire that pierces a ridge between two nodes starts beside it, and its steps converge")
    {
        World world(setup_of(through_the_saddle, saddle()));
        const LumenQuery lumen(world.setup().mesh, {});
        CHECK(least_clearance(world, lumen) > 0.99 * radius);
        const ConstRodView rod = world.rod(0);
        CHECK((rod.pos(rod.n - 1) - Vec3(-0.012, 0, -0.0018)).norm() == 0);
        CHECK(rod.tangent(rod.n - 2).dot(Vec3(-0.011, 0, -0.0005).normalized()) > 1 - 1e-9);  // edges point from tip to hub
        for (int j = 0; j + 1 < rod.n; ++j)
            CHECK((rod.pos(j + 1) - rod.pos(j)).norm() == about(rod.rest_length[j]).epsilon(1e-8));
        int sub_steps = 0, best_effort = 0;
        double overlap = 0, outside = 0;
        for (int k = 0; k < 20; ++k) {
            const StepReport report = step(world, 1e-3);
            REQUIRE_FALSE(report.failed());
            sub_steps += report.sub_steps;
            best_effort += (report.flags & StepBestEffort) != 0;
            overlap = std::max(overlap, world.readings(0).overlap);
            outside = std::max(outside, world.readings(0).outside);
        }
        MESSAGE(sub_steps << " sub-steps in 20 steps, " << best_effort << " by best effort, overlap " << 1e6 * overlap << " um");
        CHECK(sub_steps <= 80);
        CHECK(best_effort == 0);
        CHECK(overlap < radius / 2);
        CHECK(outside == 0);
        CHECK(least_clearance(world, lumen) > radius / 2);
    }

    TEST_CASE("property: a tip in a wall is lifted out of it")
    {
        World world(
            setup_of("{ shape = \"straight\", base = [-0.034, 0.0, -0.032], direction = [0.7, 0.0, 0.61] }", folded_plane(-1)));
        CHECK(least_clearance(world, LumenQuery(world.setup().mesh, {})) > 0.99 * radius);
    }

    TEST_CASE("property: a wire inside stays as it was placed, to the bit")
    {
        const WorldSetup setup =
            setup_of("{ shape = \"straight\", base = [-0.012, 0.0, 0.0003], direction = [1.0, 0.0, 0.0] }", folded_plane(-1));
        CHECK(setup.wires[0].wire.place.shape == PlaceShape::Straight);
        CHECK(setup.wires[0].start.empty());
    }

    TEST_CASE("property: what was done is said")
    {
        const WorldSetup setup = setup_of(through_the_ridge, folded_plane(-1));
        CHECK(has(setup.wires[0].start, "mm beyond the wall: moved into the lumen, by up to"));
        bool said = false;
        for (const auto& [name, value] : World(setup).model()) said = said || (name == "start" && value == setup.wires[0].start);
        CHECK(said);
    }

    TEST_CASE("property: nothing is moved that is too deep, at its base, or of which no side is inside")
    {
        // 1.2 mm from either face, more than the wire is thick
        const std::string deep =
            message_of("{ shape = \"straight\", base = [-0.012, 0.0, -0.0017], direction = [1.0, 0.0, 0.0] }", -1);
        CHECK(has(deep, "the shaft between nodes 3 and 4, 12.04 mm from the tip"));
        CHECK(has(deep, "1.177 mm beyond the wall"));
        const std::string base =
            message_of("{ shape = \"straight\", base = [0.0, 0.0, -0.0005], direction = [1.0, 0.0, 0.0] }", -1);
        CHECK(has(base, "node 7, 24 mm from the tip"));
        // along a valley and below it: the nearest wall of every node is the edge between its facets
        const std::string below =
            message_of("{ shape = \"straight\", base = [0.0003, -0.01, -0.0006], direction = [0.0, 1.0, 0.0] }", 1);
        CHECK(has(below, "0.6708 mm beyond the wall"));
    }
}

}  // namespace seldinger::test::test_start_inside
