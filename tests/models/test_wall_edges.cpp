// Which control edges a study tries on an elastic wall.

#include "models/simulation.h"
#include "models/wall_edges.h"
#include "support/approx.h"
#include "support/scenes.h"

#include <fmt/format.h>

#include <cmath>

namespace seldinger::test::test_wall_edges {

namespace {

/// A tube of 1 cm radius and 10 cm length.
WallEdges edges_of(const std::string& wall)
{
    const std::string text = scene_text(1) + wire_text(0.1, 1e-5, 1e-5, 21) + tube_text(0.01, 0.1, 4000) +
                             "thickness_m = 0.001\n" + wall +
                             "\n[feed]\npoint = [0.01, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n"
                             "keys = [ {t_s = 0.0, advance_m = 0.0} ]\n";
    return wall_edges(load_study_scene(read_scene_text(text, "tube.toml")).setup);
}

}  // namespace

TEST_SUITE("models/wall_edges")
{
    TEST_CASE("property: a rigid wall has no edges to try")
    {
        const WallEdges edges = edges_of("");
        CHECK_FALSE(edges.elastic());
        CHECK(edges.trials().empty());
        CHECK_FALSE(edges_of("wall_edge_m = 0.004").elastic());  // which says nothing while the wall is rigid
    }

    // beta^4 = (E t / R^2 + k_s) / (4 D): with E = 1 MPa, D = 1.045e-4 N m, E t / R^2 = 1e7 Pa/m and k_s = 1e6 it decays over
    // 2.482 mm, half of which is shorter than 1/3 of the radius
    TEST_CASE("analytic: the own edge is the one that is chosen, half the decay length of a tube")
    {
        const WallEdges edges = edges_of("wall = \"elastic\"\nyoungs_pa = 1e6");
        const double bend = 1e6 * 1e-9 / (12 * (1 - 0.45 * 0.45));
        const double decay = std::pow((1e7 + 1e6) / (4 * bend), -0.25);
        // 2 pi R L / (sqrt(3)/2 h^2) makes 4,700 vertices of it: the chosen one is longer, as 2,000 of them make it
        const double of_2000 = std::sqrt(2 * 3.14159265 * 0.01 * 0.1 / (0.5 * std::sqrt(3.0) * 2000));
        REQUIRE(of_2000 > 0.5 * decay);
        // the mesh is a polygon's; the search for 2,000 ends within 0.1 %
        CHECK(edges.own == about(of_2000).epsilon(0.01));
        // 1/3 of the area per vertex
        CHECK(edges.least == about(edges.own / std::sqrt(3.0)).epsilon(0.002));
    }

    TEST_CASE(
        "property: trials are multiples of the own edge, coarse to fine; a reference begins at the first and goes to the least")
    {
        const WallEdges edges = edges_of("wall = \"elastic\"\nwall_edge_m = 0.004");
        CHECK(edges.own == 0.004);
        const std::vector<double> trials = edges.trials();
        REQUIRE(trials.size() == 3);
        CHECK(trials[0] == about(0.008).epsilon(1e-9));
        CHECK(trials[1] == about(0.0056).epsilon(1e-9));
        CHECK(trials[2] == 0.004);
        CHECK(edges.of_level(0, 1.5) == about(0.008).epsilon(1e-9));
        CHECK(edges.of_level(2, 1.5) == about(0.008 / 2.25).epsilon(1e-9));
        CHECK(edges.least < 0.004);
        CHECK(edges.of_level(20, 1.5) == edges.least);
    }

    TEST_CASE("property: an edge that is finer than a study would make it stays as it is")
    {
        const WallEdges edges = edges_of("wall = \"elastic\"\nwall_edge_m = 0.0005");
        CHECK(edges.own == 0.0005);
        CHECK(edges.least == 0.0005);
        CHECK(edges.of_level(9, 1.5) == 0.0005);
    }
}

}  // namespace seldinger::test::test_wall_edges
