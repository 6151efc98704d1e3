// make_setup: does the wire fit the vessel, and where does it enter?

#include "contact/wall_body.h"
#include "core/error.h"
#include "io/mesh_file.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "setup/vessel_load.h"
#include "shapes/shapes.h"
#include "support/approx.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vessel/inside.h"
#include "wall/wall_resolution.h"

#include <fmt/format.h>

#include <unistd.h>

#include <cmath>

namespace seldinger::test::test_scene_setup {

namespace {

struct TubeFile {
    std::filesystem::path path;
    /// A tube of 5 mm radius and 60 mm length, written in `units`.
    explicit TubeFile(const std::string& units)
    {
        VesselSpec spec{.shape = VesselShape::Tube, .radius = 0.005, .length = 0.06, .triangles = 1500};
        path = std::filesystem::temp_directory_path() / fmt::format("seldinger_tube_{}_{}.stl", units, getpid());
        write_mesh(path, make_tube(spec).mesh, units);
    }
    ~TubeFile() { std::filesystem::remove(path); }
};

std::string scene_of(const std::string& vessel, const std::string& feed)
{
    return scene_text(0.1) + wire_text(0.1, 1e-5, 8e-6, 21, 0.0005) + fmt::format("[vessel]\n{}\n[feed]\n{}\n", vessel, feed) +
           "keys = [ {t_s = 0.0, advance_m = 0.0}, {t_s = 1.0, advance_m = 0.02} ]\n";
}

std::string message_of(const std::string& text)
{
    return refusal([&] { return make_setup(read_scene_text(text, "/tmp/case.toml")); }, ErrorKind::BadScene);
}

const char* const arc = "shape = \"arc\"\nradius_m = 0.005\nbend_radius_m = 0.04\nangle_deg = 90.0\nlead_in_m = 0.02";

}  // namespace

TEST_SUITE("setup/scene_setup")
{
    TEST_CASE("property: a mesh in the wrong unit is refused with the one that fits")
    {
        for (const std::string right : {"m", "mm", "um"})
            for (const std::string said : {"m", "mm", "um"}) {
                CAPTURE(right);
                CAPTURE(said);
                const TubeFile file(right);
                const std::string message = message_of(
                    scene_of(fmt::format("mesh = \"{}\"\nunits = \"{}\"", file.path.string(), said), "inlet = \"auto\""));
                if (said == right) {
                    CHECK(message == "");
                    continue;
                }
                CHECK(has(message, "vessel.units"));
                CHECK(has(message, fmt::format("units = \"{}\" would fit", right)));
            }
    }

    TEST_CASE("property: a generated vessel of impossible size names its radius")
    {
        CHECK(has(message_of(scene_of("shape = \"tube\"\nradius_m = 5.0\nlength_m = 60.0", "inlet = \"auto\"")),
                  "vessel.radius_m"));
    }

    TEST_CASE("analytic: the distance of a feed point outside the lumen is named")
    {
        // 2.5 mm beyond a wall of 5 mm; the facets of 20,000 triangles lie inside it by under 10 um
        const std::string message = message_of(scene_of(arc, "point = [0.01, 0.0, 0.0075]\ndirection = [1.0, 0.0, 0.0]"));
        CAPTURE(message);
        CHECK(has(message, "feed.point"));
        CHECK(has(message, "2.5 mm outside the lumen"));
        const std::string before = message_of(scene_of(arc, "point = [-0.01, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]"));
        CHECK_MESSAGE(before.find("beyond inlet 1 of the vessel") != std::string::npos, before);
    }

    TEST_CASE("property: a point inside, on an opening, or beside a plane is accepted")
    {
        for (const char* point : {"[0.01, 0.0, 0.0]", "[0.0, 0.0, 0.0]", "[0.0, 0.002, -0.003]"})
            CHECK(message_of(scene_of(arc, fmt::format("point = {}\ndirection = [1.0, 0.0, 0.0]", point))) == "");
        CHECK(message_of(scene_of("shape = \"plane\"\nsize_m = 1.0", "point = [0.0, 0.0, -0.3]\ndirection = [1.0, 0.0, 0.0]")) ==
              "");
    }

    TEST_CASE("property: inlet = auto lies in the lumen and points into it")
    {
        const WorldSetup setup = make_setup(read_scene_text(scene_of(arc, "inlet = \"auto\""), "/tmp/case.toml"));
        const FeedSpec& feed = setup.wires[0].feed;
        CHECK(feed.direction.norm() == test::about(1));
        RepairReport report;
        (void)make_setup(read_scene_text(scene_of(arc, "inlet = \"auto\""), "/tmp/case.toml"), -1, &report);
        REQUIRE(report.loops.size() == 2);
        const LumenQuery lumen(setup.mesh, report.loops);
        CHECK(lumen.inside(feed.point));
        CHECK(lumen.signed_distance(feed.point + 0.005 * feed.direction) > 0.0045);
        CHECK_FALSE(lumen.inside(feed.point - 0.005 * feed.direction));
    }

    TEST_CASE("property: a wire placed through the wall is refused, with the node and its depth")
    {
        const auto placed = [](const std::string& vessel, const std::string& place) {
            std::string text = scene_of(vessel, "");
            text = text.substr(0, text.find("[feed]"));
            const std::string nodes = "nodes = 21\n";
            text.insert(text.find(nodes) + nodes.size(), "place = " + place + "\n");
            return message_of(text);
        };
        const std::string tube = "shape = \"tube\"\nradius_m = 0.005\nlength_m = 0.2\ntriangles = 4000";
        CHECK(placed(tube, "{ shape = \"straight\", base = [0.05, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }").empty());
        // out through the far opening: free
        CHECK(placed(tube, "{ shape = \"straight\", base = [0.15, 0.0, 0.0], direction = [1.0, 0.0, 0.0] }").empty());
        // the tip, 0.1 m on at 1 : 10, is some 10 mm up, 5 mm beyond the wall
        const std::string through =
            placed(tube, "{ shape = \"straight\", base = [0.05, 0.0, 0.0], direction = [1.0, 0.0, 0.1] }");
        CAPTURE(through);
        CHECK(has(through, "wire.place: node 0, 0 mm from the tip"));
        CHECK(has(through, " is 4.9"));
        CHECK(has(through, "mm beyond the wall"));
        const std::string plane =
            "shape = \"plane\"\norigin = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize_m = 0.3\ntriangles = 400";
        CHECK(placed(plane, "{ shape = \"straight\", base = [0.0, 0.0, 0.001], direction = [1.0, 0.0, 0.0] }").empty());
        CHECK(placed(plane, "{ shape = \"straight\", base = [0.0, 0.0, -0.001], direction = [1.0, 0.0, 0.0] }")
                  .find("1 mm beyond the wall") != std::string::npos);
        // beside and below the plane's edge there is no wall
        CHECK(placed(plane, "{ shape = \"straight\", base = [0.2, 0.0, -0.01], direction = [1.0, 0.0, 0.0] }").empty());
    }

    TEST_CASE("property: a lumen that is narrower than its elastic wall is thick is told of, with place and sizes")
    {
        VesselSpec vessel;
        vessel.thickness = 8e-4;
        const Centreline axis{{{0, 0, 0}, {0.03, 0, 0}, {0.06, 0, 0}}, {0.003, 0.0003, 0.003}, {-1, 0, 1}};
        CHECK(describe_thick_wall(vessel, axis).empty());  // rigid
        vessel.elastic = true;
        CHECK(describe_thick_wall(vessel, {}).empty());
        CHECK(has(describe_thick_wall(vessel, axis), "0.3 mm near [0.03, 0, 0] m, in a wall of 0.8 mm"));
        vessel.thickness = 2e-4;
        CHECK(describe_thick_wall(vessel, axis).empty());
    }

    // A plane of 0.5 m at the setting that is chosen: edges of 4.9 decay lengths (0.026 * 4.9^2 = 62 % of the displacement is
    // missing).
    TEST_CASE(
        "property: edges of an elastic wall that are longer than the decay length are told of, with the ratio and what to set")
    {
        VesselSpec vessel{.shape = VesselShape::Plane,
                          .size = 0.5,
                          .triangles = 20000,
                          .elastic = true,
                          .youngs = 5e5,
                          .thickness = 9e-4,
                          .support = 3e6};
        const LoadedVessel loaded = load_vessel(vessel);
        const WallMechanics chosen = expected_mechanics(vessel, loaded.mesh, loaded.centreline);
        // of a beam on its bed, D = E t^3/(12 (1 - nu^2)), lambda^4 = 4 D/k_s
        const double bend = 5e5 * std::pow(9e-4, 3) / (12 * (1 - vessel.poisson * vessel.poisson));
        CHECK(chosen.decay == test::about(std::pow(4 * bend / 3e6, 0.25)).epsilon(1e-12));
        CHECK(chosen.edge / chosen.decay > 4);
        const std::string coarse = describe_coarse_wall(chosen, vessel);
        CHECK(coarse.find("vessel.wall_edge_m: got control edges of ") == 0);
        CHECK(has(coarse, fmt::format("{:.2g} decay lengths", chosen.edge / chosen.decay)));
        CHECK(has(coarse, "Fix: vessel.wall_edge_m = "));
        vessel.wall_edge = 0.9 * chosen.decay;
        const WallMechanics fine = expected_mechanics(vessel, loaded.mesh, loaded.centreline);
        CHECK(fine.edge == test::about(vessel.wall_edge).epsilon(0.02));
        CHECK(describe_coarse_wall(fine, vessel).empty());
        // where nothing has moved the wall, no edge is judged
        WallMechanics untouched = chosen;
        untouched.edge_touched = 0;
        CHECK(describe_coarse_wall(untouched, vessel).empty());
        vessel.elastic = false;
        CHECK(describe_coarse_wall(expected_mechanics(vessel, loaded.mesh, loaded.centreline), vessel).empty());
    }
}

}  // namespace seldinger::test::test_scene_setup
