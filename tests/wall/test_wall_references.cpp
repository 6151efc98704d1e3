// An elastic wall against independent solutions, from scene text to what a run reads: the small ones of the cases in
// references.json, which bench/validate_wall.py runs all of. Tolerances are 2 % and 3 % under pressure, with control edges of 1/3
// to 1/2 of the decay length.
#include "engine.h"
#include "scene/scene.h"
#include "setup/scene_setup.h"
#include "support/approx.h"
#include "support/scenes.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

namespace seldinger::test::test_wall_references {

namespace {

constexpr double R = 0.012, pi = std::numbers::pi;

const nlohmann::json& references()
{
    static const nlohmann::json read = nlohmann::json::parse(std::ifstream(SEL_SOURCE_DIR "/tests/wall/references.json"));
    return read;
}

/// A wire that touches nothing: the subject is the wall under its loads.
std::string parked(double height)
{
    return static_scene + wire_text(0.01, 1e-5, 1e-5, 5, 2e-4, 8000) +
           fmt::format("place = {{base = [0.001, 0, {}]}}\n", height) + held_base;
}

std::string shell(double edge, double pressure = 0)
{
    return fmt::format(
        "wall = \"elastic\"\nyoungs_pa = 1e6\npoisson = 0.45\nthickness_m = 0.0015\nsupport_pa_m = 1e6\n"
        "wall_edge_m = {}\npressure_pa = {}\n",
        edge, pressure);
}

std::string plate(double side, double edge, int triangles)
{
    return fmt::format("[vessel]\nshape = \"plane\"\nsize_m = {}\ntriangles = {}\n", side, triangles) + shell(edge);
}

std::string tube(double length, double edge, int triangles, double pressure = 0)
{
    return fmt::format("[vessel]\nshape = \"tube\"\nradius_m = {}\nlength_m = {}\norigin = [{}, 0, 0]\ntriangles = {}\n", R,
                       length, -length / 2, triangles) +
           shell(edge, pressure);
}

std::string push(const Vec3& at, const Vec3& force)
{
    return fmt::format("[[wall_load]]\nat = [{}, {}, {}]\nforce_n = [{}, {}, {}]\n", at.x(), at.y(), at.z(), force.x(), force.y(),
                       force.z());
}

World settled(const std::string& text)
{
    World world(make_setup(read_scene_text(text, "wall.toml")));
    REQUIRE_FALSE(settle(world).failed());
    return world;
}

/// Displacement of the contact mesh's vertices, and where they were.
struct Moved {
    std::vector<Vec3> from, by;
};

Moved moved(const World& world)
{
    return {world.setup().mesh.vertices, world.output(Output::WallShape).walls.at(0).displacement};
}

/// Mean of what the vertices beside `x` move outward.
double outward_beside(const Moved& wall, double x, double within)
{
    double sum = 0;
    int count = 0;
    for (std::size_t v = 0; v < wall.from.size(); ++v) {
        if (std::abs(wall.from[v].x() - x) > within) continue;
        Vec3 out = wall.from[v];
        out.x() = 0;
        sum += wall.by[v].dot(out.normalized());
        ++count;
    }
    REQUIRE(count > 10);
    return sum / count;
}

/// A straight wire on a floor at `height`, as heavy as `weight` a metre, pressed down in its middle; where the middle ends.
double pressed_middle(const std::string& vessel, double length, double bend, double weight, double height, double press,
                      double law = 1e9)
{
    constexpr double radius = 4.445e-4;
    std::string text =
        fmt::format(R"([scene]
gravity = [0, 0, -9.81]
[integrator]
scheme = "static"
[wire]
length_m = {}
radius_m = {}
density = {}
bend_nm2 = {}
twist_nm2 = {}
stretch_n = 1e4
nodes = 61
place = {{base = [{}, 0, {}], direction = [-1, 0, 0]}}
[contact]
friction = "none"
stiffness = {}
exponent = 1
)",
                    length, radius, weight / (9.81 * pi * radius * radius), bend, bend, length / 2, height + radius, law) +
        vessel;
    if (press > 0) text += fmt::format("[[load]]\nat = {}\nforce_n = [0, 0, {}]\n", length / 2, -press);
    const World world = settled(text);
    CHECK(world.readings(0).overlap < 0.4 * radius);  // to there the law is the linear one that was asked for
    return world.rod(0).z[world.rod(0).n / 2];
}

}  // namespace

TEST_SUITE("wall/wall_references")
{
    TEST_CASE("analytic: a held tube under a pressure beyond the mean one moves out as closed forms say")
    {
        const auto& held = references().at("pressure").at("tubes").at(2);
        REQUIRE(held.at("case") == "held tube");
        const World world = settled(parked(0) + tube(held.at("length"), 0.003, 4000) + "[[wall_load]]\npressure_pa = 500\n");
        const Moved wall = moved(world);
        for (std::size_t k = 0; k < 3; ++k) {
            const double at = held.at("at").at(k), outward = held.at("outward").at(k);
            CHECK(outward_beside(wall, k == 2 ? -at : at, 0.002) == about(outward).epsilon(0.02));  // either side
        }
    }

    // sides of 6 and 10 decay lengths (D/k_s)^(1/4): the rims of the smaller one are felt
    TEST_CASE("analytic: a point load on supported plates, whatever the contact mesh")
    {
        const auto& of = references().at("point on a plate");
        for (std::size_t k = 0; k < 2; ++k)
            for (const int triangles : {200, 5000}) {
                const double side = of.at("under").at(k).at(0), w0 = of.at("under").at(k).at(1), force = of.at("force");
                CAPTURE(side);
                CAPTURE(triangles);
                const World world = settled(parked(0.01) + plate(side, 0.0014, triangles) + push({0, 0, 0}, {0, 0, -force}));
                CHECK(world.wall_readings().move_max == about(w0).epsilon(0.02));
            }
    }

    TEST_CASE("analytic: a load along a tube, whose translation, bending and hoop stiffness all count")
    {
        constexpr int n = 400;
        std::string loads;
        for (int k = 0; k < n; ++k) loads += push({0.1 * ((k + 0.5) / n - 0.5), 0, R}, {0, 0, 2.0 * 0.1 / n});
        const Moved wall = moved(settled(parked(-0.005) + tube(0.1, 0.0025, 8000) + loads));
        double top = 0;  // the middle of the loaded line; it is flat along the tube
        for (std::size_t v = 0; v < wall.from.size(); ++v)
            if (std::abs(wall.from[v].x()) < 0.005) top = std::max(top, wall.by[v].z());
        const auto& of = references().at("along a tube").at(0);
        REQUIRE(of.at("length") == 0.1);
        CHECK(top == about(of.at("under").get<double>()).epsilon(0.02));
    }

    TEST_CASE("analytic: a point load on a tube, with and without mean pressure")
    {
        // Edges of 1.8 mm are 0.54 of the decay length of 3.3 mm: 3 x 0.026 x 0.54^2 (docs/wall.md), and the 44 facets round the
        // tube add 0.7 %. Under pressure the tension p R makes the tip of the dent narrower, sqrt(D/(p R)) = 1.5 mm, which such
        // edges do not resolve. Twice the force moves the wall by 1/60 of the radius: linear theory, which the closed form is of,
        // is 5 % off then.
        const auto& of = references().at("point on a tube");
        const double force = of.at("force");
        for (const auto& row : of.at("rows")) {
            const double pressure = row.at("pressure"), w0 = row.at("under"), tolerance = pressure > 0 ? 0.06 : 0.03;
            CAPTURE(pressure);
            const World world = settled(parked(-0.005) + tube(0.1, 0.0018, 6000, pressure) + push({0, 0, R}, {0, 0, force}));
            CHECK(world.wall_readings().move_max == about(w0).epsilon(tolerance));
            // the band has the edges' share; 0.7 % are the facets'
            CHECK(std::abs(world.wall_readings().move_max - w0) < world.wall_readings().move_band.sum() + 0.007 * w0);
            CHECK(world.wall_readings().move_band.sum() < 3 * tolerance * w0);  // of use
        }
        // so it is the edges: half as long they leave a quarter, and the facets theirs
        const World fine = settled(parked(-0.005) + tube(0.1, 0.0009, 24000, 13332.0) + push({0, 0, R}, {0, 0, 2 * force}));
        const double twice = 2 * of.at("rows").at(1).at("under").get<double>();
        CHECK(fine.wall_readings().move_max == about(twice).epsilon(0.06 / 4 + 0.007));
    }

    // w0 = (1/pi) int P dk / (B k^4 + 1/(G(k) + 1/k_loc)): the effect of 0.1 N beside the weight that keeps the wire on the
    // wall. The 61 nodes are six and eight to a decay length of (B G(0))^(1/4): 0.2 % of w0.
    TEST_CASE("analytic: a stiff wire pressed into a plate, with and without a law in series, and into a tube's floor")
    {
        const auto check = [](const char* name, const std::string& vessel, double length, double weight, double height) {
            const auto& of = references().at("wires").at(name);
            const double bend = of.at("bend"), law = of.at("law"), press = references().at("wires").at("press");
            CAPTURE(name);
            CHECK(pressed_middle(vessel, length, bend, weight, height, 0, law) -
                      pressed_middle(vessel, length, bend, weight, height, press, law) ==
                  about(of.at("profile").at(0).at(1).get<double>()).epsilon(0.02));
        };
        check("plate", plate(0.08, 0.0025, 800), 0.08, 0.2, 0);
        // as heavy as keeps it down: with a tenth of this weight it is lifted beside the load, and goes 4 % deeper. Edges 1.1 %,
        // nodes 0.2 %
        check("plate in series", plate(0.14, 0.004, 800), 0.14, 1.2, 0);
        check("tube", tube(0.16, 0.003, 6000), 0.13, 0.4, -R);
    }
}

}  // namespace seldinger::test::test_wall_references
